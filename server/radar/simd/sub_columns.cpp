// Buildings without planes of their own: sixteen sub-columns of an azimuth bin at a time.
#include "server/radar/simd/sub_columns.h"

#include "server/radar/simd/float_lanes.h"

namespace obliq::OBLIQ_ISA {
namespace {

constexpr float kLowest = -1e9F;
/// A share of a sub-column below this is rounding.
constexpr float kLeastShare = 1e-5F;

/// Heights above the antenna.
struct Heights {
  f32x16 h;
  mask16 known;
};

OBLIQ_INLINE Heights heights_at(const GroundOfBin& ground, f32x16 u, f32x16 v) {
  const auto last_u = static_cast<float>(ground.nx - 2);
  const auto last_v = static_cast<float>(ground.nz - 2);
  const i32x16 i = truncated(clamp(u, f32x16{}, all_lanes(last_u)));
  const i32x16 j = truncated(clamp(v, f32x16{}, all_lanes(last_v)));
  const i32x16 at = j * ground.nx + i;
  const f32x16 y00 = gather(ground.y_m, at);
  const f32x16 y10 = gather(ground.y_m + 1, at);
  const f32x16 y01 = gather(ground.y_m + ground.nx, at);
  const f32x16 y11 = gather(ground.y_m + ground.nx + 1, at);
  const f32x16 s = u - floats_of(i);
  const f32x16 t = v - floats_of(j);
  const f32x16 lower = y00 + s * (y10 - y00) + t * (y01 - y00);
  const f32x16 upper = y11 + (1.0F - s) * (y01 - y11) + (1.0F - t) * (y10 - y11);
  const f32x16 y = select(s + t <= 1.0F, lower, upper);
  return {y - ground.antenna_y_m, (u >= 0.0F) & (v >= 0.0F) & (u <= last_u + 1.0F) & (v <= last_v + 1.0F) &
                                      (y00 + y10 + y01 + y11 == y00 + y10 + y01 + y11)};
}

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

/// sin e1 - sin e0 of two elevations by their slopes, roots[k] = sqrt(1 + slope^2): as part_of
/// (range_run.h).
OBLIQ_INLINE f32x16 sine_step(f32x16 slope0, f32x16 root0, f32x16 slope1, f32x16 root1) {
  const f32x16 roots = root0 * root1;
  return (slope1 - slope0) * (root0 + root1) / (roots * (roots + 1.0F + slope0 * slope1));
}
OBLIQ_INLINE f32x16 root_of(f32x16 slope) { return sqrt(1.0F + slope * slope); }

/// A part as sixteen sub-columns see it. Shares are of a sub-column's width, distances along it.
struct Seen {
  mask16 on;  ///< sees it
  f32x16 cover, near, far;
};

/// A wall's share of the sub-columns, and where it stands in them, in the middle of the share.
struct WallShare {
  int edge;
  f32x16 cover, distance, spread;
};

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

namespace {

/// Adds the echoes of one wall or roof, each lane's spread evenly from range r0 to r1.
OBLIQ_INLINE void add_echoes(const SubColumns& columns, mask16 which, int edge, f32x16 solid, f32x16 tangent,
                             f32x16 r0, f32x16 r1, PartEchoes& out) {
  const float bins_per_m = 1 / columns.range_spacing_m;
  const auto n_range = static_cast<float>(columns.n_range);
  const f32x16 from = (min(r0, r1) - columns.r_min_m) * bins_per_m;
  const f32x16 to = (max(r0, r1) - columns.r_min_m) * bins_per_m;
  const float nearest = least_of(select(which, from, all_lanes(1e30F)));
  const float farthest = greatest_of(select(which, to, all_lanes(-1e30F)));
  if (!(farthest >= 0) || !(nearest < n_range)) return;
  const f32x16 light = select(which, solid, f32x16{});
  const float middle_m = columns.r_min_m + 0.5F * (nearest + farthest) * columns.range_spacing_m;
  const int first = static_cast<int>(nearest < 0 ? 0 : nearest);
  const int last = farthest >= n_range ? columns.n_range - 1 : static_cast<int>(farthest);
  if (first == last && nearest >= 0 && farthest < n_range) {
    if (out.n < PartEchoes::kMost)
      out.echo[out.n++] = {first, edge, sum_of(light), middle_m, middle_m, sum_of(light * tangent)};
    return;
  }
  const f32x16 length = max(to - from, all_lanes(1e-3F));
  const f32x16 a_bin = light / length;
  for (int bin = first; bin <= last && out.n < PartEchoes::kMost; ++bin) {
    const auto edge0 = static_cast<float>(bin);
    const auto edge1 = static_cast<float>(bin + 1);
    const f32x16 part =
        max(min(from + length, all_lanes(edge1)) - max(from, all_lanes(edge0)), f32x16{}) * a_bin;
    const float sum = sum_of(part);
    const float both = max(nearest, edge0) + min(farthest, edge1);
    if (sum > 0)
      out.echo[out.n++] = {bin,      edge,
                           sum,      columns.r_min_m + 0.5F * both * columns.range_spacing_m,
                           middle_m, sum_of(part * tangent)};
  }
}

/// Takes what each sub-column hides, slopes `from` to `to` of its plane's ground from node k on, off the
/// nodes.
OBLIQ_INLINE void hide_ground(const SubColumns& columns, mask16 which, i32x16 plane, i32x16 k, f32x16 cover,
                              f32x16 from, f32x16 to) {
  const NodeProfiles& nodes = columns.nodes;
  const float until = greatest_of(select(which, to, all_lanes(kLowest)));
  // Planes rise with the lanes.
  const unsigned lanes = movemask(which);
  const int first_plane = plane[__builtin_ctz(lanes)];
  const int last_plane = plane[31 - __builtin_clz(lanes)];
  const auto node = static_cast<int>(least_of(select(which, floats_of(k), all_lanes(1e9F))));
  for (int p = first_plane; p <= last_plane; ++p) {
    const float* const horizon = nodes.horizon + static_cast<std::ptrdiff_t>(p) * nodes.stride;
    float* const hidden = nodes.hidden + static_cast<std::ptrdiff_t>(p) * nodes.stride;
    const f32x16 share = select(which & (plane == p), cover * columns.per_plane[p], f32x16{});
    for (int n = node; n + 1 < nodes.n_nodes && horizon[n] < until; ++n) {
      if (!(horizon[n + 1] > horizon[n])) continue;
      const f32x16 covered =
          max(min(all_lanes(horizon[n + 1]), to) - max(all_lanes(horizon[n]), from), f32x16{}) * share;
      hidden[n] += sum_of(covered);
    }
  }
}

}  // namespace

void see_part(const SubColumns& columns, const ConvexShape& shape, int first, PartEchoes& out) {
  const i32x16 number = lane_numbers<std::int32_t, kFloatLanes>() + first;
  const f32x16 left = columns.left + floats_of(number) * columns.width;
  const f32x16 right = columns.left + floats_of(number + 1) * columns.width;
  const f32x16 tangent = (left + right) * 0.5F;
  const f32x16 secant = 1.0F + 0.5F * tangent * tangent;  // up to a degree: 1e-8 off
  const float per_width = 1 / columns.width;

  WallShare walls[ConvexShape::kMost];
  int n_walls = 0;
  f32x16 near_sum{}, near_cover{}, far_sum{}, far_cover{};
  for (int e = 0; e < shape.n; ++e) {
    const float t0 = shape.tangent[e];
    const float t1 = shape.tangent[e + 1];
    const f32x16 from = max(all_lanes(min(t0, t1)), left);
    const f32x16 to = min(all_lanes(max(t0, t1)), right);
    const f32x16 cover = max((to - from) * per_width, f32x16{});
    const mask16 in = cover > 0.0F;
    if (!any(in)) continue;
    // On the edge 1 / distance is linear in the tangent.
    const float dr = shape.right_m[e + 1] - shape.right_m[e];
    const float da = shape.ahead_m[e + 1] - shape.ahead_m[e];
    const float cross = shape.ahead_m[e] * dr - shape.right_m[e] * da;
    const float nearest = min(shape.ahead_m[e], shape.ahead_m[e + 1]);
    const float farthest = max(shape.ahead_m[e], shape.ahead_m[e + 1]);
    const f32x16 ahead =
        clamp(cross / (dr - (from + to) * (0.5F * da)), all_lanes(nearest), all_lanes(farthest));
    const f32x16 distance = select(in, ahead * secant, all_lanes(nearest));
    if (cross > 0) {
      near_sum += cover * distance;
      near_cover += cover;
      if ((shape.walls >> e & 1) == 0) continue;
      const float bend = da / cross;
      const f32x16 spread = max(ahead * ahead * (bend < 0 ? -bend : bend) * (to - from), f32x16{});
      walls[n_walls++] = {e, cover, distance, min(spread, all_lanes(farthest - nearest)) * 0.5F};
    } else {
      far_sum += cover * distance;
      far_cover += cover;
    }
  }
  const mask16 on = (near_cover > kLeastShare) & (far_cover > kLeastShare);
  if (!any(on)) return;
  const f32x16 one = all_lanes(1.0F);
  const f32x16 cover = min(near_cover, one);
  const f32x16 near = select(on, near_sum / near_cover, all_lanes(shape.ahead_m[0]));
  const f32x16 far = max(near, select(on, far_sum / far_cover, near));

  // What stands in front: the ground where the wall stands, as deep below its plane's horizon as there, and
  // buildings.
  const NodeProfiles& nodes = columns.nodes;
  const f32x16 along = near / secant;
  const GroundOfBin& g = columns.ground;
  const auto [foot_m, known] = heights_at(g, g.start_u + along * (g.forward_u + tangent * g.right_u),
                                          g.start_v + along * (g.forward_v + tangent * g.right_v));
  const f32x16 node = near * (1 / nodes.node_m);
  const i32x16 k = truncated(clamp(node, f32x16{}, all_lanes(static_cast<float>(nodes.n_nodes - 2))));
  const f32x16 past = min(node - floats_of(k), one);
  const i32x16 plane = (number * nodes.planes) >> columns.log2_n;
  const i32x16 at = plane * nodes.stride + k;
  const auto between = [&](const float* values) __attribute__((always_inline)) {
    const f32x16 here = gather(values, at);
    return here + past * (gather(values + 1, at) - here);
  };
  const f32x16 horizon = between(nodes.horizon);
  const f32x16 over_near = 1.0F / near;
  const f32x16 foot =
      select(known, foot_m * over_near + between(nodes.clearance), max(shape.base_m * over_near, horizon));
  const f32x16 roofs = load_floats(columns.roofs + first);
  const f32x16 low = max(foot, roofs);
  const f32x16 top = shape.roof_m * over_near;
  const f32x16 back = shape.roof_m / far;
  const f32x16 highest = max(top, back);
  const f32x16 roof_from = max(low, top);
  const mask16 roof_seen = on & (back > roof_from);
  const mask16 rises = on & (highest > low);
  if (!any(rises)) return;

  const f32x16 foot_height = foot * near;
  for (int w = 0; w < n_walls; ++w) {
    const WallShare& wall = walls[w];
    const f32x16 over = 1.0F / wall.distance;
    const f32x16 from = max(foot_height * over, roofs);
    const f32x16 to = shape.roof_m * over;
    const mask16 seen = on & (to > from) & (wall.cover > 0.0F);
    if (!any(seen)) continue;
    const f32x16 root0 = root_of(from);
    const f32x16 root1 = root_of(to);
    const f32x16 r0 = wall.distance * root0;
    const f32x16 r1 = wall.distance * root1;
    add_echoes(columns, seen, wall.edge, wall.cover * columns.width_rad * sine_step(from, root0, to, root1),
               tangent, min(r0, r1) - wall.spread, max(r0, r1) + wall.spread, out);
  }
  if (any(roof_seen)) {
    const f32x16 root0 = root_of(roof_from);
    const f32x16 root1 = root_of(back);
    const f32x16 from_m = shape.roof_m / roof_from;
    add_echoes(columns, roof_seen, PartEchoes::kRoof,
               cover * columns.width_rad * sine_step(roof_from, root0, back, root1), tangent, from_m * root0,
               far * root1, out);
  }
  // It hides its plane's ground as if it stood there as it stands on its own.
  const f32x16 shift = horizon - foot;
  hide_ground(columns, rises, plane, k, cover, low + shift, highest + shift);
  store(columns.roofs + first, select(on & (cover >= 0.5F), max(roofs, highest), roofs));
}

}  // namespace obliq::OBLIQ_ISA
