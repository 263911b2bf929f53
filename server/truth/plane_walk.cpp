#include "server/truth/plane_walk.h"

#include <algorithm>
#include <cmath>

namespace obliq {
namespace {

/// Adds what the horizon leaves of a strip, then raises the horizon.
void light(ExactHorizon& horizon, long double d0, long double h0, long double d1, long double h1,
           double plane_distance_m, std::int32_t building, std::uint8_t material, std::vector<Strip>& out,
           double raster_gamma = 1) {
  const ExactHorizon::Lit lit = horizon.lit(d0, h0, d1, h1);
  if (lit.from < lit.to)
    out.push_back({static_cast<double>(d0 + lit.from * (d1 - d0)),
                   static_cast<double>(h0 + lit.from * (h1 - h0)), static_cast<double>(d1),
                   static_cast<double>(h1), plane_distance_m, building, material, raster_gamma});
  horizon.raise(d0, h0);
  horizon.raise(d1, h1);
}

}  // namespace

PlaneWalk::PlaneWalk(const World& world, const SightedBuildings& sighted, const ReferenceView& view)
    : world_(world),
      sighted_(sighted),
      antenna_m_(view.antenna_m),
      reach_m_(view.r_max_m),
      start_u_((static_cast<long double>(view.antenna_m.x) - world.grid.x0_m) / world.grid.cell_m),
      start_v_((static_cast<long double>(view.antenna_m.z) - world.grid.z0_m) / world.grid.cell_m) {}

void PlaneWalk::walk(double bearing_rad, int azimuth_bin, PlaneStrips& strips) {
  strips.lit.clear();
  strips.alone.clear();
  strips.feet.clear();
  const auto bearing = static_cast<long double>(bearing_rad);
  plane_ = {std::sin(bearing), std::cos(bearing)};
  rate_u_ = plane_.sin_bearing / world_.grid.cell_m;
  rate_v_ = plane_.cos_bearing / world_.grid.cell_m;
  find_buildings(azimuth_bin);
  find_cuts();
  horizon_ = {};
  top_known_ = false;
  next_crossing_ = 0;
  for (std::size_t k = 0; k + 1 < cuts_.size(); ++k) {
    const long double from = cuts_[k];
    const long double to = cuts_[k + 1];
    const GroundLine ground = ground_between(from, to);
    cross_outlines(from, ground, strips);
    surface(from, to, ground, strips.lit);
    for (Crossed& crossed : crossed_) {
      if (!crossed.inside) continue;
      // The part of the roof above ground.
      long double a = from, b = to;
      if (ground.known) {
        const long double below_a = crossed.roof_h - ground.at(a);
        const long double below_b = crossed.roof_h - ground.at(b);
        if (below_a <= 0 && below_b <= 0) continue;
        const long double meet = from + below_a / (below_a - below_b) * (to - from);
        if (below_a < 0) a = meet;
        if (below_b < 0) b = meet;
      }
      roof(crossed, crossed.own, a, b, strips.alone);
    }
  }
}

void PlaneWalk::find_buildings(int azimuth_bin) {
  crossed_.clear();
  crossings_.clear();
  for (const std::uint32_t b : sighted_.in_bin(azimuth_bin)) {
    const std::size_t before = crossings_.size();
    const bool inside = sighted_.cross(b, plane_, crossed_.size(), crossings_);
    if (!inside && crossings_.size() == before) continue;
    const Building& building = world_.buildings.list[b];
    const auto y = static_cast<long double>(antenna_m_.y);
    crossed_.push_back({b, building.roof_y_m - y, building.base_y_m - y, building.material, inside, {}});
  }
  std::sort(crossings_.begin(), crossings_.end(), [](const OutlineCrossing& a, const OutlineCrossing& b) {
    return a.d_m != b.d_m ? a.d_m < b.d_m : a.owner < b.owner;
  });
}

/// Ground distances of the whole numbers 0..last on an axis along which the plane starts at `start` and moves
/// `rate` a metre.
void PlaneWalk::cut_lines(long double start, long double rate, int last) {
  if (rate == 0) return;
  const long double end = start + rate * reach_m_;
  const auto low = std::max(0.0L, std::floor(std::min(start, end)));
  const auto high = std::min(static_cast<long double>(last), std::ceil(std::max(start, end)));
  for (long double line = low; line <= high; ++line) {
    const long double d = (line - start) / rate;
    if (d > 0 && d < reach_m_) cuts_.push_back(d);
  }
}

void PlaneWalk::find_cuts() {
  const HeightGrid& grid = world_.grid;
  cuts_.clear();
  cuts_.push_back(0);
  cuts_.push_back(reach_m_);
  cut_lines(start_u_, rate_u_, grid.nx - 1);
  cut_lines(start_v_, rate_v_, grid.nz - 1);
  // The diagonals from (i+1, j) to (i, j+1) lie where u + v is a whole number.
  cut_lines(start_u_ + start_v_, rate_u_ + rate_v_, grid.nx + grid.nz - 2);
  for (const OutlineCrossing& crossing : crossings_)
    if (crossing.d_m < reach_m_) cuts_.push_back(crossing.d_m);
  std::sort(cuts_.begin(), cuts_.end());
  cuts_.erase(std::unique(cuts_.begin(), cuts_.end()), cuts_.end());
}

/// The triangle under the interval's middle, as a line in the plane.
PlaneWalk::GroundLine PlaneWalk::ground_between(long double from, long double to) const {
  const HeightGrid& grid = world_.grid;
  const long double middle = from + (to - from) / 2;
  const long double u = start_u_ + rate_u_ * middle;
  const long double v = start_v_ + rate_v_ * middle;
  if (!(u >= 0 && v >= 0 && u < grid.nx && v < grid.nz)) return {};
  const int i = static_cast<int>(u);
  const int j = static_cast<int>(v);
  if (!grid.cell_known(i, j)) return {};
  const bool upper = (u - i) + (v - j) > 1;
  const int corner = upper ? 1 : 0;
  const long double y10 = grid.node_y_m(i + 1, j);
  const long double y01 = grid.node_y_m(i, j + 1);
  const long double base = grid.node_y_m(i + corner, j + corner);
  const long double per_u = upper ? base - y01 : y10 - base;
  const long double per_v = upper ? base - y10 : y01 - base;
  GroundLine line;
  line.known = true;
  line.d0 = from;
  line.h0 = base - antenna_m_.y + per_u * (start_u_ + rate_u_ * from - (i + corner)) +
            per_v * (start_v_ + rate_v_ * from - (j + corner));
  line.rise = per_u * rate_u_ + per_v * rate_v_;
  // Distance of the antenna, (0, 0) here, from the plane: its height above or below it, times n_y.
  const long double above = line.rise * from - line.h0;
  line.plane_distance_m = static_cast<double>(
      std::fabs(above) / std::sqrt(1 + (per_u * per_u + per_v * per_v) / (grid.cell_m * grid.cell_m)));
  line.material = world_.material_of_cell(i, j);
  line.raster_gamma = static_cast<double>(world_.raster_gamma_of_cell(i, j));
  return line;
}

void PlaneWalk::cross_outlines(long double d, const GroundLine& ground, PlaneStrips& strips) {
  if (next_crossing_ == crossings_.size() || crossings_[next_crossing_].d_m > d) return;
  entered_.clear();
  for (; next_crossing_ < crossings_.size() && crossings_[next_crossing_].d_m <= d; ++next_crossing_) {
    const OutlineCrossing& crossing = crossings_[next_crossing_];
    Crossed& crossed = crossed_[crossing.owner];
    crossed.inside = !crossed.inside;
    if (crossed.inside)
      entered_.push_back({crossing.owner, crossing.cos_to_plane, crossing.normal_x, crossing.normal_z});
  }
  walls(d, ground, strips);
}

/// Walls of the footprints that the plane enters at d, from the surface before it up, the lower roof first.
void PlaneWalk::walls(long double d, const GroundLine& ground, PlaneStrips& strips) {
  std::stable_sort(entered_.begin(), entered_.end(), [&](const Entered& a, const Entered& b) {
    return crossed_[a.owner].roof_h < crossed_[b.owner].roof_h;
  });
  if (world_.buildings.corners && !entered_.empty()) foot(d, ground, entered_.front(), strips);
  bool low_known = top_known_;
  long double low = top_h_;
  if (ground.known && (!low_known || ground.at(d) > low)) {
    low = ground.at(d);
    low_known = true;
  }
  for (const Entered& entered : entered_) {
    Crossed& crossed = crossed_[entered.owner];
    if (!crossed.inside) continue;  // entered and left at a corner
    const double distance = static_cast<double>(d) * entered.cos_to_plane;
    const auto building = static_cast<std::int32_t>(crossed.building);
    const long double foot = ground.known ? std::max(crossed.base_h, ground.at(d)) : crossed.base_h;
    if (foot < crossed.roof_h)
      light(crossed.own, d, foot, d, crossed.roof_h, distance, building, crossed.material, strips.alone);
    const long double from = low_known ? std::max(low, crossed.base_h) : crossed.base_h;
    if (!(from < crossed.roof_h)) continue;
    light(horizon_, d, from, d, crossed.roof_h, distance, building, crossed.material, strips.lit);
    low = crossed.roof_h;
    low_known = true;
  }
}

/// The foot of a wall at d, where the ground before it is lit up to it.
void PlaneWalk::foot(long double d, const GroundLine& ground, const Entered& entered,
                     PlaneStrips& strips) const {
  const Crossed& crossed = crossed_[entered.owner];
  if (!crossed.inside || !ground.known || !(ground.at(d) < crossed.roof_h)) return;
  const auto d_m = static_cast<double>(d);
  double near_m = d_m;
  for (auto strip = strips.lit.rbegin(); strip != strips.lit.rend(); ++strip) {
    if (strip->building != kGroundStrip || std::fabs(strip->d1_m - near_m) > 1e-9 * d_m) break;
    near_m = strip->d0_m;
  }
  if (near_m == d_m) return;
  strips.feet.push_back({d_m, static_cast<double>(ground.at(d)), static_cast<double>(crossed.roof_h),
                         d_m - near_m, entered.normal_x, entered.normal_z,
                         static_cast<std::int32_t>(crossed.building), crossed.material});
}

void PlaneWalk::roof(const Crossed& crossed, ExactHorizon& horizon, long double from, long double to,
                     std::vector<Strip>& out) {
  light(horizon, from, crossed.roof_h, to, crossed.roof_h, static_cast<double>(std::fabs(crossed.roof_h)),
        static_cast<std::int32_t>(crossed.building), crossed.material, out);
}

/// The higher of ground and roofs on an interval that holds no cut.
void PlaneWalk::surface(long double from, long double to, const GroundLine& ground, std::vector<Strip>& lit) {
  const Crossed* highest = nullptr;
  for (const Crossed& crossed : crossed_)
    if (crossed.inside && (!highest || crossed.roof_h > highest->roof_h)) highest = &crossed;
  top_known_ = ground.known || highest;
  if (!top_known_) return;
  const auto bare = [&](long double a, long double b) {
    light(horizon_, a, ground.at(a), b, ground.at(b), ground.plane_distance_m, kGroundStrip, ground.material,
          lit, ground.raster_gamma);
  };
  if (!highest) {
    bare(from, to);
  } else if (!ground.known) {
    roof(*highest, horizon_, from, to, lit);
  } else {
    const long double above_from = highest->roof_h - ground.at(from);
    const long double above_to = highest->roof_h - ground.at(to);
    const long double meet = from + above_from / (above_from - above_to) * (to - from);
    if (above_from > 0 && above_to > 0) {
      roof(*highest, horizon_, from, to, lit);
    } else if (above_from > 0) {
      roof(*highest, horizon_, from, meet, lit);
      bare(meet, to);
    } else if (above_to > 0) {
      bare(from, meet);
      roof(*highest, horizon_, meet, to, lit);
    } else {
      bare(from, to);
    }
  }
  top_h_ = ground.known ? ground.at(to) : highest->roof_h;
  if (highest) top_h_ = std::max(top_h_, highest->roof_h);
}

}  // namespace obliq
