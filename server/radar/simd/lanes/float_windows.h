#pragma once
// Lanes that lie near each other take their numbers from a register that has all of them: a load and a
// permutation for a gather of forty operations. The portable set has no such permutation.
#include "server/radar/simd/lanes/float_lanes.h"

#if defined(__AVX2__)
namespace obliq::OBLIQ_ISA {

constexpr int kWindow = kRegisterBytes / static_cast<int>(sizeof(float));
using Window = Lanes<float, kWindow>;

template <int n>
OBLIQ_INLINE Lanes<float, n> taken(Window window, Lanes<std::int32_t, n> at) {
  if constexpr (n > kWindow) {
    return {taken(window, at.low), taken(window, at.high)};
  } else {
#if defined(__AVX512F__)
    if constexpr (n < kWindow)
      return low_half(taken(window, joined(at, at)));
    else
      return {
          __builtin_bit_cast(typename Lanes<float, n>::Register,
                             _mm512_permutexvar_ps(__builtin_bit_cast(__m512i, at.v), intrinsic(window)))};
#else
    return {
        __builtin_bit_cast(typename Lanes<float, n>::Register,
                           _mm256_permutevar8x32_ps(intrinsic(window), __builtin_bit_cast(__m256i, at.v)))};
#endif
  }
}

/// Where a window of `size` begins that has `at` in its middle, within 0 to `end`.
OBLIQ_INLINE int window_around(int at, int size, int end) {
  const int first = at - size / 2 + 1;
  return max(0, min(first, end - size));
}

/// Are all from 0 to `most`?
template <int n>
OBLIQ_INLINE bool all_up_to(Lanes<std::int32_t, n> x, int most) {
  return !any((x < 0) | (x > most));
}

}  // namespace obliq::OBLIQ_ISA
#endif
