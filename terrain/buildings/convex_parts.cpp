#include "terrain/buildings/convex_parts.h"

#include <algorithm>
#include <utility>

namespace obliq {
namespace {

bool turns_left(glm::vec2 a, glm::vec2 b, glm::vec2 c) {
  const glm::dvec2 u = glm::dvec2(b) - glm::dvec2(a);
  const glm::dvec2 v = glm::dvec2(c) - glm::dvec2(b);
  const double turn = u.x * v.y - u.y * v.x;
  return turn > 0 || (turn == 0 && u.x * v.x + u.y * v.y > 0);
}

bool is_one_part(const FloatRings& rings) {
  if (rings.size() != 1 || rings[0].size() > kMostPartCorners) return false;
  const FloatRing& ring = rings[0];
  // A valid ring turns around once, so that it is convex when it turns left everywhere.
  for (std::size_t k = 0, n = ring.size(); k < n; ++k)
    if (!turns_left(ring[k], ring[(k + 1) % n], ring[(k + 2) % n])) return false;
  return true;
}

/// Triangles, and then what is left of them when they are joined, as rings of linked edges.
class Joiner {
 public:
  Joiner(const FloatRings& rings, const std::vector<glm::uvec3>& roof) {
    for (const FloatRing& ring : rings) points_.insert(points_.end(), ring.begin(), ring.end());
    number_places();
    for (const glm::uvec3& t : roof) {
      const auto first = static_cast<std::uint32_t>(edges_.size());
      for (std::uint32_t k = 0; k < 3; ++k)
        edges_.push_back({t[k == 0 ? 0 : static_cast<int>(3 - k)], first + (k + 1) % 3, first + (k + 2) % 3});
    }
    find_twins(rings);
  }

  std::vector<PartRing> parts() {
    for (std::uint32_t e = 0; e < edges_.size(); ++e)
      if (edges_[e].twin != kNone && e < edges_[e].twin) join_along(e);
    std::vector<PartRing> parts;
    std::vector<bool> taken(edges_.size());
    for (std::uint32_t first = 0; first < edges_.size(); ++first) {
      if (taken[first] || edges_[first].gone) continue;
      PartRing& part = parts.emplace_back();
      for (std::uint32_t e = first; !taken[e]; e = edges_[e].next) {
        taken[e] = true;
        part.push_back({edges_[e].corner, edges_[e].wall});
      }
    }
    return parts;
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;
  struct Edge {
    std::uint32_t corner;
    std::uint32_t next, previous;
    std::uint32_t twin = kNone;  ///< the same edge of the neighbour, the other way round
    std::uint32_t wall = kNoFace;
    bool gone = false;
  };
  using KeyedEdge = std::pair<std::uint64_t, std::uint32_t>;

  /// Rings may touch: corners of different rings at one place get one number.
  void number_places() {
    std::vector<std::uint32_t> order(points_.size());
    for (std::uint32_t k = 0; k < order.size(); ++k) order[k] = k;
    const auto before = [&](std::uint32_t a, std::uint32_t b) {
      const glm::vec2 p = points_[a], q = points_[b];
      return p.x != q.x ? p.x < q.x : p.y < q.y;
    };
    std::sort(order.begin(), order.end(), before);
    place_.resize(points_.size());
    std::uint32_t place = 0;
    for (std::size_t k = 0; k < order.size(); ++k) {
      if (k > 0 && before(order[k - 1], order[k])) ++place;
      place_[order[k]] = place;
    }
  }

  std::uint64_t key(std::uint32_t from, std::uint32_t to) const {
    return std::uint64_t{place_[from]} << 32 | place_[to];
  }

  static std::uint32_t find(const std::vector<KeyedEdge>& sorted, std::uint64_t key) {
    const auto at = std::lower_bound(sorted.begin(), sorted.end(), KeyedEdge{key, 0});
    return at != sorted.end() && at->first == key ? at->second : kNone;
  }

  void find_twins(const FloatRings& rings) {
    std::vector<KeyedEdge> walls, inner;
    std::uint32_t first = 0;
    for (const FloatRing& ring : rings) {
      const auto n = static_cast<std::uint32_t>(ring.size());
      for (std::uint32_t k = 0; k < n; ++k)
        walls.emplace_back(key(first + k, first + (k + 1) % n), first + k);
      first += n;
    }
    std::sort(walls.begin(), walls.end());
    for (std::uint32_t e = 0; e < edges_.size(); ++e) {
      const std::uint64_t own = key(edges_[e].corner, edges_[edges_[e].next].corner);
      edges_[e].wall = find(walls, own);
      if (edges_[e].wall == kNoFace) inner.emplace_back(own, e);
    }
    std::sort(inner.begin(), inner.end());
    for (const auto& [own, e] : inner) edges_[e].twin = find(inner, own << 32 | own >> 32);
  }

  /// Whether the corner of `after`, between the edges `before` and `after`, turns left.
  bool convex(std::uint32_t before, std::uint32_t after) const {
    return turns_left(points_[edges_[before].corner], points_[edges_[after].corner],
                      points_[edges_[edges_[after].next].corner]);
  }

  /// Corners of the edge's ring; 0 when `other` is in the same ring.
  std::size_t corners(std::uint32_t edge, std::uint32_t other) const {
    std::size_t n = 1;
    for (std::uint32_t e = edges_[edge].next; e != edge; e = edges_[e].next, ++n)
      if (e == other) return 0;
    return n;
  }

  void join_along(std::uint32_t edge) {
    const std::uint32_t twin = edges_[edge].twin;
    Edge& a = edges_[edge];
    Edge& b = edges_[twin];
    if (!convex(a.previous, b.next) || !convex(b.previous, a.next)) return;
    const std::size_t n = corners(edge, twin);
    if (n == 0 || n + corners(twin, edge) - 2 > kMostPartCorners) return;
    link(a.previous, b.next);
    link(b.previous, a.next);
    a.gone = b.gone = true;
  }

  void link(std::uint32_t before, std::uint32_t after) {
    edges_[before].next = after;
    edges_[after].previous = before;
  }

  std::vector<glm::vec2> points_;
  std::vector<std::uint32_t> place_;
  std::vector<Edge> edges_;
};

}  // namespace

std::vector<PartRing> convex_parts(const FloatRings& rings, const std::vector<glm::uvec3>& roof) {
  if (is_one_part(rings)) return {};
  return Joiner(rings, roof).parts();
}

}  // namespace obliq
