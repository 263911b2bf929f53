#pragma once
#include <cstdint>

#include "server/radar/simd/echoes/scatterer_owner.h"
#include "server/radar/simd/ground/grid_view.h"
#include "server/radar/simd/lanes/kernel.h"

namespace obliq {

/// What the response of ground cells follows from, besides the cells.
struct SpeckleGround {
  GroundView view;
  double wavelength_m;
  std::uint64_t seed;
  OwnerBins owners{};  ///< with a rule, reference points lie anywhere in their cells, else in their middles
};

/// Scatterers as keys (ScattererKey), and what they answer with. The arrays are read and written up to a
/// multiple of 8.
struct SpeckleBlock {
  int n;
  const std::uint64_t* place;
  const std::uint64_t* kind;
  const double* power_w;
  /// sqrt(power) response to six digits, as if all were ground; NaN where a cell's centre has no known
  /// ground.
  double* re;
  double* im;
  /// With an owner rule: range bin x 8 + azimuth bin of the wedge, and the wedge's edges.
  const std::uint32_t* at = nullptr;
  const WedgeEdges* edges = nullptr;
};

/// The same bits whatever the instruction set. False where some are NaN.
OBLIQ_KERNEL(bool, ground_speckle, const SpeckleGround&, const SpeckleBlock&);

}  // namespace obliq
