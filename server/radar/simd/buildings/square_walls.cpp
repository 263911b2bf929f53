// Walls of a part that stand square to the sight.
#include "server/radar/simd/buildings/square_walls.h"

#include "server/radar/simd/lanes/float_lanes.h"

namespace obliq::OBLIQ_ISA {

std::uint64_t square_walls(const ConvexShape& part, float middle, float most_along2) {
  std::uint64_t square = 0;
  for (int e = 0; e < part.n; e += kLanes) {
    const f32x8 right = load_as<f32x8>(part.right_m + e);
    const f32x8 ahead = load_as<f32x8>(part.ahead_m + e);
    const f32x8 dr = load_as<f32x8>(part.right_m + e + 1) - right;
    const f32x8 da = load_as<f32x8>(part.ahead_m + e + 1) - ahead;
    const f32x8 along = dr * middle + da;
    const unsigned faces =
        movemask((along * along <= most_along2 * (dr * dr + da * da)) & (ahead * dr - right * da > 0.0F));
    square |= std::uint64_t{faces} << e;
  }
  return square & part.walls;
}

}  // namespace obliq::OBLIQ_ISA
