#include "server/radar/simd/ground_places.h"

#include "server/radar/simd/float_lanes.h"

namespace obliq::OBLIQ_ISA {

void ground_places(const PlaceOfEchoes& where, const GroundEchoes& echoes, std::uint64_t* place,
                   std::uint64_t* kind) {
  for (int k = 0; k < echoes.n; k += kLanes) {
    const mask8 there = lane_numbers<std::uint64_t, kLanes>() < static_cast<std::uint64_t>(echoes.n - k);
    const u64x8 at = select(there, load_u64(echoes.at + k), u64x8{});
    const u64x8 material = select(there, load_u64(echoes.material + k), u64x8{});
    const u64x8 bin = at >> GroundEchoes::kLog2Runs;
    const u64x8 profile = at & std::uint64_t{GroundEchoes::kRuns - 1};
    const f64x8 distance = converted<double>(load_as<f32x8>(echoes.distance_m + k));
    const f64x8 cells_per_m = gather(where.cells_per_m, bin);
    const f64x8 x = where.antenna_x_m + distance * gather(where.sin_bearing, profile);
    const f64x8 z = where.antenna_z_m + distance * gather(where.cos_bearing, profile);
    const u64x8 level = gather(where.level_bits, bin);
    store(place + k,
          (to_i64(floor(x * cells_per_m)) << 32) | (to_i64(floor(z * cells_per_m)) & 0xffffffffull));
    store(kind + k, level | material | 0xffffffff00000000ull);
  }
}

}  // namespace obliq::OBLIQ_ISA
