#pragma once
// Tables of which neighbouring lanes want neighbouring places: a load and a permutation in place of a gather.
#include "server/radar/simd/lanes/float_lanes.h"

namespace obliq {

#if defined(OBLIQ_ISA)

/// Places of two tables from `first` on, as many as a register has lanes.
struct TableWindow {
  std::int32_t first;
};

/// from[first + at] of one register of lanes, at from 0 to below their number; of other lanes anything.
OBLIQ_LANES Lanes<float, n> permuted(const float* from, Lanes<T, n> at) {
#if defined(__AVX512F__)
  if constexpr (n == 16)
    return {_mm512_permutexvar_ps(__builtin_bit_cast(__m512i, at.v), _mm512_loadu_ps(from))};
#endif
#if defined(__AVX2__)
  if constexpr (n == 8)
    return {_mm256_permutevar8x32_ps(_mm256_loadu_ps(from), __builtin_bit_cast(__m256i, at.v))};
#endif
  return gather(from, at);
}

/// What two tables that begin at place `origin` have at places `at`, for the lanes in `wanted`; of other
/// lanes anything. The window, first at `origin`, follows what is wanted.
template <int n>
OBLIQ_INLINE Pairs<Lanes<float, n>> gather_both(const float* one, const float* other, std::int32_t origin,
                                                Lanes<std::int32_t, n> at, Lanes<MaskOf<float>, n> wanted,
                                                TableWindow& window) {
  constexpr int kMost = OBLIQ_ISA::kRegisterBytes / static_cast<int>(sizeof(float));
  constexpr int kWindow = n < kMost ? n : kMost;
  if constexpr (kWindow >= 8) {
    const auto is_beside = [&]() __attribute__((always_inline)) {
      const auto in = OBLIQ_ISA::bits_as<std::uint32_t>(at - window.first);
      return any(wanted & (in >= std::uint32_t{kWindow}));
    };
    bool beside = is_beside();
    if (beside) {
      const Lanes<float, n> places = select(wanted, converted<float>(at), Lanes<float, n>{});
      const auto last = static_cast<std::int32_t>(greatest_of(places));
      window.first = last < origin + kWindow ? origin : last - (kWindow - 1);
      beside = is_beside();
    }
    if (!beside) [[likely]] {
      const auto in = at - window.first;
      const auto of = [&](const float* table) __attribute__((always_inline)) {
        const float* const here = table + (window.first - origin);
        if constexpr (n == kWindow)
          return permuted(here, in);
        else
          return joined(permuted(here, low_half(in)), permuted(here, high_half(in)));
      };
      return {of(one), of(other)};
    }
  }
  return {gather(one, at - origin), gather(other, at - origin)};
}

#endif

}  // namespace obliq
