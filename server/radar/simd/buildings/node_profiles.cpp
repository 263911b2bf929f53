// The bare ground of an azimuth bin's planes, node by node.
#include "server/radar/simd/buildings/ground_under.h"

namespace obliq::OBLIQ_ISA {
namespace {

constexpr float kLowest = -1e9F;

/// The greatest of a lane and all before it.
template <int n>
OBLIQ_INLINE Lanes<float, n> greatest_so_far(Lanes<float, n> x) {
  if constexpr (!is_one<float, n>(nullptr)) {
    const auto low = greatest_so_far(x.low);
    return {low, max(greatest_so_far(x.high), Lanes<float, n / 2>{} + low[n / 2 - 1])};
  } else {
    x = max(x, moved_on<1>(x));
    x = max(x, moved_on<2>(x));
    if constexpr (n > 4) x = max(x, moved_on<4>(x));
    if constexpr (n > 8) x = max(x, moved_on<8>(x));
    return x;
  }
}

}  // namespace

void profile_nodes(const SubColumns& columns, int plane, float rate_u, float rate_v) {
  const NodeProfiles& nodes = columns.nodes;
  const GroundOfBin& ground = columns.ground;
  const std::size_t first = static_cast<std::size_t>(plane) * static_cast<std::size_t>(nodes.stride);
  const auto lane = lane_numbers<float, kFloatLanes>();
  const float bins_per_m = 1 / columns.range_spacing_m;
  f32x16 carry = all_lanes(kLowest);
  for (int k = 0; k < nodes.stride; k += kFloatLanes) {
    const f32x16 d = (lane + (static_cast<float>(k) + NodeProfiles::kFirstNode)) * nodes.node_m;
    const auto [h, known] = heights_at(ground, ground.start_u + d * rate_u, ground.start_v + d * rate_v);
    const f32x16 slope = h / d;
    const f32x16 top = max(greatest_so_far(select(known, slope, all_lanes(kLowest))), carry);
    carry = all_lanes(top[kFloatLanes - 1]);
    const std::size_t at = first + static_cast<std::size_t>(k);
    store(nodes.horizon + at, top);
    store(nodes.clearance + at, select(known, top - slope, f32x16{}));
    const f32x16 root = root_of(top);
    store(nodes.range_bin + at, (d * root - columns.r_min_m) * bins_per_m);
    if (nodes.sine != nullptr) store(nodes.sine + at, top / root);
  }
}

}  // namespace obliq::OBLIQ_ISA
