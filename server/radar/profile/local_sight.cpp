#include "server/radar/profile/local_sight.h"

#include <algorithm>

namespace obliq {
namespace {

/// A hit on a wall or a cell's border may be rounded to either side of it.
constexpr double kBorder_m = 1e-6;

}  // namespace

double walk_out(PlaneSurface& surface, const SightPoint& from, double to_slope, double to_d_m,
                std::vector<PlanePiece>& visible) {
  // Whatever lies nearer than the hit is lower in elevation, or it would hide the hit: the running horizon
  // passes over it, and the whole first cell may be looked at.
  double horizon = from.slope;
  int unseen = 0;
  PlaneSurface::Cell cell = surface.cell_at(from.d_m - kBorder_m);
  for (; surface.known(cell) && unseen <= kLook_cells; cell = surface.next_out(cell)) {
    if (cell.from_m > to_d_m + kBorder_m) return to_slope;
    ++unseen;
    for (const PlanePiece& piece : surface.pieces(cell)) {
      const double top = piece.far_slope;
      if (!(top > horizon)) continue;
      const double low = std::max(piece.near_slope, horizon);
      const double high = std::min(top, to_slope);
      if (high > low) visible.push_back(piece.between_slopes(low, high));
      horizon = std::max(horizon, high);
      unseen = 0;
      if (horizon >= to_slope) return to_slope;
    }
  }
  return horizon;
}

void walk_in(PlaneSurface& surface, const SightPoint& from, double to_slope, double to_d_m,
             std::vector<PlanePiece>& visible) {
  const std::size_t first = visible.size();
  int unseen = 0;
  PlaneSurface::Cell cell = surface.cell_at(from.d_m + kBorder_m);
  for (; surface.known(cell) && unseen <= kLook_cells; cell = surface.next_in(cell)) {
    ++unseen;
    const std::vector<PlanePiece>& pieces = surface.pieces(cell);
    for (auto at = pieces.rbegin(); at != pieces.rend(); ++at) {
      if (at->near_d_m > from.d_m + kBorder_m) continue;
      const PlanePiece piece = at->far_d_m > from.d_m + kBorder_m ? at->nearer_than(from.d_m) : *at;
      const double near = piece.near_slope;
      const double far = piece.far_slope;
      // Hide what lies behind; the hit itself is visible, its ray says so.
      const double top = std::min(std::max(near, far), from.slope);
      while (visible.size() > first && visible.back().near_slope < top) {
        PlanePiece& behind = visible.back();
        if (behind.far_slope > top) {
          behind = behind.between_slopes(top, behind.far_slope);
          break;
        }
        visible.pop_back();
      }
      const double low = std::max(near, to_slope);
      const double high = std::min(far, from.slope);
      if (high > low) {
        visible.push_back(piece.between_slopes(low, high));
        unseen = 0;
      }
      if ((far > near && near <= to_slope) || piece.near_d_m <= to_d_m) return;
    }
  }
}

}  // namespace obliq
