#pragma once
#include <cstdint>

#include "server/radar/simd/lanes/kernel.h"

namespace obliq {

/// What makes the sea spiky: a field tau over the world, of mean 1, whose values are Gamma distributed.
/// Normal numbers stand at the nodes of a lattice; between them they are interpolated (bilinear), divided by
/// their standard deviation there, and mapped to tau by a table.
struct SeaTexture {
  static constexpr int kStepsAUnit = 32;
  static constexpr int kReach = 6;  ///< standard deviations; what is beyond takes the table's end
  static constexpr int kSteps = 2 * kReach * kStepsAUnit;
  float tau[kSteps + 2];  ///< by the normal number, from -kReach on
  float nodes_per_m;
  std::int32_t node_x, node_z;  ///< the antenna's place in the lattice: node and part
  float part_x, part_z;
  std::uint32_t seed;
};

/// Pieces of the sea: middles from the antenna along world axes, and lengths along and across the line of
/// sight, in metres. Read and written up to a multiple of 16.
struct SeaPieces {
  static constexpr int kMost = 1024;
  int n;
  float x_m[kMost], z_m[kMost];
  float along_m[kMost], across_m[kMost];
  float tau[kMost];  ///< out: its mean over each piece
};

/// By points less than a side of the lattice apart, or eight each way in larger pieces.
OBLIQ_KERNEL(void, sea_texture, const SeaTexture&, SeaPieces&);

}  // namespace obliq
