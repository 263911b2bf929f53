#include "server/radar/profile.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace obliq {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Footprint stretches as disjoint steps, the highest roof where they overlap; sorted by distance.
std::vector<FootprintSpan> disjoint(std::vector<FootprintSpan>& spans) {
  std::vector<FootprintSpan> steps;
  if (spans.empty()) return steps;
  std::vector<double> edges;
  for (const FootprintSpan& span : spans) {
    edges.push_back(span.near_m);
    edges.push_back(span.far_m);
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  std::sort(spans.begin(), spans.end(), [](const FootprintSpan& a, const FootprintSpan& b) {
    return a.near_m != b.near_m ? a.near_m < b.near_m : a.roof_y_m < b.roof_y_m;
  });
  std::size_t next = 0;
  std::vector<FootprintSpan> active;
  for (std::size_t e = 0; e + 1 < edges.size(); ++e) {
    while (next < spans.size() && spans[next].near_m <= edges[e]) active.push_back(spans[next++]);
    std::erase_if(active, [&](const FootprintSpan& span) { return span.far_m <= edges[e]; });
    double roof = -kInfinity;
    for (const FootprintSpan& span : active) roof = std::max(roof, span.roof_y_m);
    if (roof > -kInfinity) steps.push_back({edges[e], edges[e + 1], roof});
  }
  return steps;
}

/// Carries the running horizon outwards and marks range bins.
class Marcher {
 public:
  Marcher(const BinGrid& bins, double antenna_y_m, ProfileResult& result)
      : bins_(bins), antenna_y_m_(antenna_y_m), result_(result) {}

  /// Surface from (d0, y0) to (d1, y1); a rise from where the last piece ended is a wall.
  void piece(double d0, double y0, double d1, double y1) {
    const double h0 = y0 - antenna_y_m_;
    const double h1 = y1 - antenna_y_m_;
    if (joined_ && last_d_m_ == d0 && h0 > last_h_m_) wall(d0, last_h_m_, h0);
    mark(result_.present, d0, h0, d1, h1);
    const double s0 = slope(d0, h0);
    const double s1 = slope(d1, h1);
    if (s1 > horizon_) {
      double from_d = d0;
      double from_h = h0;
      if (s0 < horizon_) {
        // Where the piece rises out of the shadow: h(d) = horizon d.
        const double rise = (h1 - h0) / (d1 - d0);
        from_d = std::clamp((h0 - rise * d0) / (horizon_ - rise), d0, d1);
        from_h = h0 + rise * (from_d - d0);
      }
      // A piece that falls away is seen at its near edge only.
      if (s1 > s0) mark(result_.visible, from_d, from_h, d1, h1);
      horizon_ = std::max({horizon_, s0, s1});
    } else {
      horizon_ = std::max(horizon_, s0);
    }
    joined_ = true;
    last_d_m_ = d1;
    last_h_m_ = h1;
  }

  /// No surface follows; the next piece starts without a wall.
  void gap() { joined_ = false; }

 private:
  static double slope(double d, double h) { return d > 0 ? h / d : h > 0 ? kInfinity : -kInfinity; }

  void wall(double d, double low, double high) {
    mark(result_.present, d, low, d, high);
    const double top = slope(d, high);
    if (!(top > horizon_)) return;
    mark(result_.visible, d, std::max(low, std::isfinite(horizon_) ? horizon_ * d : low), d, high);
    horizon_ = top;
  }

  void mark(std::vector<std::uint8_t>& plane, double d0, double h0, double d1, double h1) const {
    const double r0 = std::sqrt(d0 * d0 + h0 * h0);
    const double r1 = std::sqrt(d1 * d1 + h1 * h1);
    double low = std::min(r0, r1);
    const double high = std::max(r0, r1);
    // The foot of the perpendicular from the antenna, when it lies on the piece, is nearer than both ends.
    const double dd = d1 - d0;
    const double dh = h1 - h0;
    const double length2 = dd * dd + dh * dh;
    const double along = -(d0 * dd + h0 * dh);
    if (along > 0 && along < length2) low = std::abs(d0 * dh - h0 * dd) / std::sqrt(length2);
    if (high < bins_.r_min_m || low >= bins_.r_max_m) return;
    const int last = high >= bins_.r_max_m ? bins_.n_range - 1 : bins_.range_bin(high);
    for (int bin = low < bins_.r_min_m ? 0 : bins_.range_bin(low); bin <= last; ++bin)
      plane[static_cast<std::size_t>(bin)] = 1;
  }

  const BinGrid& bins_;
  double antenna_y_m_;
  ProfileResult& result_;
  double horizon_ = -kInfinity;  // highest tangent of elevation so far
  bool joined_ = false;
  double last_d_m_ = 0;
  double last_h_m_ = 0;
};

/// Ground distances at which the half-line is over the grid: [from, to], empty when from >= to.
struct Clip {
  double from = 0;
  double to;

  Clip(const HeightGrid& grid, double x, double z, double sin_b, double cos_b, double reach) : to(reach) {
    cut(x, sin_b, grid.x0_m, grid.x1_m());
    cut(z, cos_b, grid.z0_m, grid.z1_m());
  }
  void cut(double start, double rate, double low, double high) {
    if (rate == 0) {
      if (start < low || start > high) to = -1;
      return;
    }
    const double a = (low - start) / rate;
    const double b = (high - start) / rate;
    from = std::max(from, std::min(a, b));
    to = std::min(to, std::max(a, b));
  }
};

/// Feeds the pieces of one grid cell, cut at its diagonal and at footprint edges, to the marcher.
class CellCutter {
 public:
  CellCutter(const HeightGrid& grid, const glm::dvec3& antenna, double sin_b, double cos_b,
             std::vector<FootprintSpan> steps, Marcher& marcher)
      : grid_(grid),
        antenna_(antenna),
        sin_b_(sin_b),
        cos_b_(cos_b),
        steps_(std::move(steps)),
        marcher_(marcher) {}

  void cell(int i, int j, double d0, double d1) {
    // Along the line s + t (cell units) changes linearly; the triangles meet where it is 1.
    const double u0 = sum_at(i, j, d0);
    const double u1 = sum_at(i, j, d1);
    if ((u0 < 1) != (u1 < 1)) {
      const double cut = std::clamp(d0 + (d1 - d0) * (1 - u0) / (u1 - u0), d0, d1);
      triangle(i, j, u0 > u1, d0, cut);
      triangle(i, j, u0 < u1, cut, d1);
    } else {
      triangle(i, j, u0 + u1 > 2, d0, d1);
    }
  }

 private:
  double sum_at(int i, int j, double d) const {
    return (antenna_.x + d * sin_b_ - grid_.node_x_m(i) + antenna_.z + d * cos_b_ - grid_.node_z_m(j)) /
           grid_.cell_m;
  }

  void triangle(int i, int j, bool upper, double d0, double d1) {
    if (!(d1 > d0)) return;
    const double y10 = grid_.node_y_m(i + 1, j);
    const double y01 = grid_.node_y_m(i, j + 1);
    const double base = upper ? grid_.node_y_m(i + 1, j + 1) : grid_.node_y_m(i, j);
    const double slope_x = (upper ? base - y01 : y10 - base) / grid_.cell_m;
    const double slope_z = (upper ? base - y10 : y01 - base) / grid_.cell_m;
    const double x = antenna_.x - grid_.node_x_m(upper ? i + 1 : i);
    const double z = antenna_.z - grid_.node_z_m(upper ? j + 1 : j);
    const double start = base + slope_x * x + slope_z * z;
    const double rise = slope_x * sin_b_ + slope_z * cos_b_;
    with_roofs(d0, d1, start, rise);
  }

  /// Ground y = start + rise d on [d0, d1], replaced by roofs that stand above it.
  void with_roofs(double d0, double d1, double start, double rise) {
    double d = d0;
    while (d < d1) {
      while (step_ < steps_.size() && steps_[step_].far_m <= d) ++step_;
      double end = d1;
      bool roofed = false;
      if (step_ < steps_.size()) {
        roofed = steps_[step_].near_m <= d;
        end = std::min(end, roofed ? steps_[step_].far_m : steps_[step_].near_m);
      }
      const double y0 = start + rise * d;
      const double y1 = start + rise * end;
      const double roof = roofed ? steps_[step_].roof_y_m : -kInfinity;
      marcher_.piece(d, std::max(y0, roof), end, std::max(y1, roof));
      d = end;
    }
  }

  const HeightGrid& grid_;
  const glm::dvec3& antenna_;
  double sin_b_;
  double cos_b_;
  std::vector<FootprintSpan> steps_;
  std::size_t step_ = 0;
  Marcher& marcher_;
};

}  // namespace

int profile_strands(const FramePlan& plan) {
  const double arc_m = plan.bins().r_max_m * plan.bins().azimuth_width_rad;
  const double pairs = std::ceil(arc_m / plan.scene().world().grid.cell_m / 2);
  return 2 * static_cast<int>(std::clamp(pairs, 1.0, 4.0));
}

void march_profile(const FramePlan& plan, double position, std::vector<FootprintSpan>& spans,
                   ProfileResult& result) {
  const BinGrid& bins = plan.bins();
  const Sector& sector = plan.sector();
  const World& world = plan.scene().world();
  const HeightGrid& grid = world.grid;
  const glm::dvec3& antenna = sector.antenna_m;
  result.visible.assign(static_cast<std::size_t>(bins.n_range), 0);
  result.present.assign(static_cast<std::size_t>(bins.n_range), 0);

  const double bearing = sector.bearing_rad + bins.azimuth_edge_rad(position);
  const double sin_b = std::sin(bearing);
  const double cos_b = std::cos(bearing);
  // A building that reaches across a bin's edge is in the lists of both bins.
  const int azimuth_bin = std::min(static_cast<int>(position), bins.n_azimuth - 1);
  spans.clear();
  for (const std::uint32_t b : plan.buildings_in(azimuth_bin))
    footprint_spans(world.buildings, world.buildings.list[b], antenna.x, antenna.z, sin_b, cos_b, spans);

  // The sector's ground between r_min and r_max at the median height, for coverage.
  const double clearance =
      plan.extent().any ? antenna.y - plan.extent().median_height_m -
                              world.frame.ellipsoid_y_m(antenna.x, antenna.z) / world.frame.radius_factor()
                        : 0.0;
  const double near_m = std::sqrt(std::max(0.0, bins.r_min_m * bins.r_min_m - clearance * clearance));
  const double far_m = std::sqrt(std::max(0.0, bins.r_max_m * bins.r_max_m - clearance * clearance));
  const auto ring_area = [&](double d0, double d1) {
    const double a = std::clamp(d0, near_m, far_m);
    const double b = std::clamp(d1, near_m, far_m);
    return 0.5 * bins.azimuth_width_rad * (b - a) * (b + a);
  };
  result.sector_area_m2 = ring_area(near_m, far_m);
  double missing_m2 = 0;

  Marcher marcher(bins, antenna.y, result);
  CellCutter cutter(grid, antenna, sin_b, cos_b, disjoint(spans), marcher);
  const Clip clip(grid, antenna.x, antenna.z, sin_b, cos_b, bins.r_max_m);
  if (!(clip.from < clip.to)) {
    result.covered_area_m2 = 0;
    return;
  }
  missing_m2 += ring_area(0, clip.from) + ring_area(clip.to, bins.r_max_m);

  // Cell by cell: the next grid line in x or z, whichever is nearer.
  const auto cell_of = [&](double at, double origin, int n) {
    return std::clamp(static_cast<int>(std::floor((at - origin) / grid.cell_m)), 0, n - 2);
  };
  int i = cell_of(antenna.x + clip.from * sin_b, grid.x0_m, grid.nx);
  int j = cell_of(antenna.z + clip.from * cos_b, grid.z0_m, grid.nz);
  const int step_i = sin_b > 0 ? 1 : -1;
  const int step_j = cos_b > 0 ? 1 : -1;
  double d = clip.from;
  while (d < clip.to && i >= 0 && j >= 0 && i < grid.nx - 1 && j < grid.nz - 1) {
    const double to_x = sin_b != 0 ? (grid.node_x_m(step_i > 0 ? i + 1 : i) - antenna.x) / sin_b : kInfinity;
    const double to_z = cos_b != 0 ? (grid.node_z_m(step_j > 0 ? j + 1 : j) - antenna.z) / cos_b : kInfinity;
    const double end = std::max(d, std::min({to_x, to_z, clip.to}));
    if (grid.cell_known(i, j)) {
      cutter.cell(i, j, d, end);
    } else {
      marcher.gap();
      missing_m2 += ring_area(d, end);
    }
    if (to_x < to_z) {
      i += step_i;
    } else {
      j += step_j;
    }
    d = end;
  }
  result.covered_area_m2 = std::max(0.0, result.sector_area_m2 - missing_m2);
}

}  // namespace obliq
