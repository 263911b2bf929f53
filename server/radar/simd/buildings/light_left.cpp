// From nodes to range bins: what buildings leave of the light of a plane's ground.
#include "server/radar/simd/buildings/light_left.h"

#include "server/radar/simd/lanes/float_lanes.h"

namespace obliq::OBLIQ_ISA {
namespace {

/// A share below this is a sliver beside a building, no gap between two.
constexpr double kLeastLeft = 1.0 / 64;

/// Behind every swath, in range bins: where no ground is known, nodes lie farther off still.
constexpr float kFarBehind = 1e6F;

/// In the upper half of each `2 half` lanes the last of the lower half, elsewhere 0. Of one register.
template <int half, int n>
OBLIQ_INLINE Floats<n> last_of_lower_half(Floats<n> x) {
  const Floats<n> none{};
  return [&]<int... k>(std::integer_sequence<int, k...>) __attribute__((always_inline)) {
    return Floats<n>{__builtin_shufflevector(
        x.v, none.v, (k % (2 * half) < half ? n : k / (2 * half) * (2 * half) + half - 1)...)};
  }
  (std::make_integer_sequence<int, n>());
}

/// The sum of a lane and all before it, in one order whatever a register holds.
template <int n>
OBLIQ_INLINE Floats<n> sums_so_far(Floats<n> x) {
  if constexpr (!is_one<float, n>(nullptr)) {
    const auto low = sums_so_far(x.low);
    return {low, sums_so_far(x.high) + low[n / 2 - 1]};
  } else {
    x += last_of_lower_half<1>(x);
    x += last_of_lower_half<2>(x);
    if constexpr (n > 4) x += last_of_lower_half<4>(x);
    if constexpr (n > 8) x += last_of_lower_half<8>(x);
    return x;
  }
}

/// The first whole number that is not below x, 0 or above.
OBLIQ_INLINE i32x16 ceiling(f32x16 x) {
  const i32x16 whole = truncated(x);
  return truncated(select(floats_of(whole) < x, floats_of(whole) + 1.0F, floats_of(whole)));
}

/// One plane's profile, node by node, from the antenna outwards.
struct Nodes {
  const float* horizon;
  const float* light;
  const float* range_bin;
  const float* hidden;
  int n;

  Nodes(const NodeProfiles& all, int plane) : n(all.n_nodes) {
    const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(plane) * all.stride;
    horizon = all.horizon + first;
    light = all.sine == nullptr ? horizon : all.sine + first;
    range_bin = all.range_bin + first;
    hidden = all.hidden + first;
  }

  /// A bit for each of sixteen from k on that has a next one.
  unsigned with_next(int k) const {
    return n - 1 - k >= kFloatLanes ? 0xffffU : (1U << max(0, n - 1 - k)) - 1;
  }
  /// Bits of those from which something is hidden.
  unsigned hiding(int k) const {
    return movemask((load_floats(hidden + k) > 0.0F) & (load_floats(range_bin + k) < kFarBehind)) &
           with_next(k);
  }
  int first_hiding() const {
    for (int k = 0; k < n - 1; k += kFloatLanes)
      if (const unsigned some = hiding(k); some != 0) return k + __builtin_ctz(some);
    return n;
  }
  int last_hiding() const {
    for (int k = (n - 2) / kFloatLanes * kFloatLanes; k >= 0; k -= kFloatLanes)
      if (const unsigned some = hiding(k); some != 0) return k + 31 - __builtin_clz(some);
    return -1;
  }
};

/// What is visible and hidden up to the edges of range bins, which lie between nodes. Both grow evenly from
/// node to node. Where ground lies over nearer ground an edge is where it is first passed.
class BinEdges {
 public:
  /// from: the first whose bin is looked at, by nodes from `node` on, which shows all before it.
  BinEdges(const Nodes& nodes, int n_range, int from, int node, LightLeft& out)
      : nodes_(nodes), n_range_(n_range), node_(node), from_(from), next_edge_(from), out_(out) {
    put(from, static_cast<double>(nodes.light[node]), 0);
  }

  /// Goes on with sixteen nodes. False: no edge that is new lies behind one of them.
  bool take(int k) {
    const f32x16 end = all_lanes(static_cast<float>(n_range_ + 1));
    Block block;
    block.here = load_floats(nodes_.range_bin + k);
    const f32x16 next = load_floats(nodes_.range_bin + k + 1);
    block.length = next - block.here;
    block.light = load_floats(nodes_.light + k);
    block.grows = load_floats(nodes_.light + k + 1) - block.light;
    const unsigned behind = node_ > k ? ~((1U << min(node_ - k, 31)) - 1) : ~0U;
    const unsigned with_next = nodes_.with_next(k) & behind;
    block.hides = select(mask16_from(with_next), load_floats(nodes_.hidden + k), f32x16{});
    if (nodes_.light != nodes_.horizon) {
      const f32x16 rise = load_floats(nodes_.horizon + k + 1) - load_floats(nodes_.horizon + k);
      block.hides = select(rise > 0.0F, block.hides * (block.grows / rise), f32x16{});
    }
    block.hidden = sums_so_far(block.hides);
    block.first = ceiling(min(max(block.here, f32x16{}), end));
    block.last = ceiling(min(max(next, f32x16{}), end));
    const int before = next_edge_;
    const unsigned crossed = movemask(block.last > block.first) & with_next;
    const unsigned askew = movemask((block.last > block.first + 1) | (block.first > block.last)) & with_next;
    if (crossed != 0 && askew == 0 && block.first[__builtin_ctz(crossed)] == before)
      put_each(block, crossed);
    else if ((movemask(block.last > before) & with_next) != 0)
      put_all(block, with_next);
    hidden_ += static_cast<double>(block.hidden[kFloatLanes - 1]);
    return next_edge_ > before;
  }

  /// Behind the last node nothing grows.
  void put_last() {
    next_edge_ = max(next_edge_, from_ + 1);
    put(next_edge_++, static_cast<double>(nodes_.light[nodes_.n - 1]), hidden_);
  }
  /// Behind the last edge that is known.
  int next_edge() const { return next_edge_; }

 private:
  struct Block {
    f32x16 here, length;
    f32x16 light, grows;
    f32x16 hidden, hides;  // up to the next node, and of that from this one
    i32x16 first, last;    // edge behind the node, and behind the next
  };

  void put(int edge, double visible, double hidden) {
    out_.visible[edge] = visible;
    out_.hidden[edge] = hidden;
  }

  /// One edge behind each node that is marked, as where bins are longer than nodes lie apart.
  void put_each(const Block& block, unsigned marked) {
    const f32x16 part = (floats_of(block.first) - block.here) / block.length;
    const f32x16 grown = part * block.grows;
    const f32x16 hidden = block.hidden + (part - 1.0F) * block.hides;
    int edge = block.first[__builtin_ctz(marked)];
    const auto put_half = [&](auto light, auto more, auto hides, unsigned bits)
        __attribute__((always_inline)) {
      store(out_.visible + edge, compress(bits, converted<double>(light) + converted<double>(more)));
      store(out_.hidden + edge, compress(bits, hidden_ + converted<double>(hides)));
      edge += __builtin_popcount(bits);
    };
    put_half(low_half(block.light), low_half(grown), low_half(hidden), marked & 0xff);
    put_half(high_half(block.light), high_half(grown), high_half(hidden), marked >> 8);
    next_edge_ = edge;
  }

  /// Any edges behind each node with a next one that lies beyond them.
  void put_all(const Block& block, unsigned with_next) {
    for (; with_next != 0; with_next &= with_next - 1) {
      const int k = __builtin_ctz(with_next);
      for (; next_edge_ < block.last[k]; ++next_edge_) {
        const float past = static_cast<float>(next_edge_) - block.here[k];
        const float part = past > 0 ? past / block.length[k] : 0;
        put(next_edge_, static_cast<double>(block.light[k]) + static_cast<double>(part * block.grows[k]),
            hidden_ + static_cast<double>(block.hidden[k] + (part - 1.0F) * block.hides[k]));
      }
    }
  }

  const Nodes nodes_;
  int n_range_;
  int node_, from_;
  int next_edge_;
  LightLeft& out_;
  double hidden_ = 0;  // up to the block
};

}  // namespace

void light_left(const NodeProfiles& all, int plane, int n_range, LightLeft& out) {
  const Nodes nodes(all, plane);
  out.from = out.to = 0;
  int k = nodes.first_hiding();
  if (k == nodes.n) return;
  const float first = min(nodes.range_bin[k], kFarBehind);
  const int from = max(0, static_cast<int>(__builtin_floorf(first)));
  if (from >= n_range) return;
  // Back to the node before that bin, if ground is known there.
  while (k > 0 && nodes.range_bin[k] > static_cast<float>(from) && nodes.range_bin[k - 1] < kFarBehind) --k;
  BinEdges edges(nodes, n_range, from, k, out);
  const int last = nodes.last_hiding();
  k = k / kFloatLanes * kFloatLanes;
  for (bool ends = false; !ends && k + 1 < nodes.n && edges.next_edge() <= n_range; k += kFloatLanes)
    ends = edges.take(k) && k > last;
  if (k + 1 >= nodes.n) edges.put_last();
  out.from = from;
  out.to = max(from, min(n_range, edges.next_edge() - 1));
  for (int bin = from; bin < out.to; bin += kLanes) {
    const f64x8 hidden = load(out.hidden + bin + 1) - load(out.hidden + bin);
    const f64x8 visible = load(out.visible + bin + 1) - load(out.visible + bin);
    const f64x8 share = 1.0 - hidden / visible;
    const f64x8 left = select(share >= kLeastLeft, min(share, broadcast(1)), f64x8{});
    to_memory(out.left + bin, converted<float>(select((hidden > 0.0) & (visible > 0.0), left, broadcast(1))));
  }
}

}  // namespace obliq::OBLIQ_ISA
