#pragma once
#include <cstdint>

#include "server/radar/simd/ground/ground_echoes.h"
#include "server/radar/simd/lanes/kernel.h"
#include "server/radar/simd/lanes/lanes.h"

namespace obliq {

/// What makes the sea spiky: a field tau over the world, of mean 1, whose values are Gamma distributed.
/// Normal numbers stand at the nodes of a lattice; between them they are interpolated along both axes, by
/// weights that keep their variance, and mapped to tau by a table.
struct SeaTexture {
  static constexpr int kStepsAUnit = 256;
  static constexpr int kReach = 6;  ///< standard deviations; what is beyond takes the table's end
  static constexpr int kSteps = 2 * kReach * kStepsAUnit;
  float tau[kSteps + 1];  ///< by the normal number, from -kReach on: that of the nearest step
  float nodes_per_m;
  std::uint32_t node_x, node_z;  ///< the antenna's place in the lattice: side and part of it
  float part_x, part_z;
  std::uint32_t seed;
};

/// Pieces of the sea: middles by ground distance from the antenna and the sine and cosine of their world
/// bearing, and lengths along and across that. Read and written up to a multiple of 16.
struct SeaPieces {
  static constexpr int kMost = 1024;
  int n;
  float distance_m[kMost];
  float sine[kMost], cosine[kMost];
  float along_m[kMost], across_m[kMost];
  float tau[kMost];  ///< out: its mean over each piece
};

/// By points less than a side of the lattice apart, or eight each way in larger pieces.
OBLIQ_KERNEL(void, sea_texture, const SeaTexture&, SeaPieces&);

/// Pieces of one plane in one range bin, by the plane's run and the bin.
struct PiecesOfBins {
  float sine[GroundEchoes::kRuns], cosine[GroundEchoes::kRuns];  ///< world bearings
  float first_m;                                                 ///< slant range of the middle of bin 0
  float spacing_m;
  float width_rad;

  /// Of a piece in the middle of a bin, at a ground distance: along.
  template <typename Real>
  OBLIQ_INLINE Real along_m(Real bin, Real distance_m) const {
    return spacing_m * (first_m + bin * spacing_m) / max(distance_m, Real{} + 1.0F);
  }
};

/// Multiplies those echoes whose material has an over_gamma (SeaTable) by the texture's mean over their
/// pieces, as sea_texture has it.
OBLIQ_KERNEL(void, texture_echoes, const SeaTexture&, const PiecesOfBins&, const float* over_gamma,
             GroundEchoes&);

}  // namespace obliq
