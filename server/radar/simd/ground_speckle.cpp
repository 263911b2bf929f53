// SpeckleField::response for eight ground cells at a time, to the bit.
#include "server/radar/simd/ground_speckle.h"

#include "server/radar/simd/cell_prefetch.h"
#include "server/radar/simd/grid_walk.h"

namespace obliq::OBLIQ_ISA {
namespace {

/// HeightGrid::height_at_m; NaN off the grid or over unknown ground.
OBLIQ_LANES Lanes height_at(const LaneGrid& grid, Lanes x, Lanes z) {
  const Lanes u = (x - grid.x0_m) / grid.cell_m;
  const Lanes v = (z - grid.z0_m) / grid.cell_m;
  const double last_u = grid.nx - 1;
  const double last_v = grid.nz - 1;
  const LaneFlags on_grid = (u >= 0.0) & (v >= 0.0) & (u <= last_u) & (v <= last_v);
  const Lanes low_u = floor_of(select(on_grid, u, Lanes{}));
  const Lanes low_v = floor_of(select(on_grid, v, Lanes{}));
  const Lanes i = select(low_u > last_u - 1, all_lanes(last_u - 1), low_u);
  const Lanes j = select(low_v > last_v - 1, all_lanes(last_v - 1), low_v);
  const auto [y00, y10, y01, y11, known] = corners(grid, integers_of(j * static_cast<double>(grid.nx) + i));
  const Lanes s = u - i;
  const Lanes t = v - j;
  const Lanes lower = y00 + s * (y10 - y00) + t * (y01 - y00);
  const Lanes upper = y11 + (1.0 - s) * (y01 - y11) + (1.0 - t) * (y10 - y11);
  return select(on_grid & known, select(s + t <= 1.0, lower, upper), all_lanes(__builtin_nan("")));
}

/// The middle of a ground cell.
struct Centre {
  Lanes x, z;
};

OBLIQ_LANES Centre centre_of(LaneBits place, LaneBits kind) {
  // Cell numbers are 32-bit integers of either sign: counted from the least one they are whole numbers.
  const Lanes x_cell = doubles_of((place >> 32) ^ 0x80000000ull) - 0x1p31;
  const Lanes z_cell = doubles_of((place & 0xffffffffull) ^ 0x80000000ull) - 0x1p31;
  const LaneBits level = ((kind >> 8) & 0xffff) ^ 0x8000;
  const Lanes side = lanes_of((level - std::uint64_t{0x8000 - 1023}) << 52);
  return {(x_cell + 0.5) * side, (z_cell + 0.5) * side};
}

/// Asks for the heights under the cells of scatterers [k, k + 8), roughly.
OBLIQ_LANES void ask_for_heights(const LaneGrid& grid, const SpeckleBlock& block, int k, double per_cell) {
  const auto [x, z] = centre_of(load_bits(block.place + k), load_bits(block.kind + k));
  prefetch_cells(grid, (x - grid.x0_m) * per_cell, (z - grid.z0_m) * per_cell);
}

}  // namespace

void speckle_lanes(const SpeckleGround& ground, const SpeckleBlock& block) {
  constexpr int kAhead = 4 * kLanes;
  const double per_cell = 1 / ground.grid.cell_m;
  for (int k = 0; k < kAhead && k < block.n; k += kLanes) ask_for_heights(ground.grid, block, k, per_cell);
  for (int k = 0; k < block.n; k += kLanes) {
    if (k + kAhead < block.n) ask_for_heights(ground.grid, block, k + kAhead, per_cell);
    const LaneBits place = load_bits(block.place + k);
    const LaneBits kind = load_bits(block.kind + k) & 0xffffffffull;
    const auto [x, z] = centre_of(place, kind);
    const Lanes dx = x - ground.antenna_x_m;
    const Lanes dy = height_at(ground.grid, x, z) - ground.antenna_y_m;
    const Lanes dz = z - ground.antenna_z_m;
    const Lanes range = sqrt_of(dx * dx + dy * dy + dz * dz);

    const LaneBits hash = mix64(mix64(place ^ ground.seed) ^ kind);
    const Lanes own_turns = doubles_of(hash >> 32) * 0x1p-32;
    const Lanes round_trips = 2.0 * range / ground.wavelength_m;
    const SinCosLanes at = sincos_turns(own_turns - (round_trips - floor_of(round_trips)));
    const Lanes modulus = sqrt_of(-log_of_positive((doubles_of(hash & 0xffffffffull) + 0.5) * 0x1p-32));
    const Lanes amplitude = sqrt_of(load_lanes(block.power_w + k));
    store_lanes(block.re + k, amplitude * (modulus * at.cos));
    store_lanes(block.im + k, amplitude * (modulus * at.sin));
  }
}

}  // namespace obliq::OBLIQ_ISA
