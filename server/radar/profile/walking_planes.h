#pragma once
#include "server/radar/profile/ground_walk.h"
#include "server/radar/simd/exact_math.h"
#include "server/radar/simd/visible_ground.h"

namespace obliq {

/// Puts a plane where a walk stands.
template <typename Walk>
void stand_at(WalkingPlanes& planes, std::size_t lane, const Walk& walk) {
  planes.d_m[lane] = walk.at_m();
  planes.i[lane] = walk.cell_i();
  planes.j[lane] = walk.cell_j();
}

/// A plane that goes the way of a walk, from where it stands.
inline void set_out(WalkingPlanes& planes, std::size_t lane, SinCos bearing, const GroundWalk& walk) {
  planes.sin_bearing[lane] = bearing.sin;
  planes.cos_bearing[lane] = bearing.cos;
  planes.end_m[lane] = walk.end_m();
  stand_at(planes, lane, walk);
}

}  // namespace obliq
