#pragma once
// Sixteen floats that go through the same operations side by side: lanes.h for what needs seven digits. All
// is inlined, every operation is a plain IEEE one, and sums have one order, so that the bits are the same
// whatever the instruction set.
#include "server/radar/simd/lanes/lanes.h"

namespace obliq {

#if defined(OBLIQ_ISA)

constexpr int kFloatLanes = 16;
using f32x16 = Lanes<float, kFloatLanes>;
using i32x16 = Lanes<std::int32_t, kFloatLanes>;
using mask16 = Lanes<MaskOf<float>, kFloatLanes>;

OBLIQ_INLINE f32x16 all_lanes(float value) { return every(static_cast<const f32x16*>(nullptr), value); }
OBLIQ_INLINE i32x16 all_lanes(std::int32_t value) {
  return every(static_cast<const i32x16*>(nullptr), value);
}

OBLIQ_INLINE f32x16 load_floats(const float* from) { return load_as<f32x16>(from); }
OBLIQ_INLINE void store(float* to, f32x16 lanes) { to_memory(to, lanes); }

OBLIQ_INLINE mask16 mask16_from(unsigned mask) { return flags_of(static_cast<const mask16*>(nullptr), mask); }

/// from[at], at any whole numbers within the array.
OBLIQ_LANES Lanes<float, n> gather(const float* from, Lanes<T, n> at) {
  static_assert(std::is_same_v<T, std::int32_t>);
  if constexpr (!OBLIQ_ISA::is_one<T, n>(nullptr)) {
    return {gather(from, at.low), gather(from, at.high)};
  } else {
#if defined(__AVX512F__)
    if constexpr (n == 16)
      return {_mm512_i32gather_ps(__builtin_bit_cast(__m512i, at.v), from, sizeof(float))};
#endif
#if defined(__AVX2__)
    if constexpr (n == 8)
      return {_mm256_i32gather_ps(from, __builtin_bit_cast(__m256i, at.v), sizeof(float))};
#else
    return {typename Lanes<float, n>::Register{from[at[0]], from[at[1]], from[at[2]], from[at[3]]}};
#endif
  }
}

/// Any number of floats, of whole numbers that go with them, and where something holds of them.
template <int n>
using Floats = Lanes<float, n>;
template <int n>
using Numbers = Lanes<std::int32_t, n>;
template <int n>
using Where = Lanes<MaskOf<float>, n>;

template <int n>
OBLIQ_INLINE Floats<n> in_all(float value) {
  return every(static_cast<const Floats<n>*>(nullptr), value);
}

/// Towards zero; numbers that fit.
template <int n>
OBLIQ_INLINE Numbers<n> truncated(Floats<n> x) {
  return converted<std::int32_t>(x);
}
template <int n>
OBLIQ_INLINE Floats<n> floats_of(Numbers<n> x) {
  return converted<float>(x);
}

/// Joins the lanes of the upper half with those of the lower, and so on down to one.
template <int n, typename Join>
OBLIQ_INLINE float folded(Lanes<float, n> x, const Join& join) {
  if constexpr (n > 4) {
    return folded(join(low_half(x), high_half(x)), join);
  } else {
    const Lanes<float, 4> two = join(x, {__builtin_shufflevector(x.v, x.v, 2, 3, 2, 3)});
    return join(two, {__builtin_shufflevector(two.v, two.v, 1, 1, 1, 1)})[0];
  }
}

/// Both at a time, each as folded() does.
template <int n, typename Join>
OBLIQ_INLINE Pairs<float> folded(Lanes<float, n> a, Lanes<float, n> b, const Join& join) {
  if constexpr (!OBLIQ_ISA::is_one<float, n>(nullptr)) {
    return folded(join(a.low, a.high), join(b.low, b.high), join);
  } else {
    // Side by side in the halves of a register.
    auto both = join(joined(low_half(a), low_half(b)), joined(high_half(a), high_half(b)));
    if constexpr (n > 8) both = join(both, OBLIQ_ISA::from_within<4, n / 2>(both));
    if constexpr (n > 4) both = join(both, OBLIQ_ISA::from_within<2, n / 2>(both));
    both = join(both, OBLIQ_ISA::from_within<1, n / 2>(both));
    return {both[0], both[n / 2]};
  }
}

template <int n>
OBLIQ_INLINE Pairs<float> sums_of(Lanes<float, n> a, Lanes<float, n> b) {
  return folded(
      a, b, [](auto p, decltype(p) q) __attribute__((always_inline)) { return p + q; });
}
template <int n>
OBLIQ_INLINE Pairs<float> greatest_of(Lanes<float, n> a, Lanes<float, n> b) {
  return folded(
      a, b, [](auto p, decltype(p) q) __attribute__((always_inline)) { return max(p, q); });
}
template <int n>
OBLIQ_INLINE float sum_of(Lanes<float, n> x) {
  return folded(
      x, [](auto a, decltype(a) b) __attribute__((always_inline)) { return a + b; });
}
template <int n>
OBLIQ_INLINE float least_of(Lanes<float, n> x) {
  return folded(
      x, [](auto a, decltype(a) b) __attribute__((always_inline)) { return min(a, b); });
}
template <int n>
OBLIQ_INLINE float greatest_of(Lanes<float, n> x) {
  return folded(
      x, [](auto a, decltype(a) b) __attribute__((always_inline)) { return max(a, b); });
}

#endif

}  // namespace obliq
