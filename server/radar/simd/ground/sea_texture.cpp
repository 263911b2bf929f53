#include "server/radar/simd/ground/sea_texture.h"

#include "server/radar/simd/lanes/float_lanes.h"

namespace obliq::OBLIQ_ISA {
namespace {

using u32x16 = Lanes<std::uint32_t, kFloatLanes>;

/// Random bits from those of two node numbers times odd constants: one round of a multiplicative hash (C.
/// Wellons, Hash Prospector, 2018, public domain, has the multiplier). Over 2,048 x 2,048 nodes neither the
/// field nor its square has a correlation beyond chance.
OBLIQ_INLINE u32x16 mixed(u32x16 h) {
  h = (h ^ (h >> 15)) * 0x2c1b3c6dU;
  return h ^ (h >> 13);
}

/// Of each lane the sum of its four bytes.
template <int n>
OBLIQ_INLINE Lanes<std::int32_t, n> byte_sums(Lanes<std::uint32_t, n> x) {
  if constexpr (!OBLIQ_ISA::is_one<std::uint32_t, n>(nullptr)) {
    return {byte_sums(x.low), byte_sums(x.high)};
  } else {
    using Sums = typename Lanes<std::int32_t, n>::Register;
#if defined(__AVX512F__)
    if constexpr (n == 16) {
      const __m512i pairs = _mm512_maddubs_epi16(__builtin_bit_cast(__m512i, x.v), _mm512_set1_epi8(1));
      return {__builtin_bit_cast(Sums, _mm512_madd_epi16(pairs, _mm512_set1_epi16(1)))};
    }
#endif
#if defined(__AVX2__)
    if constexpr (n == 8) {
      const __m256i pairs = _mm256_maddubs_epi16(__builtin_bit_cast(__m256i, x.v), _mm256_set1_epi8(1));
      return {__builtin_bit_cast(Sums, _mm256_madd_epi16(pairs, _mm256_set1_epi16(1)))};
    }
#endif
    if constexpr (n == 4) {
      const __m128i pairs = _mm_maddubs_epi16(__builtin_bit_cast(__m128i, x.v), _mm_set1_epi8(1));
      return {__builtin_bit_cast(Sums, _mm_madd_epi16(pairs, _mm_set1_epi16(1)))};
    }
  }
}

/// Sum of four random bytes: all but normal. Its excess kurtosis is that of four uniform numbers, -1.2 / 4.
constexpr float kMean = 510;
constexpr float kOverDeviation = 1 / 147.80054F;  // sqrt(4 (256^2 - 1) / 12)
constexpr float kExcess = -0.3F;
OBLIQ_INLINE f32x16 at_node(u32x16 place) { return converted<float>(byte_sums(mixed(place))); }

/// Between two nodes of an axis. With b from -1/2 to 1/2 between them, a value weighs c - b and c + b, c =
/// sqrt(1/2 - b^2): the squares of weights add up to 1.
struct Along {
  u32x16 node;
  f32x16 low, high;  // weights of the node and the next
  f32x16 middle;     // c
  f32x16 kurtosis;   // low^4 + high^4
};
/// at: sides of the lattice from the middle between `node` and the next.
OBLIQ_INLINE Along along(f32x16 at, std::uint32_t node) {
  const f32x16 shifted = at + kNoFraction;
  const f32x16 b = at - (shifted - kNoFraction);
  const f32x16 q = b * b;
  Along to;
  to.node =
      OBLIQ_ISA::bits_as<std::uint32_t>(shifted) + (node - __builtin_bit_cast(std::uint32_t, kNoFraction));
  to.middle = (0.707142919F - 0.711463989F * q) - (q * q) * (0.274405608F + 0.773155623F * q);  // to 5e-5
  to.low = to.middle - b;
  to.high = to.middle + b;
  to.kurtosis = 0.5F + q * (4.0F - 8.0F * q);
  return to;
}

OBLIQ_INLINE f32x16 tau_at(const SeaTexture& texture, f32x16 x_m, f32x16 z_m) {
  const Along x = along(x_m * texture.nodes_per_m + texture.part_x, texture.node_x);
  const Along z = along(z_m * texture.nodes_per_m + texture.part_z, texture.node_z);
  constexpr std::uint32_t kOfX = 0x9e3779b1U, kOfZ = 0x85ebca77U;
  const u32x16 x0 = x.node * kOfX, x1 = x0 + kOfX, z0 = z.node * kOfZ + texture.seed, z1 = z0 + kOfZ;
  const f32x16 sum = (at_node(x0 ^ z0) * x.low + at_node(x1 ^ z0) * x.high) * z.low +
                     (at_node(x0 ^ z1) * x.low + at_node(x1 ^ z1) * x.high) * z.high;
  const f32x16 normal = sum * kOverDeviation - (4 * kMean * kOverDeviation) * (x.middle * z.middle);
  // What is left of the kurtosis goes by Cornish and Fisher's first term.
  const f32x16 left = (kExcess / 24) * (x.kurtosis * z.kurtosis);
  const f32x16 corrected = normal * (1.0F + left * (3.0F - normal * normal));
  const f32x16 at = corrected * static_cast<float>(SeaTexture::kStepsAUnit) +
                    (static_cast<float>(SeaTexture::kReach * SeaTexture::kStepsAUnit) + 0.5F);
  return gather(texture.tau, truncated(min(max(f32x16{}, at), all_lanes(float{SeaTexture::kSteps}))));
}

/// Points that a length is cut into: at most 0.6 of the lattice's side apart, up to eight.
OBLIQ_INLINE f32x16 points(f32x16 length_m, float nodes_per_m) {
  const f32x16 wanted = clamp(length_m * (nodes_per_m / 0.6F) + 0.999F, all_lanes(1.0F), all_lanes(8.0F));
  return converted<float>(converted<std::int32_t>(wanted));
}

/// The mean of tau over a piece, as SeaPieces has them.
OBLIQ_INLINE f32x16 mean_tau(const SeaTexture& texture, f32x16 distance, f32x16 sine, f32x16 cosine,
                             f32x16 length, f32x16 width) {
  const f32x16 n_along = points(length, texture.nodes_per_m), n_across = points(width, texture.nodes_per_m);
  const f32x16 share = 1.0F / (n_along * n_across);
  const f32x16 step = length * (n_across * share), step_across = width * (n_along * share);
  const float most_along = greatest_of(n_along), most_across = greatest_of(n_across);
  f32x16 sum{};
  for (float i = 0; i < most_along; ++i) {
    const f32x16 on = distance + (i + 0.5F - 0.5F * n_along) * step;
    const mask16 reached = n_along > i;
    for (float j = 0; j < most_across; ++j) {
      const mask16 used = reached & (n_across > j);
      if (!any(used)) continue;
      const f32x16 aside = (j + 0.5F - 0.5F * n_across) * step_across;
      sum += select(used, tau_at(texture, on * sine + aside * cosine, on * cosine - aside * sine), f32x16{});
    }
  }
  return sum * share;
}

}  // namespace

void sea_texture(const SeaTexture& texture, SeaPieces& pieces) {
  for (int first = 0; first < pieces.n; first += kFloatLanes) {
    const mask16 there =
        converted<float>(lane_numbers<std::int32_t, kFloatLanes>()) < static_cast<float>(pieces.n - first);
    const auto in = [&](const float* of) __attribute__((always_inline)) {
      return select(there, load_floats(of + first), f32x16{});
    };
    store(pieces.tau + first, mean_tau(texture, in(pieces.distance_m), in(pieces.sine), in(pieces.cosine),
                                       in(pieces.along_m), in(pieces.across_m)));
  }
}

void texture_echoes(const SeaTexture& texture, const PiecesOfBins& of, const float* over_gamma,
                    GroundEchoes& echoes) {
  static_assert(GroundEchoes::kRuns == kFloatLanes && GroundEchoes::kMost % kFloatLanes == 0);
  static_assert(GroundEchoes::kSpare >= kFloatLanes);
  for (int first = 0; first < echoes.n; first += kFloatLanes) {
    const mask16 there =
        converted<float>(lane_numbers<std::int32_t, kFloatLanes>()) < static_cast<float>(echoes.n - first);
    const auto whole = [&](const std::uint32_t* from) __attribute__((always_inline)) {
      return OBLIQ_ISA::bits_as<std::int32_t>(load_as<u32x16>(from + first));
    };
    const i32x16 material = select(there, whole(echoes.material), i32x16{});
    const mask16 water = there & (gather(over_gamma, material) > 0.0F);
    if (!any(water)) continue;
    const i32x16 at = select(water, whole(echoes.at), i32x16{});
    const i32x16 run = at & (GroundEchoes::kRuns - 1);
    const f32x16 bin = converted<float>(at >> GroundEchoes::kLog2Runs);
    const f32x16 distance = select(water, load_floats(echoes.distance_m + first), all_lanes(1.0F));
    const f32x16 tau = select(water,
                              mean_tau(texture, distance, gather(of.sine, run), gather(of.cosine, run),
                                       of.along_m(bin, distance), distance * of.width_rad),
                              all_lanes(1.0F));
    // What is behind the last one means nothing.
    store(echoes.light + first, load_floats(echoes.light + first) * tau);
    store(echoes.sine + first, load_floats(echoes.sine + first) * tau);
  }
}

}  // namespace obliq::OBLIQ_ISA
