#pragma once
// The edges of a house's part as its sub-columns need them, and what these have of each.
#include "server/radar/simd/buildings/ground_under.h"

namespace obliq::OBLIQ_ISA {

/// What the edges of a part have for all sub-columns, eight at a time. Directions are tangents.
struct Edges {
  float from[ConvexShape::kMost], to[ConvexShape::kMost];
  float right_m[ConvexShape::kMost];  // that an edge goes
  float half_ahead_m[ConvexShape::kMost];
  float over_cross[ConvexShape::kMost];  // 1 / the cross product of its corners
  float depth_m[ConvexShape::kMost];     // from its nearest to its farthest corner
  float over_nearest[ConvexShape::kMost], over_farthest[ConvexShape::kMost];  // 1 / how far ahead these are
  float bend[ConvexShape::kMost];
  std::uint64_t near = 0, far = 0;  // bits of those that face the antenna, and of the others

  OBLIQ_INLINE explicit Edges(const ConvexShape& shape) {
    constexpr int kEdges = 8;
    using Each = Lanes<float, kEdges>;
    for (int e = 0; e < shape.n; e += kEdges) {
      const auto t0 = load_as<Each>(shape.tangent + e);
      const auto t1 = load_as<Each>(shape.tangent + e + 1);
      const auto right0 = load_as<Each>(shape.right_m + e);
      const auto ahead0 = load_as<Each>(shape.ahead_m + e);
      const auto ahead1 = load_as<Each>(shape.ahead_m + e + 1);
      const Each dr = load_as<Each>(shape.right_m + e + 1) - right0;
      const Each da = ahead1 - ahead0;
      const Each cross = ahead0 * dr - right0 * da;
      const Each of_cross = 1.0F / cross;
      const Each of_bend = da * of_cross;
      const Each nearest = min(ahead0, ahead1);
      const Each farthest = max(ahead0, ahead1);
      to_memory(from + e, min(t0, t1));
      to_memory(to + e, max(t0, t1));
      to_memory(right_m + e, dr);
      to_memory(half_ahead_m + e, 0.5F * da);
      to_memory(over_cross + e, of_cross);
      near |= std::uint64_t{movemask(cross > 0.0F)} << e;
      to_memory(depth_m + e, farthest - nearest);
      to_memory(over_nearest + e, 1.0F / nearest);
      to_memory(over_farthest + e, 1.0F / farthest);
      to_memory(bend + e, max(of_bend, -of_bend));
    }
    const std::uint64_t all = (std::uint64_t{1} << shape.n) - 1;
    near &= all;
    far = near ^ all;
  }
};

/// what(e) of each bit.
template <typename What>
OBLIQ_INLINE void for_each_edge(std::uint64_t edges, const What& what) {
  for (; edges != 0; edges &= edges - 1) what(__builtin_ctzll(edges));
}

/// Sub-columns by their tangents.
template <int n>
struct Columns {
  Numbers<n> number;
  Floats<n> left, right, tangent, secant, cosine;

  OBLIQ_INLINE Columns(const SubColumns& all, int first)
      : number(lane_numbers<std::int32_t, n>() + first),
        left(all.left + floats_of(number) * all.width),
        right(all.left + floats_of(number + 1) * all.width),
        tangent((left + right) * 0.5F),
        secant(1.0F + 0.5F * tangent * tangent),  // up to a degree: 1e-8 off
        cosine(1.0F - 0.5F * tangent * tangent) {}
};

/// A distance and one over it.
template <int n>
struct Distance {
  Floats<n> m, over;
};

/// An edge's share of the sub-columns, and where it stands in them, in the middle of the share.
template <int n>
struct EdgeShare {
  Floats<n> cover;
  Distance<n> distance;  ///< where there is none, one that it has elsewhere
  Floats<n> spread;      ///< half of how much nearer one end of the share is
};

template <int n>
OBLIQ_INLINE EdgeShare<n> share_of(const Edges& edges, int e, const Columns<n>& columns, float per_width) {
  const Floats<n> from = max(in_all<n>(edges.from[e]), columns.left);
  const Floats<n> to = min(in_all<n>(edges.to[e]), columns.right);
  const Floats<n> cover = max((to - from) * per_width, Floats<n>{});
  // On the edge 1 / distance is linear in the tangent.
  const Floats<n> on_line = (edges.right_m[e] - (from + to) * edges.half_ahead_m[e]) * edges.over_cross[e];
  const Floats<n> over =
      min(max(in_all<n>(edges.over_farthest[e]), on_line), in_all<n>(edges.over_nearest[e]));
  const Floats<n> ahead = 1.0F / over;
  const Floats<n> turned = max(Floats<n>{}, ahead * ahead * edges.bend[e] * (to - from));
  return {cover,
          {ahead * columns.secant, over * columns.cosine},
          min(turned, in_all<n>(edges.depth_m[e])) * 0.5F};
}

/// Shares of the edges that face the antenna, or of those that do not.
template <int n>
struct EdgeSum {
  Floats<n> cover{}, distance{};

  OBLIQ_INLINE void add(const EdgeShare<n>& share) {
    cover += share.cover;
    distance += share.cover * share.distance.m;
  }
  /// Their mean where there are some, else anything.
  OBLIQ_INLINE Distance<n> mean() const {
    const Floats<n> over_both = 1.0F / (cover * distance);
    return {distance * (distance * over_both), cover * (cover * over_both)};
  }
};

}  // namespace obliq::OBLIQ_ISA
