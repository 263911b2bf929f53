#pragma once
// The functions that arithmetic is written in once, for one double and for eight that go through the same
// operations side by side: a template over Real uses these, `?:` and plain operators. One double is there
// always; eight are there in the files that are compiled once for each instruction set, as OBLIQ_ISA
// (server/radar/CMakeLists.txt). GCC and clang turn one operation on eight into one, two or four
// instructions. Every operation is a plain IEEE one, lane by lane, so that the bits are the same whatever the
// set.
//
// f64x8 is one type in all the files for all the sets. So whatever takes it is always inlined or has its
// set's namespace: the linker keeps one copy of other functions, and it must not be the one for the widest
// set.
#include <cstddef>
#include <cstdint>
#if defined(OBLIQ_ISA) && defined(__SSE2__)
#include <immintrin.h>
#endif

#define OBLIQ_INLINE [[gnu::always_inline]] inline

namespace obliq {

/// What comparing two Reals gives: bool, or mask8.
template <typename Real>
using Mask = decltype(Real{} < Real{});

template <typename Real>
OBLIQ_INLINE Real broadcast(double value) {
  return Real{} + value;
}
template <typename Real>
OBLIQ_INLINE Real select(decltype(Real{} < Real{}) where, Real yes, Real no) {
  return where ? yes : no;
}
template <typename Real>
OBLIQ_INLINE Real min(Real a, Real b) {  // std::min, to the bit
  return b < a ? b : a;
}
template <typename Real>
OBLIQ_INLINE Real max(Real a, Real b) {  // std::max
  return a < b ? b : a;
}
template <typename Real>
OBLIQ_INLINE Real clamp(Real x, Real low, Real high) {  // std::clamp
  return select(x < low, low, select(high < x, high, x));
}
/// Nearest integer for |x| < 2^51 (ties to even): adding 1.5 x 2^52 leaves no bits behind the point.
template <typename Real>
OBLIQ_INLINE Real nearest_integer(Real x) {
  constexpr double kShift = 6755399441055744.0;
  return (x + kShift) - kShift;
}

// One double.

OBLIQ_INLINE bool any(bool where) { return where; }
OBLIQ_INLINE bool inverse(bool where) { return !where; }
OBLIQ_INLINE double sqrt(double x) { return __builtin_sqrt(x); }
/// The greatest whole number that is not above x.
OBLIQ_INLINE double floor(double x) { return __builtin_floor(x); }
OBLIQ_INLINE std::uint64_t as_bits(double x) { return __builtin_bit_cast(std::uint64_t, x); }
OBLIQ_INLINE double as_doubles(std::uint64_t bits) { return __builtin_bit_cast(double, bits); }
/// Whole numbers from 0 to 2^52.
OBLIQ_INLINE double to_doubles(std::uint64_t whole) { return static_cast<double>(whole); }

/// Whole numbers of either sign, |x| < 2^51, in two's complement.
OBLIQ_INLINE std::uint64_t to_i64(double whole) {
  return static_cast<std::uint64_t>(static_cast<std::int64_t>(whole));
}

#if defined(OBLIQ_ISA)

// Eight doubles.

constexpr int kLanes = 8;
using f64x8 = double __attribute__((vector_size(64)));
using u64x8 = std::uint64_t __attribute__((vector_size(64)));
using mask8 = std::int64_t __attribute__((vector_size(64)));  ///< all bits of a lane set, or none
using i32x8 = std::int32_t __attribute__((vector_size(32)));
using u32x8 = std::uint32_t __attribute__((vector_size(32)));

OBLIQ_INLINE f64x8 broadcast(double value) { return f64x8{} + value; }

OBLIQ_INLINE f64x8 load(const double* from) {
  f64x8 lanes;
  __builtin_memcpy(&lanes, from, sizeof lanes);
  return lanes;
}
OBLIQ_INLINE f64x8 load(const std::int32_t* from) {
  i32x8 narrow;
  __builtin_memcpy(&narrow, from, sizeof narrow);
  return __builtin_convertvector(narrow, f64x8);
}
OBLIQ_INLINE u64x8 load_u64(const std::uint8_t* from) {
  std::uint8_t narrow __attribute__((vector_size(8)));
  __builtin_memcpy(&narrow, from, sizeof narrow);
  return __builtin_convertvector(narrow, u64x8);
}
OBLIQ_INLINE u64x8 load_u64(const std::uint64_t* from) {
  u64x8 lanes;
  __builtin_memcpy(&lanes, from, sizeof lanes);
  return lanes;
}
OBLIQ_INLINE void store(double* to, f64x8 lanes) { __builtin_memcpy(to, &lanes, sizeof lanes); }
OBLIQ_INLINE void store(std::uint64_t* to, u64x8 lanes) { __builtin_memcpy(to, &lanes, sizeof lanes); }
/// Whole numbers that fit.
OBLIQ_INLINE void store_u32(std::uint32_t* to, u64x8 lanes) {
  const u32x8 narrow = __builtin_convertvector(lanes, u32x8);
  __builtin_memcpy(to, &narrow, sizeof narrow);
}
OBLIQ_INLINE void store_i32(std::int32_t* to, f64x8 lanes) {
  const i32x8 narrow = __builtin_convertvector(lanes, i32x8);
  __builtin_memcpy(to, &narrow, sizeof narrow);
}

OBLIQ_INLINE u64x8 as_bits(f64x8 lanes) { return __builtin_bit_cast(u64x8, lanes); }
OBLIQ_INLINE f64x8 as_doubles(u64x8 bits) { return __builtin_bit_cast(f64x8, bits); }
OBLIQ_INLINE mask8 inverse(mask8 where) { return ~where; }

/// 1 in the lanes of `where`, 0 elsewhere.
OBLIQ_INLINE u64x8 ones_of(mask8 where) { return __builtin_bit_cast(u64x8, where) & 1; }

/// A bit for each lane, the first lane's the lowest.
OBLIQ_INLINE unsigned movemask(mask8 flags) {
#if defined(__AVX512DQ__)
  return _mm512_movepi64_mask(__builtin_bit_cast(__m512i, flags));
#else
  unsigned mask = 0;
  for (int lane = 0; lane < kLanes; ++lane) mask |= flags[lane] != 0 ? 1u << lane : 0u;
  return mask;
#endif
}
OBLIQ_INLINE mask8 mask_from(unsigned mask) {
  return ((u64x8{} + mask) & u64x8{1, 2, 4, 8, 16, 32, 64, 128}) != 0;
}
OBLIQ_INLINE bool any(mask8 flags) { return movemask(flags) != 0; }

/// The lanes of a mask moved together to the front; what is behind them means nothing.
OBLIQ_INLINE f64x8 compress(unsigned mask, f64x8 x) {
#if defined(__AVX512F__)
  return __builtin_bit_cast(
      f64x8, _mm512_maskz_compress_pd(static_cast<__mmask8>(mask), __builtin_bit_cast(__m512d, x)));
#else
  f64x8 front{};
  int n = 0;
  for (int lane = 0; lane < kLanes; ++lane)
    if ((mask >> lane & 1) != 0) front[n++] = x[lane];
  return front;
#endif
}

OBLIQ_INLINE f64x8 sqrt(f64x8 x) {
#if defined(__AVX512F__)
  return __builtin_bit_cast(f64x8, _mm512_sqrt_pd(__builtin_bit_cast(__m512d, x)));
#else
  f64x8 root{};
  for (int lane = 0; lane < kLanes; ++lane) root[lane] = __builtin_sqrt(x[lane]);
  return root;
#endif
}

/// from[at], at any whole numbers within the array.
OBLIQ_INLINE f64x8 gather(const float* from, u64x8 at) {
#if defined(__AVX512F__)
  return __builtin_bit_cast(
      f64x8, _mm512_cvtps_pd(_mm512_i64gather_ps(__builtin_bit_cast(__m512i, at), from, sizeof(float))));
#else
  f64x8 found{};
  for (int lane = 0; lane < kLanes; ++lane) found[lane] = static_cast<double>(from[at[lane]]);
  return found;
#endif
}
OBLIQ_INLINE f64x8 gather(const double* from, u64x8 at) {
#if defined(__AVX512F__)
  return __builtin_bit_cast(f64x8,
                            _mm512_i64gather_pd(__builtin_bit_cast(__m512i, at), from, sizeof(double)));
#else
  f64x8 found{};
  for (int lane = 0; lane < kLanes; ++lane) found[lane] = from[at[lane]];
  return found;
#endif
}
/// from[at] and from[at + 1].
struct Pairs {
  f64x8 first, second;
};
OBLIQ_INLINE Pairs gather_pairs(const float* from, u64x8 at) {
#if defined(__AVX512F__)
  const __m512i pairs = _mm512_i64gather_epi64(__builtin_bit_cast(__m512i, at), from, sizeof(float));
  const auto doubles = [](__m512i floats) __attribute__((always_inline)) {
    return __builtin_bit_cast(f64x8, _mm512_cvtps_pd(_mm256_castsi256_ps(_mm512_cvtepi64_epi32(floats))));
  };
  return {doubles(pairs), doubles(_mm512_srli_epi64(pairs, 32))};
#else
  Pairs found{};
  for (int lane = 0; lane < kLanes; ++lane) {
    found.first[lane] = static_cast<double>(from[at[lane]]);
    found.second[lane] = static_cast<double>(from[at[lane] + 1]);
  }
  return found;
#endif
}

/// The greatest whole number that is not above x, |x| < 2^51.
OBLIQ_INLINE f64x8 floor(f64x8 x) {
  const f64x8 nearest = nearest_integer(x);
  return select(nearest > x, nearest - 1.0, nearest);
}
/// Whole numbers from 0 to 2^52 as integers, and back.
OBLIQ_INLINE u64x8 to_u64(f64x8 whole) { return as_bits(whole + 0x1p52) & 0x000fffffffffffffull; }
OBLIQ_INLINE f64x8 to_doubles(u64x8 whole) { return as_doubles(whole | 0x4330000000000000ull) - 0x1p52; }

/// Whole numbers of either sign as 64-bit integers, |x| < 2^51.
OBLIQ_INLINE u64x8 to_i64(f64x8 whole) {
  constexpr double kShift = 6755399441055744.0;
  return as_bits(whole + kShift) - __builtin_bit_cast(std::uint64_t, kShift);
}

#endif

}  // namespace obliq
