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

}  // namespace obliq
