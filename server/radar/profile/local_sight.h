#pragma once
// What a plate covers: the surface that is visible next to a ray's hit, in the ray's vertical plane. Both
// walks are local: they end at the given slope or distance, at a void, or where nothing has been visible for
// kLook_cells, so that their cost follows the plate and not the scene.
#include <vector>

#include "server/radar/profile/local_surface.h"

namespace obliq {

/// A point of the plane that a ray says is visible.
struct SightPoint {
  double d_m = 0;  ///< ground distance from the antenna
  double h_m = 0;  ///< above the antenna
  double slope = 0;
};

/// Cells walked behind a crest, or in front of a foot, to find the surface that is visible next.
constexpr int kLook_cells = 16;

/// Appends the visible pieces beyond `from`, outwards, with slopes from from.slope to `to_slope`. Stops at
/// distance `to_d_m`, where another ray's hit is known. Returns the slope up to which the plane is answered:
/// to_slope, or the slope of the crest behind which the walk saw nothing more.
double walk_out(PlaneSurface& surface, const SightPoint& from, double to_slope, double to_d_m,
                std::vector<PlanePiece>& visible);

/// Appends the visible pieces nearer than `from`, inwards, with slopes from from.slope down to `to_slope`.
/// What rises in front hides what lies behind.
void walk_in(PlaneSurface& surface, const SightPoint& from, double to_slope, double to_d_m,
             std::vector<PlanePiece>& visible);

}  // namespace obliq
