// SpeckleField::response for eight ground cells at a time. Distances are doubles, and modulo one turn at
// once; what is left needs the seven digits of I&Q.
#include "server/radar/simd/ground/ground_speckle.h"

#include "server/radar/simd/echoes/cell_key.h"
#include "server/radar/simd/ground/grid_walk.h"
#include "server/radar/simd/lanes/float_math.h"
#include "terrain/base/hash.h"

namespace obliq::OBLIQ_ISA {
namespace {

/// HeightGrid::height_at_m; NaN off the grid or over unknown ground.
OBLIQ_INLINE f64x8 height_at(const GridView& grid, f64x8 x, f64x8 z, double per_cell) {
  const f64x8 u = (x - grid.x0_m) * per_cell;
  const f64x8 v = (z - grid.z0_m) * per_cell;
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
  const f64x8 side = side_of_cell(kind);
  return {(x_cell + 0.5) * side, (z_cell + 0.5) * side};
}

}  // namespace

bool ground_speckle(const SpeckleGround& ground, const SpeckleBlock& block) {
  mask8 unknown{};
  const bool owned = ground.owners.ground;
  const double per_cell = 1 / ground.view.grid.cell_m;
  const double round_trips_a_m = 2 / ground.wavelength_m;
  for (int k = 0; k < block.n; k += kLanes) {
    const u64x8 place = load_u64(block.place + k);
    u64x8 kind = load_u64(block.kind + k) & 0xffffffffull;
    const u64x8 place_hash = mix_words(place ^ ground.seed);
    auto [x, z] = centre_of(place, kind);
    if (owned) {
      const f64x8 side = side_of_cell(kind);
      x += (jitter<f64x8>(place_hash, 0) - 0.5) * side;
      z += (jitter<f64x8>(place_hash, 16) - 0.5) * side;
    }
    const f64x8 dx = x - ground.view.antenna_x_m;
    const f64x8 dy = height_at(ground.view.grid, x, z, per_cell) - ground.view.antenna_y_m;
    const f64x8 dz = z - ground.view.antenna_z_m;
    const f64x8 range = sqrt(dx * dx + dy * dy + dz * dz);
    unknown |= range != range;

    if (owned) {
      const u64x8 bin = load_u64(block.at + k);
      kind |= owner_offset(ground.owners, dx, dz, range, to_doubles(bin >> 3),
                           of_eight(block.edges->sin, bin & 7), of_eight(block.edges->cos, bin & 7))
                  .code();
    }
    const u64x8 hash = mix_words(place_hash ^ kind);
    const f64x8 turns = turns_of_hash(hash) - range * round_trips_a_m;
    store_voltage(load(block.power_w + k) * modulus2_of_hash(hash), turns, block.re + k, block.im + k);
  }
  return !any(unknown);
}

}  // namespace obliq::OBLIQ_ISA
