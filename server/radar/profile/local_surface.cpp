#include "server/radar/profile/local_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace obliq {

namespace {
constexpr double kInfinity = std::numeric_limits<double>::infinity();
}

PlanePiece PlanePiece::between_slopes(double low, double high) const {
  PlanePiece part = *this;
  const double dd = far_d_m - near_d_m;
  const double dh = far_h_m - near_h_m;
  // On the piece, h - slope d = 0 at t = (slope d0 - h0) / (dh - slope dd).
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

PlanePiece PlanePiece::nearer_than(double d_m) const {
  PlanePiece part = *this;
  if (d_m < far_d_m) {
    const double t = std::clamp((d_m - near_d_m) / (far_d_m - near_d_m), 0.0, 1.0);
    part.far_d_m = near_d_m + t * (far_d_m - near_d_m);
    part.far_h_m = near_h_m + t * (far_h_m - near_h_m);
    part.far_slope = part.far_h_m / part.far_d_m;
  }
  return part;
}

PlaneSurface::PlaneSurface(const World& world, const glm::dvec3& antenna_m)
    : world_(world),
      antenna_m_(antenna_m),
      over_cell_m_(1 / world.grid.cell_m),
      start_u_((antenna_m.x - world.grid.x0_m) / world.grid.cell_m),
      start_v_((antenna_m.z - world.grid.z0_m) / world.grid.cell_m) {}

void PlaneSurface::aim(double sin_bearing, double cos_bearing, const std::vector<RoofStretch>& stretches) {
  stretches_ = &stretches;
  sin_bearing_ = sin_bearing;
  cos_bearing_ = cos_bearing;
  per_x_ = sin_bearing != 0 ? 1 / sin_bearing : kInfinity;
  per_z_ = cos_bearing != 0 ? 1 / cos_bearing : kInfinity;
  rate_u_ = sin_bearing * over_cell_m_;
  rate_v_ = cos_bearing * over_cell_m_;
}

PlaneSurface::Cell PlaneSurface::cell_at(double d_m) const {
  return bounded(static_cast<int>(std::floor(start_u_ + d_m * rate_u_)),
                 static_cast<int>(std::floor(start_v_ + d_m * rate_v_)));
}

PlaneSurface::Cell PlaneSurface::next_out(const Cell& cell) const {
  return cell.leaves_by_x ? bounded(cell.i + (sin_bearing_ > 0 ? 1 : -1), cell.j)
                          : bounded(cell.i, cell.j + (cos_bearing_ > 0 ? 1 : -1));
}

PlaneSurface::Cell PlaneSurface::next_in(const Cell& cell) const {
  return cell.enters_by_x ? bounded(cell.i - (sin_bearing_ > 0 ? 1 : -1), cell.j)
                          : bounded(cell.i, cell.j - (cos_bearing_ > 0 ? 1 : -1));
}

/// The same expression for a grid line gives the same bits from both of its sides, so that cells join.
PlaneSurface::Cell PlaneSurface::bounded(int i, int j) const {
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

const std::vector<PlanePiece>& PlaneSurface::pieces(const Cell& cell) {
  pieces_.clear();
  if (!(cell.to_m > cell.from_m)) return pieces_;
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
  return pieces_;
}

void PlaneSurface::add_triangle(const Cell& cell, bool upper, double d0, double d1) {
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
  PlanePiece ground;
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

void PlaneSurface::add_ground(const PlanePiece& ground, double d0, double d1) {
  PlanePiece& piece = pieces_.emplace_back(ground);
  piece.set_ends(d0, ground_start_m_ + ground_rise_ * d0, d1, ground_start_m_ + ground_rise_ * d1);
}

/// Ground from d0 to d1, replaced by roofs that stand above it.
void PlaneSurface::add_with_roofs(const PlanePiece& ground, double d0, double d1) {
  auto roof = std::upper_bound(stretches_->begin(), stretches_->end(), d0,
                               [](double d, const RoofStretch& stretch) { return d < stretch.far_m; });
  double d = d0;
  for (; d < d1 && roof != stretches_->end(); ++roof) {
    if (roof->near_m >= d1) break;
    if (roof->near_m > d) add_ground(ground, d, roof->near_m);
    const double begin = std::max(d, roof->near_m);
    const double end = std::min(d1, roof->far_m);
    if (begin == roof->near_m && roof->near_wall != kNoFace) {
      double low = ground_start_m_ + ground_rise_ * begin;
      if (roof != stretches_->begin() && std::prev(roof)->far_m == begin)
        low = std::max(low, std::prev(roof)->roof_y_m - antenna_m_.y);
      const double high = roof->roof_y_m - antenna_m_.y;
      if (high > low) {
        PlanePiece& wall = pieces_.emplace_back();
        wall.set_ends(begin, low, begin, high);
        wall.normal_along = roof->wall_normal_along;
        wall.normal_up = 0;
        wall.face = roof->near_wall;
        wall.material = world_.buildings.list[roof->building].material;
      }
    }
    add_roof(ground, *roof, begin, end);
    d = end;
  }
  if (d < d1) add_ground(ground, d, d1);
}

/// The higher of roof and ground from d0 to d1.
void PlaneSurface::add_roof(const PlanePiece& ground, const RoofStretch& roof, double d0, double d1) {
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

void PlaneSurface::add_flat_roof(const RoofStretch& roof, double d0, double d1) {
  if (!(d1 > d0)) return;
  const double h = roof.roof_y_m - antenna_m_.y;
  PlanePiece& piece = pieces_.emplace_back();
  piece.set_ends(d0, h, d1, h);
  piece.face = world_.buildings.list[roof.building].first_face;
  piece.material = world_.buildings.list[roof.building].material;
}

}  // namespace obliq
