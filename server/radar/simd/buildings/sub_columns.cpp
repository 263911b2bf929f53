// Buildings without planes of their own: sixteen sub-columns of an azimuth bin at a time.
#include "server/radar/simd/buildings/sub_columns.h"

#include <array>

#include "server/radar/simd/buildings/part_edges.h"
#include "server/radar/simd/lanes/float_windows.h"

namespace obliq::OBLIQ_ISA {
namespace {

constexpr float kLowest = -1e9F;
/// A share of a sub-column below this is rounding.
constexpr float kLeastShare = 1e-5F;

template <int n>
using Floats = Lanes<float, n>;
template <int n>
using Numbers = Lanes<std::int32_t, n>;
template <int n>
using Where = Lanes<MaskOf<float>, n>;

template <int n>
OBLIQ_INLINE Floats<n> in_all(float value) {
  return every(static_cast<const Floats<n>*>(nullptr), value);
}

/// Heights above the antenna.
template <int n>
struct Heights {
  Floats<n> h;
  Where<n> known;
};

/// The heights of the corners of cells.
template <int n>
struct Corners {
  Floats<n> y00, y10, y01, y11;
};

template <int n>
OBLIQ_INLINE Corners<n> corners_anywhere(const GroundOfBin& ground, Numbers<n> i, Numbers<n> j) {
  const Numbers<n> at = j * ground.nx + i;
  return {gather(ground.y_m, at), gather(ground.y_m + 1, at), gather(ground.y_m + ground.nx, at),
          gather(ground.y_m + ground.nx + 1, at)};
}

#if defined(__AVX2__)

template <int n>
OBLIQ_INLINE Corners<n> corners_of(const GroundOfBin& ground, Numbers<n> i, Numbers<n> j) {
  constexpr int kRows = 4;
  const int first_i = window_around(i[0], kWindow, ground.nx);
  const int first_j = window_around(j[0], kRows, ground.nz);
  const Numbers<n> at = i - first_i;
  const Numbers<n> row = j - first_j;
  if (ground.nx < kWindow || ground.nz < kRows || !all_up_to(at, kWindow - 2) || !all_up_to(row, kRows - 2))
    return corners_anywhere(ground, i, j);
  const float* const y_m = ground.y_m + static_cast<std::ptrdiff_t>(first_j) * ground.nx + first_i;
  Floats<n> here[kRows], next[kRows];
  for (int k = 0; k < kRows; ++k) {
    const auto window = load_as<Window>(y_m + static_cast<std::ptrdiff_t>(k) * ground.nx);
    here[k] = taken(window, at);
    next[k] = taken(window, at + 1);
  }
  const Where<n> second = row == 1;
  const Where<n> third = row == 2;
  const auto of_row = [&](const Floats<n>* rows) __attribute__((always_inline)) {
    return select(third, rows[2], select(second, rows[1], rows[0]));
  };
  return {of_row(here), of_row(next), of_row(here + 1), of_row(next + 1)};
}

#else

template <int n>
OBLIQ_INLINE Corners<n> corners_of(const GroundOfBin& ground, Numbers<n> i, Numbers<n> j) {
  return corners_anywhere(ground, i, j);
}

#endif

template <int n>
OBLIQ_INLINE Heights<n> heights_at(const GroundOfBin& ground, Floats<n> u, Floats<n> v) {
  const auto last_u = static_cast<float>(ground.nx - 2);
  const auto last_v = static_cast<float>(ground.nz - 2);
  const Numbers<n> i = truncated(clamp(u, Floats<n>{}, in_all<n>(last_u)));
  const Numbers<n> j = truncated(clamp(v, Floats<n>{}, in_all<n>(last_v)));
  const auto [y00, y10, y01, y11] = corners_of(ground, i, j);
  const Floats<n> s = u - floats_of(i);
  const Floats<n> t = v - floats_of(j);
  const Floats<n> lower = y00 + s * (y10 - y00) + t * (y01 - y00);
  const Floats<n> upper = y11 + (1.0F - s) * (y01 - y11) + (1.0F - t) * (y10 - y11);
  const Floats<n> y = select(s + t <= 1.0F, lower, upper);
  return {y - ground.antenna_y_m, (u >= 0.0F) & (v >= 0.0F) & (u <= last_u + 1.0F) & (v <= last_v + 1.0F) &
                                      (y00 + y10 + y01 + y11 == y00 + y10 + y01 + y11)};
}

/// Numbers of planes' profiles between the nodes that lanes lie between.
template <int n>
struct BetweenNodes {
  const NodeProfiles& nodes;
  Numbers<n> plane, k;  ///< planes rise with the lanes
  Floats<n> past;       ///< of the way from node k to the next

  [[gnu::always_inline]] Floats<n> anywhere(const float* values) const {
    const Numbers<n> at = plane * nodes.stride + k;
    const Floats<n> here = gather(values, at);
    return here + past * (gather(values + 1, at) - here);
  }
#if defined(__AVX2__)
  [[gnu::always_inline]] std::array<Floats<n>, 2> of(const float* first, const float* second) const {
    const int plane0 = plane[0];
    const int plane1 = plane[n - 1];
    const int first_k = window_around(k[0], kWindow, nodes.stride);
    const Numbers<n> at = k - first_k;
    if (plane1 - plane0 > 1 || !all_up_to(at, kWindow - 2)) return {anywhere(first), anywhere(second)};
    const auto windowed = [&](const float* values) __attribute__((always_inline)) {
      const float* const from = values + static_cast<std::ptrdiff_t>(plane0) * nodes.stride + first_k;
      auto window = load_as<Window>(from);
      Floats<n> here = taken(window, at);
      Floats<n> next = taken(window, at + 1);
      if (plane1 != plane0) {
        window = load_as<Window>(from + nodes.stride);
        here = select(plane == plane1, taken(window, at), here);
        next = select(plane == plane1, taken(window, at + 1), next);
      }
      return here + past * (next - here);
    };
    return {windowed(first), windowed(second)};
  }
#else
  [[gnu::always_inline]] std::array<Floats<n>, 2> of(const float* first, const float* second) const {
    return {anywhere(first), anywhere(second)};
  }
#endif
};

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
template <int n>
OBLIQ_INLINE Floats<n> sine_step(Floats<n> slope0, Floats<n> root0, Floats<n> slope1, Floats<n> root1) {
  const Floats<n> roots = root0 * root1;
  return (slope1 - slope0) * (root0 + root1) / (roots * (roots + 1.0F + slope0 * slope1));
}
template <int n>
OBLIQ_INLINE Floats<n> root_of(Floats<n> slope) {
  return sqrt(1.0F + slope * slope);
}

/// A wall's share of the sub-columns, and where it stands in them, in the middle of the share.
template <int n>
struct WallShare {
  int edge;
  Floats<n> cover, distance, spread;
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
template <int n>
OBLIQ_INLINE void add_echoes(const SubColumns& columns, Where<n> which, int edge, Floats<n> solid,
                             Floats<n> tangent, Floats<n> r0, Floats<n> r1, PartEchoes& out) {
  const float bins_per_m = 1 / columns.range_spacing_m;
  const auto n_range = static_cast<float>(columns.n_range);
  const Floats<n> from = (min(r0, r1) - columns.r_min_m) * bins_per_m;
  const Floats<n> to = (max(r0, r1) - columns.r_min_m) * bins_per_m;
  const float nearest = least_of(select(which, from, in_all<n>(1e30F)));
  const float farthest = greatest_of(select(which, to, in_all<n>(-1e30F)));
  if (!(farthest >= 0) || !(nearest < n_range)) return;
  const Floats<n> light = select(which, solid, Floats<n>{});
  const float middle_m = columns.r_min_m + 0.5F * (nearest + farthest) * columns.range_spacing_m;
  const int first = static_cast<int>(nearest < 0 ? 0 : nearest);
  const int last = farthest >= n_range ? columns.n_range - 1 : static_cast<int>(farthest);
  if (first == last && nearest >= 0 && farthest < n_range) {
    if (out.n < PartEchoes::kMost)
      out.echo[out.n++] = {first, edge, sum_of(light), middle_m, middle_m, sum_of(light * tangent)};
    return;
  }
  const Floats<n> length = max(to - from, in_all<n>(1e-3F));
  const Floats<n> a_bin = light / length;
  for (int bin = first; bin <= last && out.n < PartEchoes::kMost; ++bin) {
    const auto edge0 = static_cast<float>(bin);
    const auto edge1 = static_cast<float>(bin + 1);
    const Floats<n> part =
        max(min(from + length, in_all<n>(edge1)) - max(from, in_all<n>(edge0)), Floats<n>{}) * a_bin;
    const float sum = sum_of(part);
    const float both = max(nearest, edge0) + min(farthest, edge1);
    if (sum > 0)
      out.echo[out.n++] = {bin,      edge,
                           sum,      columns.r_min_m + 0.5F * both * columns.range_spacing_m,
                           middle_m, sum_of(part * tangent)};
  }
}

/// Adds up term(0) to term(n - 1) in the order of sum_of().
template <int n, int first = 0, int step = 1, typename Term>
OBLIQ_INLINE auto sum_of_terms(const Term& term) {
  if constexpr (step == n)
    return term(first);
  else
    return sum_of_terms<n, first, 2 * step>(term) + sum_of_terms<n, first + step, 2 * step>(term);
}

/// Takes what each sub-column hides, slopes `from` to `to` of its plane's ground from node k on, off the
/// nodes: a register of nodes at a time, one sub-column after the other.
template <int n>
OBLIQ_INLINE void hide_ground(const SubColumns& columns, Where<n> which, Numbers<n> plane, Numbers<n> k,
                              Floats<n> cover, Floats<n> from, Floats<n> to) {
  constexpr int kNodes = OBLIQ_ISA::kRegisterBytes / static_cast<int>(sizeof(float));
  using Nodes = Floats<kNodes>;
  const NodeProfiles& nodes = columns.nodes;
  const float until = greatest_of(select(which, to, in_all<n>(kLowest)));
  // Planes rise with the lanes.
  const unsigned lanes = movemask(which);
  const int first_plane = plane[__builtin_ctz(lanes)];
  const int last_plane = plane[31 - __builtin_clz(lanes)];
  const auto node = static_cast<int>(least_of(select(which, floats_of(k), in_all<n>(1e9F))));
  float from_of[n], to_of[n], share_of[n];
  to_memory(from_of, from);
  to_memory(to_of, to);
  for (int p = first_plane; p <= last_plane; ++p) {
    const float* const horizon = nodes.horizon + static_cast<std::ptrdiff_t>(p) * nodes.stride;
    float* const hidden = nodes.hidden + static_cast<std::ptrdiff_t>(p) * nodes.stride;
    to_memory(share_of, select(which & (plane == p), cover * columns.per_plane[p], Floats<n>{}));
    // Behind the node where nothing is hidden any more, and behind the last one, nothing counts.
    for (int at = node; at + 1 < nodes.n_nodes && horizon[at] < until; at += kNodes) {
      const auto here = load_as<Nodes>(horizon + at);
      const auto next = load_as<Nodes>(horizon + at + 1);
      const auto hides = [&](int lane) __attribute__((always_inline)) {
        return max(min(next, in_all<kNodes>(to_of[lane])) - max(here, in_all<kNodes>(from_of[lane])),
                   Nodes{}) *
               share_of[lane];
      };
      to_memory(hidden + at, load_as<Nodes>(hidden + at) + sum_of_terms<n>(hides));
    }
  }
}

template <int n>
OBLIQ_INLINE void see_in(const SubColumns& columns, const ConvexShape& shape, int first, PartEchoes& out) {
  const Numbers<n> number = lane_numbers<std::int32_t, n>() + first;
  const Floats<n> left = columns.left + floats_of(number) * columns.width;
  const Floats<n> right = columns.left + floats_of(number + 1) * columns.width;
  const Floats<n> tangent = (left + right) * 0.5F;
  const Floats<n> secant = 1.0F + 0.5F * tangent * tangent;  // up to a degree: 1e-8 off
  const float per_width = 1 / columns.width;

  WallShare<n> walls[ConvexShape::kMost];
  int n_walls = 0;
  Floats<n> near_sum{}, near_cover{}, far_sum{}, far_cover{};
  const Edges edges(shape);
  for (int e = 0; e < shape.n; ++e) {
    const Floats<n> from = max(in_all<n>(edges.from[e]), left);
    const Floats<n> to = min(in_all<n>(edges.to[e]), right);
    const Floats<n> cover = max((to - from) * per_width, Floats<n>{});
    const Where<n> in = cover > 0.0F;
    if (!any(in)) continue;
    // On the edge 1 / distance is linear in the tangent.
    const float cross = edges.cross[e];
    const Floats<n> nearest = in_all<n>(edges.nearest_m[e]);
    const Floats<n> farthest = in_all<n>(edges.farthest_m[e]);
    const Floats<n> ahead =
        clamp(cross / (edges.right_m[e] - (from + to) * edges.half_ahead_m[e]), nearest, farthest);
    const Floats<n> distance = select(in, ahead * secant, nearest);
    if (cross > 0) {
      near_sum += cover * distance;
      near_cover += cover;
      if ((shape.walls >> e & 1) == 0) continue;
      const Floats<n> spread = max(ahead * ahead * edges.bend[e] * (to - from), Floats<n>{});
      walls[n_walls++] = {e, cover, distance, min(spread, farthest - nearest) * 0.5F};
    } else {
      far_sum += cover * distance;
      far_cover += cover;
    }
  }
  const Where<n> on = (near_cover > kLeastShare) & (far_cover > kLeastShare);
  if (!any(on)) return;
  const Floats<n> one = in_all<n>(1.0F);
  const Floats<n> cover = min(near_cover, one);
  const Floats<n> near = select(on, near_sum / near_cover, in_all<n>(shape.ahead_m[0]));
  const Floats<n> far = max(near, select(on, far_sum / far_cover, near));

  // What stands in front: the ground where the wall stands, as deep below its plane's horizon as there, and
  // buildings.
  const NodeProfiles& nodes = columns.nodes;
  const Floats<n> along = near / secant;
  const GroundOfBin& g = columns.ground;
  const auto [foot_m, known] = heights_at(g, g.start_u + along * (g.forward_u + tangent * g.right_u),
                                          g.start_v + along * (g.forward_v + tangent * g.right_v));
  const Floats<n> node = near * (1 / nodes.node_m);
  const Numbers<n> k = truncated(clamp(node, Floats<n>{}, in_all<n>(static_cast<float>(nodes.n_nodes - 2))));
  const Floats<n> past = min(node - floats_of(k), one);
  const Numbers<n> plane = (number * nodes.planes) >> columns.log2_n;
  const auto [horizon, clearance] = BetweenNodes<n>{nodes, plane, k, past}.of(nodes.horizon, nodes.clearance);
  const Floats<n> over_near = 1.0F / near;
  const Floats<n> foot =
      select(known, foot_m * over_near + clearance, max(shape.base_m * over_near, horizon));
  const Floats<n> roofs = load_as<Floats<n>>(columns.roofs + first);
  const Floats<n> low = max(foot, roofs);
  const Floats<n> top = shape.roof_m * over_near;
  const Floats<n> back = shape.roof_m / far;
  const Floats<n> highest = max(top, back);
  const Floats<n> roof_from = max(low, top);
  const Where<n> roof_seen = on & (back > roof_from);
  const Where<n> rises = on & (highest > low);
  if (!any(rises)) return;

  const Floats<n> foot_height = foot * near;
  for (int w = 0; w < n_walls; ++w) {
    const WallShare<n>& wall = walls[w];
    const Floats<n> over = 1.0F / wall.distance;
    const Floats<n> from = max(foot_height * over, roofs);
    const Floats<n> to = shape.roof_m * over;
    const Where<n> seen = on & (to > from) & (wall.cover > 0.0F);
    if (!any(seen)) continue;
    const Floats<n> root0 = root_of(from);
    const Floats<n> root1 = root_of(to);
    const Floats<n> r0 = wall.distance * root0;
    const Floats<n> r1 = wall.distance * root1;
    add_echoes(columns, seen, wall.edge, wall.cover * columns.width_rad * sine_step(from, root0, to, root1),
               tangent, min(r0, r1) - wall.spread, max(r0, r1) + wall.spread, out);
  }
  if (any(roof_seen)) {
    const Floats<n> root0 = root_of(roof_from);
    const Floats<n> root1 = root_of(back);
    const Floats<n> from_m = shape.roof_m / roof_from;
    add_echoes(columns, roof_seen, PartEchoes::kRoof,
               cover * columns.width_rad * sine_step(roof_from, root0, back, root1), tangent, from_m * root0,
               far * root1, out);
  }
  // It hides its plane's ground as if it stood there as it stands on its own.
  const Floats<n> shift = horizon - foot;
  hide_ground(columns, rises, plane, k, cover, low + shift, highest + shift);
  to_memory(columns.roofs + first, select(on & (cover >= 0.5F), max(roofs, highest), roofs));
}

}  // namespace

void see_part(const SubColumns& columns, const ConvexShape& shape, int first, int count, PartEchoes& out) {
  if (count > kFloatLanes / 2)
    see_in<kFloatLanes>(columns, shape, first, out);
  else
    see_in<kFloatLanes / 2>(columns, shape, first, out);
}

}  // namespace obliq::OBLIQ_ISA
