#pragma once
// The ground that profiles see of the range bin that each is in, and the lists that it goes to when a bin
// ends (ground_echoes.h): of eight or of sixteen profiles, one plane of an azimuth bin or two.
#include "server/radar/simd/ground/ground_echoes.h"
#include "server/radar/simd/lanes/float_lanes.h"

namespace obliq::OBLIQ_ISA {
namespace {

#if !defined(__AVX512F__)
/// By mask: which of eight lanes is the first in it, the second and so on, a byte each.
struct Fronts {
  std::uint64_t of[256] = {};
  constexpr Fronts() {
    for (unsigned mask = 0; mask < 256; ++mask)
      for (unsigned lane = 8; lane-- > 0;)
        if ((mask >> lane & 1) != 0) of[mask] = of[mask] << 8 | lane;
  }
};
constexpr Fronts kFronts;
#endif

/// Moves the lanes in `mask` to the front of `to`; what is written behind them means nothing.
template <typename T, int n>
OBLIQ_INLINE void put_front(T* to, unsigned mask, Lanes<T, n> x) {
#if defined(__AVX512F__)
  if constexpr (n == 16)
    _mm512_storeu_si512(
        to, _mm512_maskz_compress_epi32(static_cast<__mmask16>(mask), __builtin_bit_cast(__m512i, x)));
  else
    _mm256_storeu_si256(
        reinterpret_cast<__m256i*>(to),
        _mm256_maskz_compress_epi32(static_cast<__mmask8>(mask), __builtin_bit_cast(__m256i, x)));
#else
  if constexpr (n == 16) {
    put_front(to, mask & 0xff, low_half(x));
    put_front(to + __builtin_popcount(mask & 0xff), mask >> 8, high_half(x));
  } else {
#if defined(__AVX2__)
    const __m256i order = _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(static_cast<long long>(kFronts.of[mask])));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(to),
                        _mm256_permutevar8x32_epi32(__builtin_bit_cast(__m256i, x), order));
#else
    T from[sizeof x / sizeof(T)];
    to_memory(from, x);
    for (int k = 0; k < __builtin_popcount(mask); ++k) to[k] = from[kFronts.of[mask] >> 8 * k & 7];
#endif
  }
#endif
}

/// The range bin that each profile is in.
template <int n>
struct Running {
  Floats<n> bin, distance, light, material, sine;

  OBLIQ_INLINE explicit Running(const GroundEchoes& out)
      : bin(load_as<Floats<n>>(out.pending_bin)),
        distance(load_as<Floats<n>>(out.pending_distance_m)),
        light(load_as<Floats<n>>(out.pending_power)),
        material(load_as<Floats<n>>(out.pending_material)),
        sine(load_as<Floats<n>>(out.pending_sine)) {}
  OBLIQ_INLINE void keep(GroundEchoes& out) const {
    to_memory(out.pending_bin, bin);
    to_memory(out.pending_distance_m, distance);
    to_memory(out.pending_power, light);
    to_memory(out.pending_material, material);
    to_memory(out.pending_sine, sine);
  }
};

template <int n>
OBLIQ_INLINE Lanes<std::uint32_t, n> words(Numbers<n> x) {
  return OBLIQ_ISA::bits_as<std::uint32_t>(x);
}
/// Range bin x 16 + run.
template <int n>
OBLIQ_INLINE Lanes<std::uint32_t, n> places(Floats<n> bin) {
  return words<n>(truncated(bin) * GroundEchoes::kRuns + lane_numbers<std::int32_t, n>());
}

template <bool kSines, int n>
OBLIQ_INLINE void put(unsigned ended, const Running<n>& now, GroundEchoes& out) {
  put_front(out.at + out.n, ended, places<n>(now.bin));
  put_front(out.distance_m + out.n, ended, now.distance);
  put_front(out.light + out.n, ended, now.light);
  put_front(out.material + out.n, ended, words<n>(truncated(now.material)));
  if constexpr (kSines) put_front(out.sine + out.n, ended, now.sine);
  out.n += __builtin_popcount(ended);
}

/// The stretch of ground that each profile is on.
template <int n>
struct Stretch {
  static constexpr bool kWanted = true;
  GroundStretches& out;
  Floats<n> bin, material, from, end, from_h, end_h, light, height;

  OBLIQ_INLINE explicit Stretch(GroundStretches* to)
      : out(*to),
        bin(load_as<Floats<n>>(out.pending_bin)),
        material(load_as<Floats<n>>(out.pending_material)),
        from(load_as<Floats<n>>(out.pending_from_m)),
        end(load_as<Floats<n>>(out.pending_end_m)),
        from_h(load_as<Floats<n>>(out.pending_from_h_m)),
        end_h(load_as<Floats<n>>(out.pending_end_h_m)),
        light(load_as<Floats<n>>(out.pending_power)),
        height(load_as<Floats<n>>(out.pending_height)) {}
  OBLIQ_INLINE bool is_full() const { return out.n > GroundEchoes::kMost; }
  OBLIQ_INLINE void keep() const {
    to_memory(out.pending_bin, bin);
    to_memory(out.pending_material, material);
    to_memory(out.pending_from_m, from);
    to_memory(out.pending_end_m, end);
    to_memory(out.pending_from_h_m, from_h);
    to_memory(out.pending_end_h_m, end_h);
    to_memory(out.pending_power, light);
    to_memory(out.pending_height, height);
  }

  /// Goes on with a part of the surface, in the lanes that see it.
  OBLIQ_INLINE void add(Where<n> seen, Floats<n> in_bin, Floats<n> of, Floats<n> d0, Floats<n> h0,
                        Floats<n> d1, Floats<n> h1, Floats<n> part_light) {
    const Where<n> same = seen & (in_bin == bin) & (of == material) & (d0 - end < GroundStretches::kGap_m);
    const Where<n> fresh = seen & ~same;
    if (const unsigned ended = movemask(fresh & (bin >= 0.0F)); ended != 0) {
      put_front(out.at + out.n, ended,
                places<n>(bin) | words<n>(truncated(material) << GroundStretches::kMaterialBit));
      put_front(out.from_m + out.n, ended, from);
      put_front(out.end_m + out.n, ended, end);
      if (out.wants_ends) {
        put_front(out.from_h_m + out.n, ended, from_h);
        put_front(out.end_h_m + out.n, ended, end_h);
      }
      put_front(out.light + out.n, ended, light);
      put_front(out.height + out.n, ended, height);
      out.n += __builtin_popcount(ended);
    }
    const Floats<n> part_height = part_light * (0.5F * (h0 + h1));
    from = select(fresh, d0, from);
    from_h = select(fresh, h0, from_h);
    light = select(same, light + part_light, select(fresh, part_light, light));
    height = select(same, height + part_height, select(fresh, part_height, height));
    end = select(seen, d1, end);
    end_h = select(seen, h1, end_h);
    bin = select(fresh, in_bin, bin);
    material = select(fresh, of, material);
  }
};

/// Where no labels are wanted.
template <int n>
struct NoStretch {
  static constexpr bool kWanted = false;
  OBLIQ_INLINE explicit NoStretch(GroundStretches*) {}
  OBLIQ_INLINE bool is_full() const { return false; }
  OBLIQ_INLINE void keep() const {}
};

}  // namespace
}  // namespace obliq::OBLIQ_ISA
