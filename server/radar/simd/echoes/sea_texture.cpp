#include "server/radar/simd/echoes/sea_texture.h"

#include "server/radar/simd/lanes/float_lanes.h"

namespace obliq::OBLIQ_ISA {
namespace {

using u32x16 = Lanes<std::uint32_t, kFloatLanes>;

/// The finaliser of MurmurHash3 (A. Appleby, public domain).
OBLIQ_INLINE u32x16 mixed(u32x16 h) {
  h = (h ^ (h >> 16)) * 0x85ebca6bU;
  h = (h ^ (h >> 13)) * 0xc2b2ae35U;
  return h ^ (h >> 16);
}

/// Sum of the four bytes.
OBLIQ_INLINE u32x16 byte_sum(u32x16 h) {
  const u32x16 pairs = (h & 0x00ff00ffU) + ((h >> 8) & 0x00ff00ffU);
  return (pairs + (pairs >> 16)) & 0xffffU;
}

/// Sum of eight random bytes less its mean, over its standard deviation: all but normal. Its excess kurtosis
/// is that of eight uniform numbers, -1.2 / 8.
constexpr float kExcess = -0.15F;
OBLIQ_INLINE f32x16 at_node(u32x16 place) {
  const u32x16 first = mixed(place);
  const u32x16 product = (first ^ (first >> 15)) * 0x2c1b3c6dU;
  const u32x16 second = product ^ (product >> 12);
  constexpr float kOverDeviation = 1 / 209.02153F;  // sqrt(8 (256^2 - 1) / 12)
  const auto sum = OBLIQ_ISA::bits_as<std::int32_t>(byte_sum(first) + byte_sum(second));
  return (converted<float>(sum) - 1020.0F) * kOverDeviation;
}

struct Along {
  u32x16 node;
  f32x16 low, high;  // weights of the node and the next
};
OBLIQ_INLINE Along along(f32x16 at, std::int32_t node) {
  const f32x16 cut = converted<float>(converted<std::int32_t>(at));
  const f32x16 floor = select(cut > at, cut - 1.0F, cut);
  const i32x16 k = converted<std::int32_t>(floor) + node;
  return {OBLIQ_ISA::bits_as<std::uint32_t>(k), 1.0F - (at - floor), at - floor};
}

OBLIQ_INLINE f32x16 tau_at(const SeaTexture& texture, f32x16 x_m, f32x16 z_m) {
  const Along x = along(x_m * texture.nodes_per_m + texture.part_x, texture.node_x);
  const Along z = along(z_m * texture.nodes_per_m + texture.part_z, texture.node_z);
  constexpr std::uint32_t kOfX = 0x9e3779b1U, kOfZ = 0x85ebca77U;
  const u32x16 x0 = x.node * kOfX, x1 = x0 + kOfX, z0 = z.node * kOfZ + texture.seed, z1 = z0 + kOfZ;
  const f32x16 sum = (at_node(x0 ^ z0) * x.low + at_node(x1 ^ z0) * x.high) * z.low +
                     (at_node(x0 ^ z1) * x.low + at_node(x1 ^ z1) * x.high) * z.high;
  const f32x16 xl2 = x.low * x.low, xh2 = x.high * x.high, zl2 = z.low * z.low, zh2 = z.high * z.high;
  const f32x16 variance = (xl2 + xh2) * (zl2 + zh2);
  const f32x16 fourth = (xl2 * xl2 + xh2 * xh2) * (zl2 * zl2 + zh2 * zh2);
  f32x16 normal = sum / sqrt(variance);
  // What is left of the kurtosis goes by Cornish and Fisher's first term.
  normal -= (kExcess / 24) * (fourth / (variance * variance)) * (normal * (normal * normal - 3.0F));
  constexpr float kLast = SeaTexture::kSteps - 0.01F;
  const f32x16 at =
      clamp((normal + static_cast<float>(SeaTexture::kReach)) * static_cast<float>(SeaTexture::kStepsAUnit),
            f32x16{}, all_lanes(kLast));
  const i32x16 k = converted<std::int32_t>(at);
  const f32x16 low = gather(texture.tau, k);
  return low + (at - converted<float>(k)) * (gather(texture.tau + 1, k) - low);
}

/// Points that a length is cut into: at most 0.6 of the lattice's side apart, up to eight.
OBLIQ_INLINE f32x16 points(f32x16 length_m, float nodes_per_m) {
  const f32x16 wanted = clamp(length_m * (nodes_per_m / 0.6F) + 0.999F, all_lanes(1.0F), all_lanes(8.0F));
  return converted<float>(converted<std::int32_t>(wanted));
}

}  // namespace

void sea_texture(const SeaTexture& texture, SeaPieces& pieces) {
  for (int first = 0; first < pieces.n; first += kFloatLanes) {
    const mask16 there =
        converted<float>(lane_numbers<std::int32_t, kFloatLanes>()) < static_cast<float>(pieces.n - first);
    const auto in = [&](const float* of) __attribute__((always_inline)) {
      return select(there, load_floats(of + first), f32x16{});
    };
    const f32x16 x = in(pieces.x_m), z = in(pieces.z_m);
    const f32x16 length = in(pieces.along_m), width = in(pieces.across_m);
    const f32x16 n_along = points(length, texture.nodes_per_m), n_across = points(width, texture.nodes_per_m);
    const f32x16 distance = max(sqrt(x * x + z * z), all_lanes(1e-3F));
    const f32x16 sine = x / distance, cosine = z / distance;
    const f32x16 step = length / n_along, step_across = width / n_across;
    const float most_along = greatest_of(n_along), most_across = greatest_of(n_across);
    f32x16 sum{};
    for (float i = 0; i < most_along; ++i) {
      const f32x16 on = (i + 0.5F - 0.5F * n_along) * step;
      const mask16 reached = n_along > i;
      for (float j = 0; j < most_across; ++j) {
        const mask16 used = reached & (n_across > j);
        if (!any(used)) continue;
        const f32x16 aside = (j + 0.5F - 0.5F * n_across) * step_across;
        sum += select(used, tau_at(texture, x + on * sine + aside * cosine, z + on * cosine - aside * sine),
                      f32x16{});
      }
    }
    store(pieces.tau + first, sum / (n_along * n_across));
  }
}

}  // namespace obliq::OBLIQ_ISA
