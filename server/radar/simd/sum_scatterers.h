#pragma once
#include <cstdint>

#include "server/radar/simd/kernel.h"

namespace obliq {

/// Samples by range bin, and the scatterers that they are added up to.
struct ScattererLists {
  static constexpr int kSpare = 8;              ///< elements that may be read behind the last one
  static constexpr std::uint32_t kLarge = 256;  ///< a bin with more samples is left to others
  const std::uint32_t* end;                     ///< of each bin among the samples
  const std::uint64_t* place;
  const std::uint64_t* kind;
  const double* power_w;
  std::uint32_t* bin;  ///< from here on of the scatterers
  std::uint64_t* sum_place;
  std::uint64_t* sum_kind;
  double* sum_power_w;
  std::uint32_t n;  ///< of them
};

/// Adds up bins from `first` on; returns the first that is not done, a large one or n_bins.
OBLIQ_KERNEL(std::uint32_t, sum_scatterers, ScattererLists&, std::uint32_t first, std::uint32_t n_bins);

}  // namespace obliq
