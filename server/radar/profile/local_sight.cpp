#include "server/radar/profile/local_sight.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/scene/tolerances.h"
#include "terrain/base/asking.h"
#include "terrain/base/units.h"

namespace obliq {

namespace {

/// Most walks are short, and those that make them ask for them.
class WalkedCells {
 public:
  void one_more() {
    if (++n_ < kRun) return;
    ask(kACell * std::exchange(n_, 0));
  }

 private:
  static constexpr int kRun = 64;
  static constexpr int kACell = 16;  // in units of ask()
  int n_ = 0;
};
}  // namespace

SurfaceSegment SurfaceSegment::between_slopes(double low, double high) const {
  SurfaceSegment part = *this;
  const double dd = far_d_m - near_d_m;
  const double dh = far_h_m - near_h_m;
  // On the segment, h - slope d = 0 at t = (slope d0 - h0) / (dh - slope dd).
  if (low > near_slope) {
    const double t = std::clamp((low * near_d_m - near_h_m) / (dh - low * dd), 0.0, 1.0);
    part.near_d_m = near_d_m + t * dd;
    part.near_h_m = near_h_m + t * dh;
    part.near_slope = low;
  }
  if (high < far_slope) {
    const double t = std::clamp((high * near_d_m - near_h_m) / (dh - high * dd), 0.0, 1.0);
    part.far_d_m = near_d_m + t * dd;
    part.far_h_m = near_h_m + t * dh;
    part.far_slope = high;
  }
  return part;
}

SurfaceSegment SurfaceSegment::nearer_than(double d_m) const {
  SurfaceSegment part = *this;
  if (d_m < far_d_m) {
    const double t = std::clamp((d_m - near_d_m) / (far_d_m - near_d_m), 0.0, 1.0);
    part.far_d_m = near_d_m + t * (far_d_m - near_d_m);
    part.far_h_m = near_h_m + t * (far_h_m - near_h_m);
    part.far_slope = part.far_h_m / part.far_d_m;
  }
  return part;
}

LocalSurface::LocalSurface(const World& world, const glm::dvec3& antenna_m)
    : world_(world), antenna_m_(antenna_m), ground_(ground_view(world.grid, antenna_m)) {}

void LocalSurface::aim(double sin_bearing, double cos_bearing, const std::vector<RoofSpan>& stretches) {
  stretches_ = &stretches;
  outwards_ = profile_rates(ground_, sin_bearing, cos_bearing);
  inwards_ = profile_rates(ground_, -sin_bearing, -cos_bearing);
}

/// Walks the surface from the cell under ground distance d_m on until a void, or until begin(d), where a cell
/// begins, or segment(segment) returns false. Inwards it is the opposite profile that is marched, at
/// distances below 0: the same bits.
template <class Begin, class Segment>
void LocalSurface::walk(bool inwards, double d_m, const Begin& begin, const Segment& segment) {
  const ProfileRates<double>& p = inwards ? inwards_ : outwards_;
  const ProfileRates<double>& back = inwards ? outwards_ : inwards_;
  Cells<double> at{0, std::floor(p.start_u + d_m * outwards_.rate_u),
                   std::floor(p.start_v + d_m * outwards_.rate_v)};
  at.d = -cell_ends(ground_, back, at).nearest;
  if (!inwards) at.d = std::max(0.0, at.d);
  WalkedCells walked;
  bool goes_on = true;
  const auto next = [&](bool active, const CellEnds<double>& /*ends*/, double /*to*/) {
    return active && goes_on && begin(at.d);
  };
  const auto cell = [&](bool /*active*/, bool known, double /*number*/, double /*end*/) {
    goes_on = known;
    if (known) walked.one_more();
  };
  const auto triangle = [&](bool where, const TriangleCut<double>& cut, double d0, double d1) {
    if (!where || !goes_on) return;
    if (inwards) {
      cut_surface(at, cut, -cut.rise, -d1, -d0);
      goes_on = std::all_of(segments_.rbegin(), segments_.rend(), segment);
    } else {
      cut_surface(at, cut, cut.rise, d0, d1);
      goes_on = std::all_of(segments_.begin(), segments_.end(), segment);
    }
  };
  march(ground_, p, inwards ? 0.0 : kInfinity, at, next, cell, triangle);
}

/// The segments of a triangle from d0 to d1: ground, replaced by roofs that stand above it.
void LocalSurface::cut_surface(const Cells<double>& cell, const TriangleCut<double>& cut, double rise,
                               double d0, double d1) {
  segments_.clear();
  const double start = cut.start - antenna_m_.y;
  const double over_cell = 1 / ground_.grid.cell_m;
  SurfaceSegment ground;
  ground.normal_along = -rise;
  ground.normal_length2 = 1 + (cut.per_i * cut.per_i + cut.per_j * cut.per_j) * (over_cell * over_cell);
  ground.material = world_.material_of_cell(static_cast<int>(cell.i), static_cast<int>(cell.j));
  ground.raster_gamma = world_.raster_gamma_of_cell(static_cast<int>(cell.i), static_cast<int>(cell.j));
  const auto add_ground = [&](double from, double to) {
    segments_.emplace_back(ground).set_ends(from, start + rise * from, to, start + rise * to);
  };
  const std::vector<RoofSpan>& roofs = *stretches_;
  auto at = static_cast<std::size_t>(
      std::upper_bound(roofs.begin(), roofs.end(), d0,
                       [](double d, const RoofSpan& stretch) { return d < stretch.far_m; }) -
      roofs.begin());
  cut_at_roofs(roofs, at, d0, d1, add_ground, [&](const RoofSpan& roof, double from, double to) {
    if (from == roof.near_m && roof.wall != kNoFace) {
      double low = start + rise * from;
      if (at > 0 && roofs[at - 1].far_m == from) low = std::max(low, roofs[at - 1].roof_y_m - antenna_m_.y);
      add_wall(roof, low);
    }
    over_roof(cut.start, rise, roof.roof_y_m, from, to, add_ground,
              [&](double near, double far) { add_roof(roof, near, far); });
  });
}

/// The wall that a roof begins with, from `low` upwards.
void LocalSurface::add_wall(const RoofSpan& roof, double low) {
  const double high = roof.roof_y_m - antenna_m_.y;
  if (!(high > low)) return;
  SurfaceSegment& wall = segments_.emplace_back();
  wall.set_ends(roof.near_m, low, roof.near_m, high);
  // The component of its unit normal along the profile is the wall's own component across it.
  const Buildings& all = world_.buildings;
  const WallEdge edge = edge_of_wall(all, roof.wall);
  const double ax = static_cast<double>(all.ring_xz_m[edge.from].x) - antenna_m_.x;
  const double az = static_cast<double>(all.ring_xz_m[edge.from].y) - antenna_m_.z;
  const double bx = static_cast<double>(all.ring_xz_m[edge.to].x) - antenna_m_.x;
  const double bz = static_cast<double>(all.ring_xz_m[edge.to].y) - antenna_m_.z;
  const double a_side = ax * outwards_.cos - az * outwards_.sin;
  const double b_side = bx * outwards_.cos - bz * outwards_.sin;
  wall.normal_along = -(std::abs(b_side - a_side) / std::hypot(bx - ax, bz - az));
  wall.normal_up = 0;
  wall.face = roof.wall;
  wall.material = all.list[roof.building].material;
}

void LocalSurface::add_roof(const RoofSpan& roof, double d0, double d1) {
  const double h = roof.roof_y_m - antenna_m_.y;
  SurfaceSegment& segment = segments_.emplace_back();
  segment.set_ends(d0, h, d1, h);
  segment.face = world_.buildings.list[roof.building].first_face;
  segment.material = world_.buildings.list[roof.building].material;
}

void LocalSurface::walk_out(const SightPoint& from, double to_slope, double to_d_m,
                            std::vector<SurfaceSegment>& visible) {
  // Surface nearer than the hit is below its line of sight, or it would hide the hit: the running horizon
  // passes over it, and the whole first cell may be marched.
  double horizon = from.slope;
  int unseen = 0;
  const auto begin = [&](double d) { return unseen++ <= kLook_cells && d <= to_d_m + kTouching_m; };
  walk(false, from.d_m - kTouching_m, begin, [&](const SurfaceSegment& segment) {
    const double top = segment.far_slope;
    if (!(top > horizon)) return true;
    const double low = std::max(segment.near_slope, horizon);
    const double high = std::min(top, to_slope);
    if (high > low) visible.push_back(segment.between_slopes(low, high));
    horizon = std::max(horizon, high);
    unseen = 0;
    return horizon < to_slope;
  });
}

void LocalSurface::walk_in(const SightPoint& from, double to_slope, double to_d_m,
                           std::vector<SurfaceSegment>& visible) {
  const std::size_t first = visible.size();
  int unseen = 0;
  const auto begin = [&](double /*d*/) { return unseen++ <= kLook_cells; };
  walk(true, from.d_m + kTouching_m, begin, [&](const SurfaceSegment& whole) {
    if (whole.near_d_m > from.d_m + kTouching_m) return true;
    const SurfaceSegment segment =
        whole.far_d_m > from.d_m + kTouching_m ? whole.nearer_than(from.d_m) : whole;
    const double near = segment.near_slope;
    const double far = segment.far_slope;
    // Hide what lies behind; the hit itself is visible, its ray says so.
    const double top = std::min(std::max(near, far), from.slope);
    while (visible.size() > first && visible.back().near_slope < top) {
      SurfaceSegment& behind = visible.back();
      if (behind.far_slope > top) {
        behind = behind.between_slopes(top, behind.far_slope);
        break;
      }
      visible.pop_back();
    }
    const double low = std::max(near, to_slope);
    const double high = std::min(far, from.slope);
    if (high > low) {
      visible.push_back(segment.between_slopes(low, high));
      unseen = 0;
    }
    return !((far > near && near <= to_slope) || segment.near_d_m <= to_d_m);
  });
}

}  // namespace obliq
