#pragma once
// Walks the triangles of the ground along one vertical plane, outwards from the antenna.
#include <algorithm>
#include <cmath>
#include <glm/vec3.hpp>
#include <limits>

#include "terrain/height_grid.h"

namespace obliq {

/// Where a vertical plane crosses one triangle of the ground, from ground distance d0_m to d1_m: the line
/// y = start_m + rise d.
struct GroundPiece {
  double d0_m;
  double d1_m;
  double start_m;  ///< y of the triangle's plane straight above or below the antenna
  double rise;
  double per_cell_x_m;  ///< rise of the triangle's plane from one node to the next in x
  double per_cell_z_m;
  int i;  ///< cell
  int j;
  bool upper;  ///< the triangle of node (i + 1, j + 1), else of node (i, j)
};

/// One half of a vertical plane: ground distances from `from_m` (0 = straight below the antenna) to `to_m`
/// along (sin, cos), none that begins beyond `last_start_m`, cell by cell through the grid's lines and
/// diagonals. Exact up to double rounding: every crossing is worked out from the antenna, nothing
/// accumulates. May be left and taken up at any distance.
class GroundWalk {
 public:
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  GroundWalk(const HeightGrid& grid, const glm::dvec3& antenna_m, double sin_bearing, double cos_bearing,
             double from_m, double to_m, double last_start_m = kInfinity)
      : grid_(&grid),
        antenna_x_(antenna_m.x),
        antenna_z_(antenna_m.z),
        sin_(sin_bearing),
        cos_(cos_bearing),
        start_u_((antenna_m.x - grid.x0_m) / grid.cell_m),
        start_v_((antenna_m.z - grid.z0_m) / grid.cell_m),
        rate_u_(sin_bearing / grid.cell_m),
        rate_v_(cos_bearing / grid.cell_m),
        d_(from_m),
        end_m_(to_m),
        last_start_m_(last_start_m) {
    cut(antenna_x_, sin_, grid.x0_m, grid.x1_m());
    cut(antenna_z_, cos_, grid.z0_m, grid.z1_m());
    if (done()) return;
    i_ = cell_of(antenna_x_ + d_ * sin_, grid.x0_m, grid.nx);
    j_ = cell_of(antenna_z_ + d_ * cos_, grid.z0_m, grid.nz);
  }

  /// Where the walk stands: the first distance that no visit has had.
  double at_m() const { return d_; }
  /// The cell that it stands in.
  int cell_i() const { return i_; }
  int cell_j() const { return j_; }
  /// Walks at least through cells that begin at last_start_m.
  void reach(double last_start_m) { last_start_m_ = std::max(last_start_m_, last_start_m); }
  /// Where the plane leaves the grid, or to_m.
  double end_m() const { return end_m_; }
  bool done() const { return !(d_ < end_m_ && d_ <= last_start_m_ && on_grid(i_, j_)); }

  enum class Last { cut, whole };

  /// Walks on to `to_m` or until `visit.enough()` after a cell. The last cell is cut at to_m, or left to the
  /// next call (Last::whole) where it reaches beyond. Calls
  /// visit.ground(const GroundPiece&) for each triangle and visit.gap(d0_m, d1_m) for cells without known
  /// ground, in order of distance.
  template <class Visit>
  void advance(double to_m, Visit&& visit, Last last = Last::cut) {
    const HeightGrid& grid = *grid_;
    const double to = std::min(to_m, end_m_);
    const int step_i = sin_ > 0 ? 1 : -1;
    const int step_j = cos_ > 0 ? 1 : -1;
    const double per_x = sin_ != 0 ? 1 / sin_ : kInfinity;
    const double per_z = cos_ != 0 ? 1 / cos_ : kInfinity;
    int i = i_;
    int j = j_;
    double d = d_;
    // The next grid line in x or z, whichever is nearer.
    while (d < to && d <= last_start_m_ && on_grid(i, j)) {
      const double to_x =
          sin_ != 0 ? (grid.node_x_m(step_i > 0 ? i + 1 : i) - antenna_x_) * per_x : kInfinity;
      const double to_z =
          cos_ != 0 ? (grid.node_z_m(step_j > 0 ? j + 1 : j) - antenna_z_) * per_z : kInfinity;
      const double cell_end = std::min(to_x, to_z);
      if (last == Last::whole && cell_end > to_m) break;
      const double end = std::max(d, std::min(cell_end, to));
      visit_cell(i, j, d, end, visit);
      d = end;
      if (cell_end <= to) {
        if (to_x < to_z) {
          i += step_i;
        } else {
          j += step_j;
        }
      }
      if (visit.enough()) break;
    }
    i_ = i;
    j_ = j;
    d_ = d;
  }

 private:
  int cell_of(double at_m, double first_m, int n) const {
    return std::clamp(static_cast<int>(std::floor((at_m - first_m) / grid_->cell_m)), 0, n - 2);
  }

  bool on_grid(int i, int j) const { return i >= 0 && j >= 0 && i < grid_->nx - 1 && j < grid_->nz - 1; }

  /// Keeps the distances at which start + rate d lies in [low, high].
  void cut(double start, double rate, double low, double high) {
    if (rate == 0) {
      if (start < low || start > high) end_m_ = -1;
      return;
    }
    const double a = (low - start) / rate;
    const double b = (high - start) / rate;
    d_ = std::max(d_, std::min(a, b));
    end_m_ = std::min(end_m_, std::max(a, b));
  }

  /// Cell (i, j), crossed from d0 to d1. With s, t the position in the cell, the triangles meet at s + t = 1.
  template <class Visit>
  void visit_cell(int i, int j, double d0, double d1, Visit&& visit) const {
    const std::size_t at = grid_->index(i, j);
    const std::size_t above = at + static_cast<std::size_t>(grid_->nx);
    const auto y00 = static_cast<double>(grid_->y_m[at]);
    const auto y10 = static_cast<double>(grid_->y_m[at + 1]);
    const auto y01 = static_cast<double>(grid_->y_m[above]);
    const auto y11 = static_cast<double>(grid_->y_m[above + 1]);
    if (std::isnan((y00 + y10) + (y01 + y11))) {
      visit.gap(d0, d1);
      return;
    }
    const double s = start_u_ - i;
    const double t = start_v_ - j;
    const auto triangle = [&](bool upper, double from, double to) {
      if (!(to > from)) return;
      GroundPiece piece;
      piece.d0_m = from;
      piece.d1_m = to;
      piece.i = i;
      piece.j = j;
      piece.upper = upper;
      piece.per_cell_x_m = upper ? y11 - y01 : y10 - y00;
      piece.per_cell_z_m = upper ? y11 - y10 : y01 - y00;
      piece.start_m = upper ? y11 + piece.per_cell_x_m * (s - 1) + piece.per_cell_z_m * (t - 1)
                            : y00 + piece.per_cell_x_m * s + piece.per_cell_z_m * t;
      piece.rise = piece.per_cell_x_m * rate_u_ + piece.per_cell_z_m * rate_v_;
      visit.ground(piece);
    };
    const double rate = rate_u_ + rate_v_;
    const double sum0 = s + t + d0 * rate;
    const double sum1 = s + t + d1 * rate;
    if ((sum0 < 1) != (sum1 < 1)) {
      const double diagonal = std::clamp((1 - s - t) / rate, d0, d1);
      triangle(sum0 > sum1, d0, diagonal);
      triangle(sum0 < sum1, diagonal, d1);
    } else {
      triangle(sum0 + sum1 > 2, d0, d1);
    }
  }

  const HeightGrid* grid_;
  double antenna_x_;
  double antenna_z_;
  double sin_;
  double cos_;
  double start_u_;  // the antenna, in cells from node (0, 0)
  double start_v_;
  double rate_u_;  // cells a metre of ground distance
  double rate_v_;
  double d_;
  double end_m_;
  double last_start_m_;
  int i_ = 0;
  int j_ = 0;
};

}  // namespace obliq
