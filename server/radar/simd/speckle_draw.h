#pragma once
#include <cstdint>

#include "server/radar/simd/kernel.h"

namespace obliq {

/// sqrt(power) times a circular complex Gaussian number of mean square 1, which follows from the key and
/// cell + k alone: |u|^2 = -ln(uniform) (Box and Muller 1958).
struct SpeckleDraw {
  std::uint64_t key;
  std::uint64_t cell;
  int n;
  const float* power;  ///< read up to a multiple of 8
  float* iq;           ///< [n][2]; written up to a multiple of 8
};
OBLIQ_KERNEL(void, draw_speckle, const SpeckleDraw&);

}  // namespace obliq
