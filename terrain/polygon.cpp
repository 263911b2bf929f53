#include "terrain/polygon.h"

#include <algorithm>

namespace obliq {

void Rect::include(glm::dvec2 p) {
  if (empty()) {
    *this = {p.x, p.y, p.x, p.y};
    return;
  }
  x0_m = std::min(x0_m, p.x);
  x1_m = std::max(x1_m, p.x);
  z0_m = std::min(z0_m, p.y);
  z1_m = std::max(z1_m, p.y);
}

Rect Rect::intersection(const Rect& other) const {
  return {std::max(x0_m, other.x0_m), std::max(z0_m, other.z0_m), std::min(x1_m, other.x1_m),
          std::min(z1_m, other.z1_m)};
}

bool Polygon::contains(glm::dvec2 p) const {
  bool inside = false;
  for (const Ring& ring : rings) {
    for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
      const glm::dvec2 a = ring[i];
      const glm::dvec2 b = ring[j];
      if ((a.y <= p.y) == (b.y <= p.y)) continue;
      if (a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x) <= p.x) inside = !inside;
    }
  }
  return inside;
}

Rect bounds(const Polygon& polygon) {
  Rect rect;
  for (const Ring& ring : polygon.rings) {
    for (glm::dvec2 p : ring) rect.include(p);
  }
  return rect;
}

double signed_area_m2(const Ring& ring) {
  double twice = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    // Relative to the first vertex, so that large coordinates do not cancel.
    const glm::dvec2 a = ring[i] - ring[0];
    const glm::dvec2 b = ring[(i + 1) % ring.size()] - ring[0];
    twice += a.x * b.y - b.x * a.y;
  }
  return twice / 2;
}

void crossings(const Polygon& polygon, double z_m, std::vector<double>& x_m) {
  x_m.clear();
  for (const Ring& ring : polygon.rings) {
    for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
      const glm::dvec2 a = ring[i];
      const glm::dvec2 b = ring[j];
      if ((a.y <= z_m) == (b.y <= z_m)) continue;
      x_m.push_back(a.x + (z_m - a.y) / (b.y - a.y) * (b.x - a.x));
    }
  }
  std::sort(x_m.begin(), x_m.end());
}

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
