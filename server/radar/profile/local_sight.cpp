#include "server/radar/profile/local_sight.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "server/scene/tolerances.h"
#include "terrain/base/asking.h"

namespace obliq {

namespace {
constexpr double kInfinity = std::numeric_limits<double>::infinity();

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
    : world_(world),
      antenna_m_(antenna_m),
      over_cell_m_(1 / world.grid.cell_m),
      start_u_((antenna_m.x - world.grid.x0_m) / world.grid.cell_m),
      start_v_((antenna_m.z - world.grid.z0_m) / world.grid.cell_m) {}

void LocalSurface::aim(double sin_bearing, double cos_bearing, const std::vector<RoofSpan>& stretches) {
  stretches_ = &stretches;
  sin_bearing_ = sin_bearing;
  cos_bearing_ = cos_bearing;
  per_x_ = sin_bearing != 0 ? 1 / sin_bearing : kInfinity;
  per_z_ = cos_bearing != 0 ? 1 / cos_bearing : kInfinity;
  rate_u_ = sin_bearing * over_cell_m_;
  rate_v_ = cos_bearing * over_cell_m_;
}

LocalSurface::Cell LocalSurface::cell_at(double d_m) const {
  return bounded(static_cast<int>(std::floor(start_u_ + d_m * rate_u_)),
                 static_cast<int>(std::floor(start_v_ + d_m * rate_v_)));
}

LocalSurface::Cell LocalSurface::next_out(const Cell& cell) const {
  return cell.leaves_by_x ? bounded(cell.i + (sin_bearing_ > 0 ? 1 : -1), cell.j)
                          : bounded(cell.i, cell.j + (cos_bearing_ > 0 ? 1 : -1));
}

LocalSurface::Cell LocalSurface::next_in(const Cell& cell) const {
  return cell.enters_by_x ? bounded(cell.i - (sin_bearing_ > 0 ? 1 : -1), cell.j)
                          : bounded(cell.i, cell.j - (cos_bearing_ > 0 ? 1 : -1));
}

/// The same expression for a grid line gives the same bits from both of its sides, so that cells join.
LocalSurface::Cell LocalSurface::bounded(int i, int j) const {
  const HeightGrid& grid = world_.grid;
  Cell cell;
  cell.i = i;
  cell.j = j;
  const int east = sin_bearing_ > 0 ? 1 : 0;
  const int north = cos_bearing_ > 0 ? 1 : 0;
  const bool along_z = sin_bearing_ == 0;
  const bool along_x = cos_bearing_ == 0;
  const double out_x = along_z ? kInfinity : (grid.node_x_m(i + east) - antenna_m_.x) * per_x_;
  const double out_z = along_x ? kInfinity : (grid.node_z_m(j + north) - antenna_m_.z) * per_z_;
  const double in_x = along_z ? -kInfinity : (grid.node_x_m(i + 1 - east) - antenna_m_.x) * per_x_;
  const double in_z = along_x ? -kInfinity : (grid.node_z_m(j + 1 - north) - antenna_m_.z) * per_z_;
  cell.leaves_by_x = out_x < out_z;
  cell.enters_by_x = in_x > in_z;
  cell.from_m = std::max({0.0, in_x, in_z});
  cell.to_m = std::min(out_x, out_z);
  return cell;
}

const std::vector<SurfaceSegment>& LocalSurface::segments(const Cell& cell) {
  segments_.clear();
  if (!(cell.to_m > cell.from_m)) return segments_;
  // With s, t the position in the cell, its triangles meet at s + t = 1.
  const double start = start_u_ - cell.i + (start_v_ - cell.j);
  const double rate = rate_u_ + rate_v_;
  const double sum0 = start + cell.from_m * rate;
  const double sum1 = start + cell.to_m * rate;
  if ((sum0 < 1) != (sum1 < 1)) {
    const double cut = std::clamp((1 - start) / rate, cell.from_m, cell.to_m);
    add_triangle(cell, sum0 > sum1, cell.from_m, cut);
    add_triangle(cell, sum0 < sum1, cut, cell.to_m);
  } else {
    add_triangle(cell, sum0 + sum1 > 2, cell.from_m, cell.to_m);
  }
  return segments_;
}

void LocalSurface::add_triangle(const Cell& cell, bool upper, double d0, double d1) {
  if (!(d1 > d0)) return;
  const HeightGrid& grid = world_.grid;
  const double y10 = grid.node_y_m(cell.i + 1, cell.j);
  const double y01 = grid.node_y_m(cell.i, cell.j + 1);
  const int corner = upper ? 1 : 0;
  const double base = grid.node_y_m(cell.i + corner, cell.j + corner);
  const double per_u = upper ? base - y01 : y10 - base;
  const double per_v = upper ? base - y10 : y01 - base;
  ground_start_m_ =
      base + per_u * (start_u_ - (cell.i + corner)) + per_v * (start_v_ - (cell.j + corner)) - antenna_m_.y;
  ground_rise_ = per_u * rate_u_ + per_v * rate_v_;
  SurfaceSegment ground;
  const double over_cell2 = over_cell_m_ * over_cell_m_;
  ground.normal_along = -ground_rise_;
  ground.normal_length2 = 1 + (per_u * per_u + per_v * per_v) * over_cell2;
  ground.material = world_.material_of_cell(cell.i, cell.j);
  if (stretches_->empty()) {
    add_ground(ground, d0, d1);
  } else {
    add_with_roofs(ground, d0, d1);
  }
}

void LocalSurface::add_ground(const SurfaceSegment& ground, double d0, double d1) {
  SurfaceSegment& segment = segments_.emplace_back(ground);
  segment.set_ends(d0, ground_start_m_ + ground_rise_ * d0, d1, ground_start_m_ + ground_rise_ * d1);
}

/// Ground from d0 to d1, replaced by roofs that stand above it.
void LocalSurface::add_with_roofs(const SurfaceSegment& ground, double d0, double d1) {
  auto roof = std::upper_bound(stretches_->begin(), stretches_->end(), d0,
                               [](double d, const RoofSpan& stretch) { return d < stretch.far_m; });
  double d = d0;
  for (; d < d1 && roof != stretches_->end(); ++roof) {
    if (roof->near_m >= d1) break;
    if (roof->near_m > d) add_ground(ground, d, roof->near_m);
    const double begin = std::max(d, roof->near_m);
    const double end = std::min(d1, roof->far_m);
    if (begin == roof->near_m && roof->wall != kNoFace) {
      double low = ground_start_m_ + ground_rise_ * begin;
      if (roof != stretches_->begin() && std::prev(roof)->far_m == begin)
        low = std::max(low, std::prev(roof)->roof_y_m - antenna_m_.y);
      add_wall(*roof, low);
    }
    add_roof(ground, *roof, begin, end);
    d = end;
  }
  if (d < d1) add_ground(ground, d, d1);
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
  const double a_side = ax * cos_bearing_ - az * sin_bearing_;
  const double b_side = bx * cos_bearing_ - bz * sin_bearing_;
  wall.normal_along = -(std::abs(b_side - a_side) / std::hypot(bx - ax, bz - az));
  wall.normal_up = 0;
  wall.face = roof.wall;
  wall.material = all.list[roof.building].material;
}

/// The higher of roof and ground from d0 to d1.
void LocalSurface::add_roof(const SurfaceSegment& ground, const RoofSpan& roof, double d0, double d1) {
  if (!(d1 > d0)) return;
  const double h = roof.roof_y_m - antenna_m_.y;
  // How high the ground stands over the roof at both ends.
  const double over0 = ground_start_m_ + ground_rise_ * d0 - h;
  const double over1 = ground_start_m_ + ground_rise_ * d1 - h;
  const double cut = (over0 > 0) != (over1 > 0) ? std::clamp(d0 - over0 / ground_rise_, d0, d1)
                     : over0 > 0                ? d1
                                                : d0;
  // Ground on [d0, cut] and roof behind it, or the other way round when the ground rises out of the roof.
  if (over1 > 0 && !(over0 > 0)) {
    add_flat_roof(roof, d0, cut);
    add_ground(ground, cut, d1);
  } else {
    if (cut > d0) add_ground(ground, d0, cut);
    add_flat_roof(roof, cut, d1);
  }
}

void LocalSurface::add_flat_roof(const RoofSpan& roof, double d0, double d1) {
  if (!(d1 > d0)) return;
  const double h = roof.roof_y_m - antenna_m_.y;
  SurfaceSegment& segment = segments_.emplace_back();
  segment.set_ends(d0, h, d1, h);
  segment.face = world_.buildings.list[roof.building].first_face;
  segment.material = world_.buildings.list[roof.building].material;
}

void walk_out(LocalSurface& surface, const SightPoint& from, double to_slope, double to_d_m,
              std::vector<SurfaceSegment>& visible) {
  WalkedCells walked;
  // Whatever lies nearer than the hit is lower in elevation, or it would hide the hit: the running horizon
  // passes over it, and the whole first cell may be looked at.
  double horizon = from.slope;
  int unseen = 0;
  LocalSurface::Cell cell = surface.cell_at(from.d_m - kTouching_m);
  for (; surface.known(cell) && unseen <= kLook_cells; cell = surface.next_out(cell)) {
    if (cell.from_m > to_d_m + kTouching_m) return;
    walked.one_more();
    ++unseen;
    for (const SurfaceSegment& segment : surface.segments(cell)) {
      const double top = segment.far_slope;
      if (!(top > horizon)) continue;
      const double low = std::max(segment.near_slope, horizon);
      const double high = std::min(top, to_slope);
      if (high > low) visible.push_back(segment.between_slopes(low, high));
      horizon = std::max(horizon, high);
      unseen = 0;
      if (horizon >= to_slope) return;
    }
  }
}

void walk_in(LocalSurface& surface, const SightPoint& from, double to_slope, double to_d_m,
             std::vector<SurfaceSegment>& visible) {
  const std::size_t first = visible.size();
  WalkedCells walked;
  int unseen = 0;
  LocalSurface::Cell cell = surface.cell_at(from.d_m + kTouching_m);
  for (; surface.known(cell) && unseen <= kLook_cells; cell = surface.next_in(cell)) {
    walked.one_more();
    ++unseen;
    const std::vector<SurfaceSegment>& segments = surface.segments(cell);
    for (auto at = segments.rbegin(); at != segments.rend(); ++at) {
      if (at->near_d_m > from.d_m + kTouching_m) continue;
      const SurfaceSegment segment = at->far_d_m > from.d_m + kTouching_m ? at->nearer_than(from.d_m) : *at;
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
      if ((far > near && near <= to_slope) || segment.near_d_m <= to_d_m) return;
    }
  }
}

}  // namespace obliq
