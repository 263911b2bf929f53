#include "server/radar/simd/ground_places.h"

namespace obliq::OBLIQ_ISA {

void ground_places(const PlaceOfEchoes& where, const GroundEchoes& echoes, std::uint64_t* place,
                   std::uint64_t* kind) {
  for (int k = 0; k < echoes.n; k += kLanes) {
    u64x8 at{};
    u64x8 material{};
    for (int lane = 0; lane < kLanes; ++lane) {
      const bool there = k + lane < echoes.n;
      at[lane] = there ? echoes.at[k + lane] : 0;
      material[lane] = there ? echoes.material[k + lane] : 0;
    }
    const u64x8 bin = at >> 3;
    const u64x8 profile = at & 7;
    const f64x8 distance = load(echoes.distance_m + k);
    const f64x8 cells_per_m = gather(where.cells_per_m, bin);
    const f64x8 x = where.antenna_x_m + distance * gather(where.sin_bearing, profile);
    const f64x8 z = where.antenna_z_m + distance * gather(where.cos_bearing, profile);
    u64x8 level{};
    for (int lane = 0; lane < kLanes; ++lane) level[lane] = where.level_bits[bin[lane]];
    store(place + k,
          (to_i64(floor(x * cells_per_m)) << 32) | (to_i64(floor(z * cells_per_m)) & 0xffffffffull));
    store(kind + k, level | material | 0xffffffff00000000ull);
  }
}

}  // namespace obliq::OBLIQ_ISA
