#pragma once
// Walks the triangles of the ground along one vertical profile, outwards from the antenna.
#include <algorithm>
#include <cmath>
#include <glm/vec3.hpp>
#include <utility>

#include "server/radar/simd/ground/ground_cells.h"
#include "server/radar/simd/ground/horizon.h"
#include "server/radar/simd/ground/profiles.h"
#include "server/radar/simd/lanes/exact_math.h"
#include "terrain/base/asking.h"
#include "terrain/base/units.h"
#include "terrain/height_grid.h"

namespace obliq {

/// Where a vertical profile crosses one triangle of the ground, from ground distance d0_m to d1_m: the line
/// y = start_m + rise d.
struct GroundSegment {
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

/// One half of a vertical profile: ground distances from `from_m` (0 = straight below the antenna) to `to_m`
/// along (sin, cos), none that begins beyond `last_start_m`, cell by cell through the grid's lines and
/// diagonals. Ends at end_m(), the nearer of to_m and the grid's border. Exact up to double rounding: every
/// crossing is worked out from the antenna, nothing accumulates. May be left and taken up at any distance.
class GroundWalk {
 public:
  GroundWalk(const HeightGrid& grid, const glm::dvec3& antenna_m, double sin_bearing, double cos_bearing,
             double from_m, double to_m, double last_start_m = kInfinity)
      : ground_(ground_view(grid, antenna_m)),
        rates_(profile_rates(ground_, sin_bearing, cos_bearing)),
        at_{from_m, 0, 0},
        end_m_(to_m),
        last_start_m_(last_start_m) {
    cut(antenna_m.x, sin_bearing, grid.x0_m, grid.x1_m());
    cut(antenna_m.z, cos_bearing, grid.z0_m, grid.z1_m());
    if (done()) return;
    at_.i = cell_of(antenna_m.x + at_.d * sin_bearing, grid.x0_m, grid.nx);
    at_.j = cell_of(antenna_m.z + at_.d * cos_bearing, grid.z0_m, grid.nz);
  }

  /// Where the walk stands: the first distance that no visit has had.
  double at_m() const { return at_.d; }
  /// The cell that it stands in.
  int cell_i() const { return static_cast<int>(at_.i); }
  int cell_j() const { return static_cast<int>(at_.j); }
  /// Walks at least through cells that begin at last_start_m.
  void reach(double last_start_m) { last_start_m_ = std::max(last_start_m_, last_start_m); }
  /// Where the profile leaves the grid, or to_m.
  double end_m() const { return end_m_; }
  bool done() const { return !(at_.d < end_m_ && at_.d <= last_start_m_ && at_.on(ground_.grid)); }

  enum class Last { cut, whole };

  /// Walks on to `to_m` or until `visit.enough()` after a cell. The last cell is cut at to_m, or left to the
  /// next call (Last::whole) where it reaches beyond. Calls
  /// visit.ground(const GroundSegment&) for each triangle and visit.gap(d0_m, d1_m) for cells without known
  /// ground, in order of distance.
  template <class Visit>
  void advance(double to_m, Visit&& visit, Last last = Last::cut) {
    Cells<double> at = at_;
    bool begun = false;
    const auto next = [&](bool active, const CellEnds<double>& ends, double /*to*/) {
      if (begun && visit.enough()) return false;
      return active && at.d <= last_start_m_ && (last == Last::cut || ends.nearest <= to_m);
    };
    const auto cell = [&](bool /*active*/, bool known, double /*number*/, double end) {
      begun = true;
      if (!known) visit.gap(at.d, end);
    };
    const auto triangle = [&](bool where, const TriangleCut<double>& cut, double d0, double d1) {
      if (where)
        visit.ground(GroundSegment{d0, d1, cut.start, cut.rise, cut.per_i, cut.per_j, static_cast<int>(at.i),
                                   static_cast<int>(at.j), cut.upper});
    };
    march(ground_, rates_, std::min(to_m, end_m_), at, next, cell, triangle);
    at_ = at;
  }

 private:
  int cell_of(double at_m, double first_m, int n) const {
    return std::clamp(static_cast<int>(std::floor((at_m - first_m) / ground_.grid.cell_m)), 0, n - 2);
  }

  /// Keeps the distances at which start + rate d lies in [low, high].
  void cut(double start, double rate, double low, double high) {
    if (rate == 0) {
      if (start < low || start > high) end_m_ = -1;
      return;
    }
    const double a = (low - start) / rate;
    const double b = (high - start) / rate;
    at_.d = std::max(at_.d, std::min(a, b));
    end_m_ = std::min(end_m_, std::max(a, b));
  }

  GroundView ground_;
  ProfileRates<double> rates_;
  Cells<double> at_;
  double end_m_;
  double last_start_m_;
};

/// Asks for the cells that profiles march from one call to the next.
class MarchedCells {
 public:
  MarchedCells(const WalkingProfiles& profiles, const HeightGrid& grid)
      : profiles_(profiles), per_m_(kPerWidth / grid.cell_m), before_m_(way_m()) {}

  void ask_for_them() {
    const double now_m = way_m();
    ask(static_cast<std::int64_t>((now_m - std::exchange(before_m_, now_m)) * per_m_) + 1);
  }

 private:
  static constexpr double kPerWidth = 1.27;  ///< 4 / pi: lines of both directions are crossed

  /// A profile that is through may stand infinitely far off.
  double way_m() const {
    double sum = 0;
    for (int lane = 0; lane < WalkingProfiles::kLanes; ++lane)
      sum += std::min(profiles_.d_m[lane], profiles_.end_m[lane]);
    return sum;
  }

  const WalkingProfiles& profiles_;
  double per_m_;
  double before_m_;
};

/// Puts a profile where a walk stands.
inline void stand_at(WalkingProfiles& profiles, std::size_t lane, const GroundWalk& walk) {
  profiles.d_m[lane] = walk.at_m();
  profiles.i[lane] = walk.cell_i();
  profiles.j[lane] = walk.cell_j();
}

/// A profile that goes the way of a walk, from where it stands.
inline void set_out(WalkingProfiles& profiles, std::size_t lane, SinCos bearing, const GroundWalk& walk) {
  profiles.sin_bearing[lane] = bearing.sin;
  profiles.cos_bearing[lane] = bearing.cos;
  profiles.end_m[lane] = walk.end_m();
  stand_at(profiles, lane, walk);
}

/// What a profile stands for: width_rad[k] up to ground distance to_m[k], the last one infinite.
struct GroundWidths {
  const double* width_rad;
  const double* to_m;
};

/// A profile over bare ground that begins at the nadir.
inline void set_out(SightProfiles& profiles, std::size_t lane, SinCos bearing, const HeightGrid& grid,
                    const glm::dvec3& antenna_m, GroundWidths widths) {
  set_out(profiles, lane, bearing, GroundWalk(grid, antenna_m, bearing.sin, bearing.cos, 0, kInfinity));
  const Horizon<double> nothing;
  profiles.horizon_d_m[lane] = nothing.d_m;
  profiles.horizon_h_m[lane] = nothing.h_m;
  profiles.width_rad[lane] = *widths.width_rad;
  profiles.width_to_m[lane] = *widths.to_m;
  profiles.next_width_rad[lane] = widths.width_rad + 1;
  profiles.next_width_to_m[lane] = widths.to_m + 1;
}

}  // namespace obliq
