#pragma once
// The functions that arithmetic is written in once, for one double and for eight that go through the same
// operations side by side: a template over Real uses these and plain operators. One double is there always;
// eight are there in the files that are compiled once for each instruction set, as OBLIQ_ISA
// (server/radar/CMakeLists.txt): registers.h.
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "terrain/base/select.h"
#if defined(OBLIQ_ISA)
#include "server/radar/simd/lanes/masks.h"
#endif

#define OBLIQ_INLINE [[gnu::always_inline]] inline

namespace obliq {

/// What comparing two Reals gives: bool, or mask8.
template <typename Real>
using Mask = decltype(Real{} < Real{});

#if defined(OBLIQ_ISA)

using OBLIQ_ISA::converted;
using OBLIQ_ISA::high_half;
using OBLIQ_ISA::joined;
using OBLIQ_ISA::lane_by_lane;
using OBLIQ_ISA::lane_numbers;
using OBLIQ_ISA::Lanes;
using OBLIQ_ISA::low_half;
using OBLIQ_ISA::MaskOf;
using OBLIQ_ISA::select;

OBLIQ_LANES Lanes<T, n> min(Lanes<T, n> a, Lanes<T, n> b) {  // as std::min
  if constexpr (!OBLIQ_ISA::is_one<T, n>(nullptr))
    return {min(a.low, b.low), min(a.high, b.high)};
  else
    return OBLIQ_ISA::lanes_from<Lanes<T, n>>(OBLIQ_ISA::least(intrinsic(a), intrinsic(b)));
}
OBLIQ_LANES Lanes<T, n> max(Lanes<T, n> a, Lanes<T, n> b) {
  if constexpr (!OBLIQ_ISA::is_one<T, n>(nullptr))
    return {max(a.low, b.low), max(a.high, b.high)};
  else
    return OBLIQ_ISA::lanes_from<Lanes<T, n>>(OBLIQ_ISA::greatest(intrinsic(a), intrinsic(b)));
}
OBLIQ_LANES Lanes<T, n> sqrt(Lanes<T, n> x) {
  if constexpr (!OBLIQ_ISA::is_one<T, n>(nullptr))
    return {sqrt(x.low), sqrt(x.high)};
  else
    return OBLIQ_ISA::lanes_from<Lanes<T, n>>(OBLIQ_ISA::root(intrinsic(x)));
}
/// A bit for each lane, the first lane's the lowest.
OBLIQ_LANES unsigned movemask(Lanes<T, n> flags) { return bits_of(flags); }
OBLIQ_LANES bool any(Lanes<T, n> flags) { return any_of(flags); }
OBLIQ_LANES Lanes<T, n> inverse(Lanes<T, n> where) { return ~where; }

#endif

template <typename Real>
OBLIQ_INLINE Real broadcast(double value) {
  return Real{} + value;
}
template <typename Real>
requires std::is_arithmetic_v<Real> OBLIQ_INLINE Real min(Real a, Real b) {  // std::min, to the bit
  return b < a ? b : a;
}
template <typename Real>
requires std::is_arithmetic_v<Real> OBLIQ_INLINE Real max(Real a, Real b) {  // std::max
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

/// Added to a float, |x| < 2^22, it leaves no bits behind the point: the nearest integer stands in the last
/// ones.
constexpr float kNoFraction = 0x1.8p23F;

/// Two neighbours in an array.
template <typename Real>
struct Pairs {
  Real first, second;
};

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
OBLIQ_INLINE std::uint64_t to_u64(double whole) { return static_cast<std::uint64_t>(whole); }
/// from[at] and from[at + 1].
OBLIQ_INLINE Pairs<double> gather_pairs(const float* from, std::uint64_t at) {
  return {static_cast<double>(from[at]), static_cast<double>(from[at + 1])};
}

/// Whole numbers of either sign, |x| < 2^51, in two's complement.
OBLIQ_INLINE std::uint64_t to_i64(double whole) {
  return static_cast<std::uint64_t>(static_cast<std::int64_t>(whole));
}

#if defined(OBLIQ_ISA)

// Eight doubles.

constexpr int kLanes = 8;
using f64x8 = Lanes<double, kLanes>;
using u64x8 = Lanes<std::uint64_t, kLanes>;
using mask8 = Lanes<MaskOf<double>, kLanes>;
using f32x8 = Lanes<float, kLanes>;

OBLIQ_INLINE f64x8 broadcast(double value) { return every(static_cast<const f64x8*>(nullptr), value); }

/// As many as the type has.
template <typename Type, typename T>
OBLIQ_INLINE Type load_as(const T* from) {
  return from_memory(static_cast<const Type*>(nullptr), from);
}
OBLIQ_INLINE f64x8 load(const double* from) { return load_as<f64x8>(from); }
OBLIQ_INLINE f64x8 load(const std::int32_t* from) {
  return converted<double>(load_as<Lanes<std::int32_t, kLanes>>(from));
}
OBLIQ_INLINE u64x8 load_u64(const std::uint8_t* from) {
  return lane_by_lane<std::uint64_t, kLanes>([&](int lane)
                                                 __attribute__((always_inline)) { return from[lane]; });
}
OBLIQ_INLINE u64x8 load_u64(const std::uint32_t* from) {
  return converted<std::uint64_t>(load_as<Lanes<std::uint32_t, kLanes>>(from));
}
OBLIQ_INLINE u64x8 load_u64(const std::uint64_t* from) { return load_as<u64x8>(from); }
OBLIQ_INLINE void store(double* to, f64x8 lanes) { to_memory(to, lanes); }
OBLIQ_INLINE void store(std::uint64_t* to, u64x8 lanes) { to_memory(to, lanes); }
/// Whole numbers that fit.
OBLIQ_INLINE void store_i32(std::int32_t* to, f64x8 lanes) { to_memory(to, converted<std::int32_t>(lanes)); }

OBLIQ_INLINE u64x8 as_bits(f64x8 lanes) { return OBLIQ_ISA::bits_as<std::uint64_t>(lanes); }
OBLIQ_INLINE f64x8 as_doubles(u64x8 bits) { return OBLIQ_ISA::bits_as<double>(bits); }

OBLIQ_INLINE mask8 mask_from(unsigned mask) { return flags_of(static_cast<const mask8*>(nullptr), mask); }

/// The lanes of a mask moved together to the front; what is behind them means nothing.
OBLIQ_INLINE f64x8 compress(unsigned mask, f64x8 x) {
#if defined(__AVX512F__)
  return OBLIQ_ISA::lanes_from<f64x8>(_mm512_maskz_compress_pd(static_cast<__mmask8>(mask), intrinsic(x)));
#else
  double all[kLanes];
  double front[2 * kLanes];
  store(all, x);
  int n = 0;
  for (int lane = 0; lane < kLanes; ++lane) {
    front[n] = all[lane];
    n += static_cast<int>(mask >> lane & 1);
  }
  return load(front);
#endif
}

/// from[at], at any whole numbers within the array.
template <typename From>
OBLIQ_INLINE f64x8 gather(const From* from, u64x8 at) {
#if defined(__AVX512F__)
  if constexpr (std::is_same_v<From, float>)
    return OBLIQ_ISA::lanes_from<f64x8>(
        _mm512_cvtps_pd(_mm512_i64gather_ps(__builtin_bit_cast(__m512i, at.v), from, sizeof(float))));
  else
    return OBLIQ_ISA::lanes_from<f64x8>(
        _mm512_i64gather_pd(__builtin_bit_cast(__m512i, at.v), from, sizeof(double)));
#else
  std::uint64_t places[kLanes];
  store(places, at);
  return lane_by_lane<double, kLanes>([&](int lane) __attribute__((always_inline)) {
    return static_cast<double>(from[places[lane]]);
  });
#endif
}
/// from[at] of eight, and of sixteen doubles.
OBLIQ_INLINE f64x8 of_eight(const double* from, u64x8 at) {
#if defined(__AVX512F__)
  return OBLIQ_ISA::lanes_from<f64x8>(
      _mm512_permutexvar_pd(__builtin_bit_cast(__m512i, at.v), _mm512_loadu_pd(from)));
#else
  return gather(from, at);
#endif
}
OBLIQ_INLINE f64x8 of_sixteen(const double* from, u64x8 at) {
#if defined(__AVX512F__)
  return OBLIQ_ISA::lanes_from<f64x8>(_mm512_permutex2var_pd(
      _mm512_loadu_pd(from), __builtin_bit_cast(__m512i, at.v), _mm512_loadu_pd(from + kLanes)));
#else
  return gather(from, at);
#endif
}
OBLIQ_INLINE Pairs<f64x8> gather_pairs(const float* from, u64x8 at) {
#if defined(__AVX512F__)
  const __m512i pairs = _mm512_i64gather_epi64(__builtin_bit_cast(__m512i, at.v), from, sizeof(float));
  const auto doubles = [](__m512i floats) __attribute__((always_inline)) {
    return OBLIQ_ISA::lanes_from<f64x8>(_mm512_cvtps_pd(_mm256_castsi256_ps(_mm512_cvtepi64_epi32(floats))));
  };
  return {doubles(pairs), doubles(_mm512_srli_epi64(pairs, 32))};
#else
  std::uint64_t places[kLanes];
  store(places, at);
  // Four pairs in two registers, each pair by one load.
  const auto four = [&](int lane) __attribute__((always_inline)) {
    const auto pair = [&](int k) __attribute__((always_inline)) {
      return reinterpret_cast<const __m64*>(from + places[lane + k]);
    };
    const __m128 a = _mm_loadh_pi(_mm_loadl_pi(_mm_setzero_ps(), pair(0)), pair(1));
    const __m128 b = _mm_loadh_pi(_mm_loadl_pi(_mm_setzero_ps(), pair(2)), pair(3));
    const auto doubles = [](__m128 floats) __attribute__((always_inline)) {
      return converted<double>(OBLIQ_ISA::lanes_from<Lanes<float, 4>>(floats));
    };
    return Pairs<Lanes<double, 4>>{doubles(_mm_shuffle_ps(a, b, 0x88)), doubles(_mm_shuffle_ps(a, b, 0xdd))};
  };
  const auto low = four(0);
  const auto high = four(4);
  return {joined(low.first, high.first), joined(low.second, high.second)};
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
