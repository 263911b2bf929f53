#pragma once
// What buildings hide of the ground behind them.
#include "server/radar/simd/buildings/ground_under.h"

namespace obliq::OBLIQ_ISA {

/// Adds up term(0) to term(n - 1), in pairs.
template <int n, int first = 0, int step = 1, typename Term>
OBLIQ_INLINE auto sum_of_terms(const Term& term) {
  if constexpr (step == n)
    return term(first);
  else
    return sum_of_terms<n, first, 2 * step>(term) + sum_of_terms<n, first + step, 2 * step>(term);
}

/// Takes what each sub-column in `rises` hides, slopes `from` to `to` of its plane's ground from node k on,
/// off the nodes: a register of nodes at a time, one sub-column after the other. What is hidden below a
/// node's slope, less what is below that of the node before.
template <int n>
OBLIQ_INLINE void hide_ground(const SubColumns& columns, Where<n> rises, Numbers<n> plane, Numbers<n> k,
                              Floats<n> cover, Floats<n> from, Floats<n> to) {
  constexpr int kNodes = kRegisterBytes / static_cast<int>(sizeof(float));
  constexpr int kGroup = 8;  // of sub-columns
  using Nodes = Floats<kNodes>;
  const NodeProfiles& nodes = columns.nodes;
  // Before the first known ground of a plane its horizon is far below everything: there is none to hide.
  const Where<n> which = rises & (to > -1e8F);
  if (!any(which)) return;
  const Floats<n> none = in_all<n>(-1e9F);
  const auto [until, nearest] = greatest_of(select(which, to, none), select(which, -floats_of(k), none));
  const auto node = static_cast<int>(-nearest);
  // Planes rise with the lanes.
  const unsigned lanes = movemask(which);
  const int first_plane = plane[__builtin_ctz(lanes)];
  const int last_plane = plane[31 - __builtin_clz(lanes)];
  constexpr unsigned kLanes = n;
  float from_of[kLanes], to_of[kLanes], share_of[kLanes];
  for (int p = first_plane; p <= last_plane; ++p) {
    const Where<n> own = which & (plane == p);
    const unsigned own_lanes = movemask(own);
    if (own_lanes == 0) continue;
    const int first_lane = __builtin_ctz(own_lanes) / kGroup * kGroup;
    const int last_lane = 31 - __builtin_clz(own_lanes);
    to_memory(share_of, select(own, cover * columns.per_plane[p], Floats<n>{}));
    const float* const horizon = nodes.horizon + static_cast<std::ptrdiff_t>(p) * nodes.stride;
    float* const hidden = nodes.hidden + static_cast<std::ptrdiff_t>(p) * nodes.stride;
    // From the top of the shadow down, where it falls on ground at all, so that floats keep small
    // differences.
    const float shadow_top = min(until, horizon[nodes.n_nodes - 1]);
    to_memory(from_of, select(own, min(from - shadow_top, Floats<n>{}), Floats<n>{}));
    to_memory(to_of, select(own, min(to - shadow_top, Floats<n>{}), Floats<n>{}));
    // Behind the node where nothing is hidden any more, and behind the last one, nothing counts.
    for (int at = node; at + 1 < nodes.n_nodes && horizon[at] < until; at += kNodes - 1) {
      const Nodes here = load_as<Nodes>(horizon + at) - shadow_top;
      Nodes below{};
      for (int first = first_lane; first <= last_lane; first += kGroup)
        below += sum_of_terms<kGroup>([&](int of_group) __attribute__((always_inline)) {
          const int lane = first + of_group;
          return min(max(here, in_all<kNodes>(from_of[lane])), in_all<kNodes>(to_of[lane])) * share_of[lane];
        });
      to_memory(hidden + at, load_as<Nodes>(hidden + at) + (moved_back<1>(below) - below));
    }
  }
}

}  // namespace obliq::OBLIQ_ISA
