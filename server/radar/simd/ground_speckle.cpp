// SpeckleField::response for eight ground cells at a time, to the bit.
#include "server/radar/simd/ground_speckle.h"

#include "server/radar/simd/exact_math.h"
#include "server/radar/simd/grid_walk.h"
#include "terrain/base/hash.h"

namespace obliq::OBLIQ_ISA {
namespace {

/// HeightGrid::height_at_m; NaN off the grid or over unknown ground.
OBLIQ_INLINE f64x8 height_at(const GridView& grid, f64x8 x, f64x8 z) {
  const f64x8 u = (x - grid.x0_m) / grid.cell_m;
  const f64x8 v = (z - grid.z0_m) / grid.cell_m;
  const double last_u = grid.nx - 1;
  const double last_v = grid.nz - 1;
  const mask8 on_grid = (u >= 0.0) & (v >= 0.0) & (u <= last_u) & (v <= last_v);
  const f64x8 low_u = floor(select(on_grid, u, f64x8{}));
  const f64x8 low_v = floor(select(on_grid, v, f64x8{}));
  const f64x8 i = select(low_u > last_u - 1, broadcast(last_u - 1), low_u);
  const f64x8 j = select(low_v > last_v - 1, broadcast(last_v - 1), low_v);
  const auto [y00, y10, y01, y11, known] = corners(grid, j * static_cast<double>(grid.nx) + i);
  const f64x8 s = u - i;
  const f64x8 t = v - j;
  return select(on_grid & known, height_on_triangles(y00, y10, y01, y11, s, t), broadcast(__builtin_nan("")));
}

/// The middle of a ground cell.
struct Centre {
  f64x8 x, z;
};

OBLIQ_INLINE Centre centre_of(u64x8 place, u64x8 kind) {
  // Cell numbers are 32-bit integers of either sign: counted from the least one they are whole numbers.
  const f64x8 x_cell = to_doubles((place >> 32) ^ 0x80000000ull) - 0x1p31;
  const f64x8 z_cell = to_doubles((place & 0xffffffffull) ^ 0x80000000ull) - 0x1p31;
  const u64x8 level = ((kind >> 8) & 0xffff) ^ 0x8000;
  const f64x8 side = as_doubles((level - std::uint64_t{0x8000 - 1023}) << 52);
  return {(x_cell + 0.5) * side, (z_cell + 0.5) * side};
}

/// Asks for the heights under the cells of scatterers [k, k + 8), roughly.
OBLIQ_INLINE void ask_for_heights(const GridView& grid, const SpeckleBlock& block, int k, double per_cell) {
  const auto [x, z] = centre_of(load_u64(block.place + k), load_u64(block.kind + k));
  prefetch_cells(grid, (x - grid.x0_m) * per_cell, (z - grid.z0_m) * per_cell);
}

}  // namespace

void ground_speckle(const SpeckleGround& ground, const SpeckleBlock& block) {
  constexpr int kAhead = 4 * kLanes;
  const bool owned = ground.owners.ground;
  const double per_cell = 1 / ground.view.grid.cell_m;
  for (int k = 0; k < kAhead && k < block.n; k += kLanes)
    ask_for_heights(ground.view.grid, block, k, per_cell);
  for (int k = 0; k < block.n; k += kLanes) {
    if (k + kAhead < block.n) ask_for_heights(ground.view.grid, block, k + kAhead, per_cell);
    const u64x8 place = load_u64(block.place + k);
    u64x8 kind = load_u64(block.kind + k) & 0xffffffffull;
    const u64x8 place_hash = mix_words(place ^ ground.seed);
    auto [x, z] = centre_of(place, kind);
    if (owned) {
      const f64x8 side = as_doubles(((((kind >> 8) & 0xffff) ^ 0x8000) - std::uint64_t{0x8000 - 1023}) << 52);
      x += (jitter<f64x8>(place_hash, 0) - 0.5) * side;
      z += (jitter<f64x8>(place_hash, 16) - 0.5) * side;
    }
    const f64x8 dx = x - ground.view.antenna_x_m;
    const f64x8 dy = height_at(ground.view.grid, x, z) - ground.view.antenna_y_m;
    const f64x8 dz = z - ground.view.antenna_z_m;
    const f64x8 range = sqrt(dx * dx + dy * dy + dz * dz);

    if (owned) {
      const u64x8 bin = lane_by_lane<std::uint64_t, kLanes>([&](int lane) __attribute__((always_inline)) {
        return k + lane < block.n ? block.at[k + lane] : 0;
      });
      kind |= owner_offset(ground.owners, dx, dz, range, to_doubles(bin >> 3),
                           gather(block.edges->sin, bin & 7), gather(block.edges->cos, bin & 7))
                  .code();
    }
    const u64x8 hash = mix_words(place_hash ^ kind);
    const f64x8 own_turns = turns_of_hash(hash);
    const f64x8 round_trips = 2.0 * range / ground.wavelength_m;
    const SinCosOf<f64x8> at = sincos_turns(own_turns - (round_trips - floor(round_trips)));
    const f64x8 modulus = sqrt(-log_of_positive(uniform_of_hash(hash)));
    const f64x8 amplitude = sqrt(load(block.power_w + k));
    store(block.re + k, amplitude * (modulus * at.cos));
    store(block.im + k, amplitude * (modulus * at.sin));
  }
}

}  // namespace obliq::OBLIQ_ISA
