#pragma once
// Eight doubles that go through the same operations side by side, for the files that are compiled once for
// each instruction set (server/radar/CMakeLists.txt). GCC and clang turn one operation on them into one, two
// or four instructions. Every operation here is a plain IEEE one, lane by lane, so that the bits are the same
// whatever the set. Files that include this call no function from elsewhere but those that are always inlined
// (exact_series.h): the linker keeps one copy of the others, and it must not be the one for the widest set.
#include <cstddef>
#include <cstdint>
#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include "server/radar/simd/exact_series.h"

namespace obliq::OBLIQ_ISA {

constexpr int kLanes = 8;
using Lanes = double __attribute__((vector_size(64)));
using LaneBits = std::uint64_t __attribute__((vector_size(64)));
using LaneFlags = std::int64_t __attribute__((vector_size(64)));  ///< all bits of a lane set, or none
using LaneInts = std::int32_t __attribute__((vector_size(32)));
using LaneWords = std::uint32_t __attribute__((vector_size(32)));

#define OBLIQ_LANES [[gnu::always_inline]] inline

OBLIQ_LANES Lanes all_lanes(double value) { return Lanes{} + value; }

OBLIQ_LANES Lanes load_lanes(const double* from) {
  Lanes lanes;
  __builtin_memcpy(&lanes, from, sizeof lanes);
  return lanes;
}
OBLIQ_LANES Lanes load_lanes(const std::int32_t* from) {
  LaneInts narrow;
  __builtin_memcpy(&narrow, from, sizeof narrow);
  return __builtin_convertvector(narrow, Lanes);
}
OBLIQ_LANES LaneBits load_bits(const std::uint32_t* from) {
  LaneWords narrow;
  __builtin_memcpy(&narrow, from, sizeof narrow);
  return __builtin_convertvector(narrow, LaneBits);
}
OBLIQ_LANES LaneBits load_bits(const std::uint8_t* from) {
  std::uint8_t narrow __attribute__((vector_size(8)));
  __builtin_memcpy(&narrow, from, sizeof narrow);
  return __builtin_convertvector(narrow, LaneBits);
}
OBLIQ_LANES LaneBits load_bits(const std::uint64_t* from) {
  LaneBits lanes;
  __builtin_memcpy(&lanes, from, sizeof lanes);
  return lanes;
}
OBLIQ_LANES void store_words(std::uint32_t* to, LaneBits lanes) {
  const LaneWords narrow = __builtin_convertvector(lanes, LaneWords);
  __builtin_memcpy(to, &narrow, sizeof narrow);
}
OBLIQ_LANES void store_bits(std::uint64_t* to, LaneBits lanes) { __builtin_memcpy(to, &lanes, sizeof lanes); }
OBLIQ_LANES void store_lanes(double* to, Lanes lanes) { __builtin_memcpy(to, &lanes, sizeof lanes); }

/// Whole numbers that fit.
OBLIQ_LANES void store_ints(std::int32_t* to, Lanes lanes) {
  const LaneInts narrow = __builtin_convertvector(lanes, LaneInts);
  __builtin_memcpy(to, &narrow, sizeof narrow);
}

OBLIQ_LANES LaneBits bits_of(Lanes lanes) { return __builtin_bit_cast(LaneBits, lanes); }
OBLIQ_LANES Lanes lanes_of(LaneBits bits) { return __builtin_bit_cast(Lanes, bits); }
OBLIQ_LANES Lanes select(LaneFlags where, Lanes yes, Lanes no) { return where ? yes : no; }

OBLIQ_LANES Lanes least(Lanes a, Lanes b) { return select(b < a, b, a); }     // std::min, to the bit
OBLIQ_LANES Lanes greatest(Lanes a, Lanes b) { return select(a < b, b, a); }  // std::max
OBLIQ_LANES Lanes clamp(Lanes x, Lanes low, Lanes high) {                     // std::clamp
  return select(x < low, low, select(high < x, high, x));
}

/// 1 in the lanes of `where`, 0 elsewhere.
OBLIQ_LANES LaneBits ones_of(LaneFlags where) { return __builtin_bit_cast(LaneBits, where) & 1; }

/// A bit for each lane, the first lane's the lowest.
OBLIQ_LANES unsigned mask_of(LaneFlags flags) {
#if defined(__AVX512DQ__)
  return _mm512_movepi64_mask(__builtin_bit_cast(__m512i, flags));
#else
  unsigned mask = 0;
  for (int lane = 0; lane < kLanes; ++lane) mask |= flags[lane] != 0 ? 1u << lane : 0u;
  return mask;
#endif
}
OBLIQ_LANES LaneFlags flags_of(unsigned mask) {
  return ((LaneBits{} + mask) & LaneBits{1, 2, 4, 8, 16, 32, 64, 128}) != 0;
}
OBLIQ_LANES bool any(LaneFlags flags) { return mask_of(flags) != 0; }

/// The lanes of a mask moved together to the front; what is behind them means nothing.
OBLIQ_LANES Lanes compress(unsigned mask, Lanes x) {
#if defined(__AVX512F__)
  return __builtin_bit_cast(
      Lanes, _mm512_maskz_compress_pd(static_cast<__mmask8>(mask), __builtin_bit_cast(__m512d, x)));
#else
  Lanes front{};
  int n = 0;
  for (int lane = 0; lane < kLanes; ++lane)
    if ((mask >> lane & 1) != 0) front[n++] = x[lane];
  return front;
#endif
}

OBLIQ_LANES Lanes sqrt_of(Lanes x) {
#if defined(__AVX512F__)
  return __builtin_bit_cast(Lanes, _mm512_sqrt_pd(__builtin_bit_cast(__m512d, x)));
#else
  Lanes root{};
  for (int lane = 0; lane < kLanes; ++lane) root[lane] = __builtin_sqrt(x[lane]);
  return root;
#endif
}

/// from[at], at any whole numbers within the array.
OBLIQ_LANES Lanes gather(const float* from, LaneBits at) {
#if defined(__AVX512F__)
  return __builtin_bit_cast(
      Lanes, _mm512_cvtps_pd(_mm512_i64gather_ps(__builtin_bit_cast(__m512i, at), from, sizeof(float))));
#else
  Lanes found{};
  for (int lane = 0; lane < kLanes; ++lane) found[lane] = static_cast<double>(from[at[lane]]);
  return found;
#endif
}
/// from[at] and from[at + 1].
struct LanePairs {
  Lanes first, second;
};
OBLIQ_LANES LanePairs gather_pairs(const float* from, LaneBits at) {
#if defined(__AVX512F__)
  const __m512i pairs = _mm512_i64gather_epi64(__builtin_bit_cast(__m512i, at), from, sizeof(float));
  const auto doubles = [](__m512i floats) __attribute__((always_inline)) {
    return __builtin_bit_cast(Lanes, _mm512_cvtps_pd(_mm256_castsi256_ps(_mm512_cvtepi64_epi32(floats))));
  };
  return {doubles(pairs), doubles(_mm512_srli_epi64(pairs, 32))};
#else
  LanePairs found{};
  for (int lane = 0; lane < kLanes; ++lane) {
    found.first[lane] = static_cast<double>(from[at[lane]]);
    found.second[lane] = static_cast<double>(from[at[lane] + 1]);
  }
  return found;
#endif
}
OBLIQ_LANES Lanes gather(const double* from, LaneBits at) {
#if defined(__AVX512F__)
  return __builtin_bit_cast(Lanes,
                            _mm512_i64gather_pd(__builtin_bit_cast(__m512i, at), from, sizeof(double)));
#else
  Lanes found{};
  for (int lane = 0; lane < kLanes; ++lane) found[lane] = from[at[lane]];
  return found;
#endif
}

/// to[at] = x in the lanes of a mask, at whole numbers that differ.
OBLIQ_LANES void scatter(unsigned mask, double* to, LaneBits at, Lanes x) {
#if defined(__AVX512F__)
  _mm512_mask_i64scatter_pd(to, static_cast<__mmask8>(mask), __builtin_bit_cast(__m512i, at),
                            __builtin_bit_cast(__m512d, x), sizeof(double));
#else
  for (unsigned left = mask; left != 0; left &= left - 1) {
    const int lane = __builtin_ctz(left);
    to[at[lane]] = x[lane];
  }
#endif
}
OBLIQ_LANES void scatter(unsigned mask, std::uint32_t* to, LaneBits at, LaneBits x) {
#if defined(__AVX512F__)
  _mm512_mask_i64scatter_epi32(to, static_cast<__mmask8>(mask), __builtin_bit_cast(__m512i, at),
                               _mm512_cvtepi64_epi32(__builtin_bit_cast(__m512i, x)), sizeof(std::uint32_t));
#else
  for (unsigned left = mask; left != 0; left &= left - 1) {
    const int lane = __builtin_ctz(left);
    to[at[lane]] = static_cast<std::uint32_t>(x[lane]);
  }
#endif
}

/// The greatest whole number that is not above x, |x| < 2^51.
OBLIQ_LANES Lanes floor_of(Lanes x) {
  const Lanes nearest = nearest_integer(x);
  return select(nearest > x, nearest - 1.0, nearest);
}
/// Whole numbers from 0 to 2^52 as integers, and back.
OBLIQ_LANES LaneBits integers_of(Lanes whole) { return bits_of(whole + 0x1p52) & 0x000fffffffffffffull; }
OBLIQ_LANES Lanes doubles_of(LaneBits whole) { return lanes_of(whole | 0x4330000000000000ull) - 0x1p52; }

/// Whole numbers of either sign as 64-bit integers, |x| < 2^51.
OBLIQ_LANES LaneBits whole_bits(Lanes whole) {
  constexpr double kShift = 6755399441055744.0;
  return bits_of(whole + kShift) - __builtin_bit_cast(std::uint64_t, kShift);
}

struct SinCosLanes {
  Lanes sin;
  Lanes cos;
};

/// As sincos_turns in exact_math.h, to the bit.
OBLIQ_LANES SinCosLanes sincos_turns(Lanes turns) {
  const auto [quarters, s, c] = quarter_turns(turns);
  // The quarter's number, from 0, in the low bits.
  const LaneBits quarter = bits_of(quarters + 6755399441055744.0);
  const LaneFlags odd = (quarter & 1) != 0;
  const LaneBits minus_sin = (quarter >> 1) << 63;
  const LaneBits minus_cos = ((quarter + 1) >> 1) << 63;
  return {lanes_of(bits_of(select(odd, c, s)) ^ minus_sin), lanes_of(bits_of(select(odd, s, c)) ^ minus_cos)};
}

/// As log_of_positive in exact_math.h, to the bit.
OBLIQ_LANES Lanes log_of_positive(Lanes x) {
  const LaneBits bits = bits_of(x);
  Lanes exponent = doubles_of(bits >> 52) - 1023.0;
  Lanes mantissa = lanes_of((bits & 0x000fffffffffffffull) | 0x3ff0000000000000ull);
  const LaneFlags high = mantissa > 1.41421356237309504880;
  mantissa = select(high, mantissa * 0.5, mantissa);
  exponent = select(high, exponent + 1.0, exponent);
  return log_of_parts(mantissa, exponent);
}

/// As mix64 in terrain/base/hash.h.
OBLIQ_LANES LaneBits mix64(LaneBits v) {
  v += 0x9e3779b97f4a7c15u;
  v = (v ^ (v >> 30)) * 0xbf58476d1ce4e5b9u;
  v = (v ^ (v >> 27)) * 0x94d049bb133111ebu;
  return v ^ (v >> 31);
}

}  // namespace obliq::OBLIQ_ISA
