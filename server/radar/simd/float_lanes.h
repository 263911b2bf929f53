#pragma once
// Sixteen floats that go through the same operations side by side: lanes.h for what needs seven digits. All
// is inlined, every operation is a plain IEEE one, and sums have one order, so that the bits are the same
// whatever the instruction set.
#include "server/radar/simd/lanes.h"

namespace obliq {

#if defined(OBLIQ_ISA)

constexpr int kFloatLanes = 16;
using f32x16 = float __attribute__((vector_size(64)));
using i32x16 = std::int32_t __attribute__((vector_size(64)));
using mask16 = std::int32_t __attribute__((vector_size(64)));  ///< all bits of a lane set, or none

OBLIQ_INLINE f32x16 all_lanes(float value) { return f32x16{} + value; }
OBLIQ_INLINE i32x16 all_lanes(std::int32_t value) { return i32x16{} + value; }

OBLIQ_INLINE f32x16 load_floats(const float* from) {
  f32x16 lanes;
  __builtin_memcpy(&lanes, from, sizeof lanes);
  return lanes;
}
OBLIQ_INLINE void store(float* to, f32x16 lanes) { __builtin_memcpy(to, &lanes, sizeof lanes); }

/// A bit for each lane, the first lane's the lowest.
OBLIQ_INLINE unsigned movemask16(mask16 flags) {
#if defined(__AVX512DQ__)
  return _mm512_movepi32_mask(__builtin_bit_cast(__m512i, flags));
#else
  unsigned mask = 0;
  for (int lane = 0; lane < kFloatLanes; ++lane) mask |= flags[lane] != 0 ? 1u << lane : 0u;
  return mask;
#endif
}
OBLIQ_INLINE bool any16(mask16 flags) { return movemask16(flags) != 0; }

OBLIQ_INLINE f32x16 sqrt(f32x16 x) {
#if defined(__AVX512F__)
  return __builtin_bit_cast(f32x16, _mm512_sqrt_ps(__builtin_bit_cast(__m512, x)));
#else
  f32x16 root{};
  for (int lane = 0; lane < kFloatLanes; ++lane) root[lane] = __builtin_sqrtf(x[lane]);
  return root;
#endif
}

/// from[at], at any whole numbers within the array.
OBLIQ_INLINE f32x16 gather(const float* from, i32x16 at) {
#if defined(__AVX512F__)
  return __builtin_bit_cast(f32x16,
                            _mm512_i32gather_ps(__builtin_bit_cast(__m512i, at), from, sizeof(float)));
#else
  f32x16 found{};
  for (int lane = 0; lane < kFloatLanes; ++lane) found[lane] = from[at[lane]];
  return found;
#endif
}

/// Towards zero; numbers that fit.
OBLIQ_INLINE i32x16 truncated(f32x16 x) { return __builtin_convertvector(x, i32x16); }
OBLIQ_INLINE f32x16 floats_of(i32x16 x) { return __builtin_convertvector(x, f32x16); }

namespace halves {
using f32x8 = float __attribute__((vector_size(32)));
using f32x4 = float __attribute__((vector_size(16)));

/// Joins the lanes of the upper half with those of the lower, and so on down to one.
template <typename Join>
OBLIQ_INLINE float joined(f32x16 x, const Join& join) {
  f32x8 low, high;
  __builtin_memcpy(&low, &x, sizeof low);
  __builtin_memcpy(&high, reinterpret_cast<const char*>(&x) + sizeof low, sizeof high);
  low = join(low, high);
  f32x4 a, b;
  __builtin_memcpy(&a, &low, sizeof a);
  __builtin_memcpy(&b, reinterpret_cast<const char*>(&low) + sizeof a, sizeof b);
  a = join(a, b);
  const f32x4 ends{join(f32x4{a[0]}, f32x4{a[2]})[0], join(f32x4{a[1]}, f32x4{a[3]})[0]};
  return join(f32x4{ends[0]}, f32x4{ends[1]})[0];
}
}  // namespace halves

OBLIQ_INLINE float sum_of(f32x16 x) {
  return halves::joined(
      x, [](auto a, auto b) __attribute__((always_inline)) { return a + b; });
}
OBLIQ_INLINE float least_of(f32x16 x) {
  return halves::joined(
      x, [](auto a, auto b) __attribute__((always_inline)) { return b < a ? b : a; });
}
OBLIQ_INLINE float greatest_of(f32x16 x) {
  return halves::joined(
      x, [](auto a, auto b) __attribute__((always_inline)) { return a < b ? b : a; });
}

#endif

}  // namespace obliq
