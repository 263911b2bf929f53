// Buildings without planes of their own: sub-columns of an azimuth bin side by side.
#include "server/radar/simd/buildings/sub_columns.h"

#include "server/radar/simd/buildings/hidden_ground.h"
#include "server/radar/simd/buildings/part_edges.h"
#include "server/radar/simd/buildings/seen_faces.h"

namespace obliq::OBLIQ_ISA {
namespace {

/// A share of a sub-column below this is rounding.
constexpr float kLeastShare = 1e-5F;

template <int n>
struct WallShare {
  int edge;
  EdgeShare<n> share;
};

template <int n>
OBLIQ_INLINE void see_in(const SubColumns& all, const ConvexShape& shape, int first, PartEchoes& out) {
  const Columns<n> columns(all, first);
  const float per_width = 1 / all.width;
  WallShare<n> walls[ConvexShape::kMost];
  int n_walls = 0;
  EdgeSum<n> nearer, farther;
  const Edges edges(shape);
  for_each_edge(
      edges.near, [&](int e) __attribute__((always_inline)) {
        const EdgeShare<n> share = share_of(edges, e, columns, per_width);
        nearer.add(share);
        walls[n_walls] = {e, share};
        n_walls += static_cast<int>(shape.walls >> e & 1);
      });
  for_each_edge(
      edges.far, [&](int e)
                     __attribute__((always_inline)) { farther.add(share_of(edges, e, columns, per_width)); });
  const Where<n> on = (nearer.cover > kLeastShare) & (farther.cover > kLeastShare);
  if (!any(on)) return;
  const Floats<n> one = in_all<n>(1.0F);
  const Floats<n> cover = min(nearer.cover, one);
  const Distance<n> mean_near = nearer.mean();
  const Distance<n> mean_far = farther.mean();
  const Floats<n> near = select(on, mean_near.m, in_all<n>(shape.ahead_m[0]));
  const Floats<n> over_near = select(on, mean_near.over, in_all<n>(1 / shape.ahead_m[0]));
  const Floats<n> far = max(near, select(on, mean_far.m, near));
  const Floats<n> over_far = min(over_near, select(on, mean_far.over, over_near));

  // What stands in front: the ground where the wall stands, as deep below its plane's horizon as there, and
  // buildings.
  const NodeProfiles& nodes = all.nodes;
  const GroundOfBin& g = all.ground;
  const Floats<n> along = near * columns.cosine;
  const auto [foot_m, known] = heights_at(g, g.start_u + along * (g.forward_u + columns.tangent * g.right_u),
                                          g.start_v + along * (g.forward_v + columns.tangent * g.right_v));
  const Floats<n> node = near * (1 / nodes.node_m);
  const Numbers<n> k =
      truncated(min(max(Floats<n>{}, node), in_all<n>(static_cast<float>(nodes.n_nodes - 2))));
  const Floats<n> past = min(node - floats_of(k), one);
  const Numbers<n> plane = planes_of(columns.number, nodes.planes, all.n);
  const auto [horizon, clearance] = BetweenNodes<n>{nodes, plane, k, past}.of(nodes.horizon, nodes.clearance);
  const Floats<n> foot =
      select(known, foot_m * over_near + clearance, max(shape.base_m * over_near, horizon));
  const Floats<n> roofs = load_as<Floats<n>>(all.roofs + first);
  const Floats<n> low = max(foot, roofs);
  const Floats<n> top = shape.roof_m * over_near;
  const Floats<n> back = shape.roof_m * over_far;
  const Floats<n> highest = max(top, back);
  const Where<n> rises = on & (highest > low);
  if (!any(rises)) return;

  const Floats<n> foot_height = foot * near;
  for (int w = 0; w < n_walls; ++w) {
    const EdgeShare<n>& wall = walls[w].share;
    const Floats<n> distance = wall.distance.m;
    const Floats<n> from = max(foot_height * wall.distance.over, roofs);
    const Floats<n> to = shape.roof_m * wall.distance.over;
    const Where<n> seen = on & (to > from) & (wall.cover > 0.0F);
    if (!any(seen)) continue;
    const Floats<n> root0 = root_of(from);
    const Floats<n> root1 = root_of(to);
    const Floats<n> r0 = distance * root0;
    const Floats<n> r1 = distance * root1;
    SeenFace<n>(all, seen, walls[w].edge, wall.cover * all.width_rad * sine_step(from, root0, to, root1),
                min(r0, r1) - wall.spread, max(r0, r1) + wall.spread)
        .add_echoes(all, columns.tangent, out);
  }
  const Floats<n> roof_from = max(low, top);
  const Where<n> roof_seen = on & (back > roof_from);
  if (any(roof_seen)) {
    const Floats<n> root0 = root_of(roof_from);
    const Floats<n> root1 = root_of(back);
    const Floats<n> r1 = far * root1;
    const Floats<n> r0 = select(roof_seen, shape.roof_m / roof_from * root0, r1);
    SeenFace<n>(all, roof_seen, PartEchoes::kRoof,
                cover * all.width_rad * sine_step(roof_from, root0, back, root1), r0, r1)
        .add_echoes(all, columns.tangent, out);
  }
  // It hides its plane's ground as if it stood there as it stands on its own.
  const Floats<n> shift = horizon - foot;
  hide_ground(all, rises, plane, k, cover, low + shift, highest + shift);
  // A sub-column that it covers in part is hidden in part: as much of the slope that it adds.
  to_memory(all.roofs + first, select(rises, low + cover * (highest - low), roofs));
  if (all.shades == nullptr) return;
  const Floats<n> shades = load_as<Floats<n>>(all.shades + first);
  to_memory(all.shades + first, select(rises & (cover >= 0.5F), max(shades, highest), shades));
}

}  // namespace

void see_part(const SubColumns& columns, const ConvexShape& shape, int first, int count, PartEchoes& out) {
  if (count > kFloatLanes)
    see_in<2 * kFloatLanes>(columns, shape, first, out);
  else if (count > kFloatLanes / 2)
    see_in<kFloatLanes>(columns, shape, first, out);
  else
    see_in<kFloatLanes / 2>(columns, shape, first, out);
}

}  // namespace obliq::OBLIQ_ISA
