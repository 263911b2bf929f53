#include "terrain/buildings/ring_crossings.h"

#include <algorithm>

namespace obliq {
namespace {

struct Edge {
  glm::dvec2 a, b;  ///< a.x <= b.x
  std::size_t from, to;
};

/// Sign of the turn a -> b -> c.
int side(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  const double turn = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  return turn > 0 ? 1 : turn < 0 ? -1 : 0;
}

bool meet(const Edge& e, const Edge& f) {
  const auto apart = [](double a, double b, double c, double d) {
    return std::max(a, b) < std::min(c, d) || std::max(c, d) < std::min(a, b);
  };
  if (apart(e.a.x, e.b.x, f.a.x, f.b.x) || apart(e.a.y, e.b.y, f.a.y, f.b.y)) return false;
  return side(e.a, e.b, f.a) * side(e.a, e.b, f.b) <= 0 && side(f.a, f.b, e.a) * side(f.a, f.b, e.b) <= 0;
}

}  // namespace

std::size_t count_crossings(const FloatRings& rings, std::size_t most) {
  std::vector<Edge> edges;
  for (const FloatRing& ring : rings) {
    const std::size_t first = edges.size();
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const std::size_t next = (k + 1) % ring.size();
      Edge edge{glm::dvec2(ring[k]), glm::dvec2(ring[next]), first + k, first + next};
      if (edge.a.x > edge.b.x) std::swap(edge.a, edge.b);
      edges.push_back(edge);
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& e, const Edge& f) { return e.a.x < f.a.x; });
  std::size_t found = 0;
  for (std::size_t n = 0; n < edges.size(); ++n) {
    for (std::size_t m = n + 1; m < edges.size() && edges[m].a.x <= edges[n].b.x; ++m) {
      if (edges[n].to == edges[m].from || edges[m].to == edges[n].from) continue;
      if (meet(edges[n], edges[m]) && ++found >= most) return found;
    }
  }
  return found;
}

}  // namespace obliq
