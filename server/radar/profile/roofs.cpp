#include "server/radar/profile/roofs.h"

#include <algorithm>
#include <cmath>
#include <glm/vec2.hpp>

namespace obliq {

std::optional<double> roof_above(const Buildings& buildings, const glm::dvec3& point_m) {
  std::optional<double> highest;
  std::vector<RoofSpan> spans;
  for (std::uint32_t b = 0; b < buildings.list.size(); ++b) {
    const Building& building = buildings.list[b];
    const double roof = static_cast<double>(building.roof_y_m);
    if (point_m.y > roof || point_m.y < static_cast<double>(building.base_y_m)) continue;
    spans.clear();
    // A half-line due north: the point is inside when the first stretch begins at it.
    add_roof_spans(buildings, b, point_m.x, point_m.z, 0, 1, spans);
    const bool inside =
        std::any_of(spans.begin(), spans.end(), [](const RoofSpan& span) { return span.near_m == 0; });
    if (inside && (!highest || roof > *highest)) highest = roof;
  }
  return highest;
}

namespace {

/// The ends of a wall on a map, from a point.
struct WallEnds {
  glm::dvec2 a, b;
  glm::dvec2 along;
  double length2;

  WallEnds(const Buildings& all, std::uint32_t building, std::uint32_t wall, double x_m, double z_m) {
    const WallEdge edge = edge_of_wall(all, building, wall);
    const glm::dvec2 from(x_m, z_m);
    a = glm::dvec2(all.ring_xz_m[edge.from]) - from;
    b = glm::dvec2(all.ring_xz_m[edge.to]) - from;
    along = b - a;
    length2 = along.x * along.x + along.y * along.y;
  }
  WallLine line() const {
    const double length = std::sqrt(length2);
    // The solid lies on the left of a -> b on a map, so (dz, -dx) points out of it.
    return {(a.y * along.x - a.x * along.y) / length, along.y / length, -along.x / length};
  }
};

}  // namespace

WallLine wall_line(const Buildings& all, std::uint32_t building, std::uint32_t wall, double x_m, double z_m) {
  const WallEnds ends(all, building, wall, x_m, z_m);
  return ends.length2 > 0 ? ends.line() : WallLine{};
}

WallPlane wall_plane(const Buildings& all, std::uint32_t building, std::uint32_t wall, double x_m,
                     double z_m) {
  const WallEnds ends(all, building, wall, x_m, z_m);
  if (!(ends.length2 > 0)) return {};
  const auto& [a, b, along, length2] = ends;
  const WallLine line = ends.line();
  const double to_a = std::sqrt(a.x * a.x + a.y * a.y);
  const double to_b = std::sqrt(b.x * b.x + b.y * b.y);
  const double foot = -(a.x * along.x + a.y * along.y);
  return {line, std::min({foot > 0 && foot < length2 ? std::abs(line.distance_m) : to_a, to_a, to_b}),
          std::max(to_a, to_b)};
}

void add_roof_spans(const Buildings& buildings, std::uint32_t building_index, double x_m, double z_m,
                    double sin_bearing, double cos_bearing, std::vector<RoofSpan>& spans) {
  const Building& building = buildings.list[building_index];
  // Crossings of the whole line with the rings' edges, an edge counted when its ends lie on different sides
  // (exactly on the line counts as right of it), so that the number of crossings is always even.
  struct Crossing {
    double distance_m;
    std::uint32_t wall;
  };
  Crossing crossings[64];
  std::vector<Crossing> many;
  std::size_t n = 0;
  const auto add = [&](double distance, std::uint32_t wall) {
    if (n < 64) {
      crossings[n++] = {distance, wall};
    } else {
      if (many.empty()) many.assign(crossings, crossings + 64);
      many.push_back({distance, wall});
      ++n;
    }
  };
  std::uint32_t wall = building.first_face + 1;  // the roof comes first
  for (std::uint32_t ring = building.first_ring; ring < building.first_ring + building.n_rings; ++ring) {
    const std::uint32_t begin = buildings.ring_start[ring];
    const std::uint32_t end = buildings.ring_start[ring + 1];
    if (end == begin) continue;
    double ax = static_cast<double>(buildings.ring_xz_m[end - 1].x) - x_m;
    double az = static_cast<double>(buildings.ring_xz_m[end - 1].y) - z_m;
    double a_side = ax * cos_bearing - az * sin_bearing;
    for (std::uint32_t k = begin; k < end; ++k) {
      const double bx = static_cast<double>(buildings.ring_xz_m[k].x) - x_m;
      const double bz = static_cast<double>(buildings.ring_xz_m[k].y) - z_m;
      const double b_side = bx * cos_bearing - bz * sin_bearing;
      if ((a_side >= 0) != (b_side >= 0)) {
        const double a_along = ax * sin_bearing + az * cos_bearing;
        const double b_along = bx * sin_bearing + bz * cos_bearing;
        // Edge k - 1 -> k; the first round of the loop is the ring's last edge.
        const std::uint32_t edge = k == begin ? end - begin - 1 : k - begin - 1;
        add(a_along + (b_along - a_along) * (a_side / (a_side - b_side)), wall + edge);
      }
      ax = bx;
      az = bz;
      a_side = b_side;
    }
    wall += end - begin;
  }
  Crossing* const first = many.empty() ? crossings : many.data();
  std::sort(first, first + n, [](const Crossing& a, const Crossing& b) {
    return a.distance_m != b.distance_m ? a.distance_m < b.distance_m : a.wall < b.wall;
  });
  for (std::size_t k = 0; k + 1 < n; k += 2) {
    if (first[k + 1].distance_m <= 0) continue;
    spans.push_back({std::max(0.0, first[k].distance_m), first[k + 1].distance_m,
                     static_cast<double>(building.roof_y_m), building_index,
                     first[k].distance_m > 0 ? first[k].wall : kNoFace});
  }
}

std::vector<RoofSpan> disjoint_roofs(std::vector<RoofSpan>& spans) {
  std::sort(spans.begin(), spans.end(), [](const RoofSpan& p, const RoofSpan& q) {
    return p.near_m != q.near_m ? p.near_m < q.near_m : p.building < q.building;
  });
  bool overlap = false;
  for (std::size_t k = 0; k + 1 < spans.size(); ++k)
    overlap = overlap || spans[k].far_m > spans[k + 1].near_m;
  if (!overlap) return spans;
  std::vector<double> edges;
  for (const RoofSpan& span : spans) {
    edges.push_back(span.near_m);
    edges.push_back(span.far_m);
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  std::vector<RoofSpan> disjoint;
  std::vector<RoofSpan> active;
  std::size_t next = 0;
  for (std::size_t e = 0; e + 1 < edges.size(); ++e) {
    while (next < spans.size() && spans[next].near_m <= edges[e]) active.push_back(spans[next++]);
    std::erase_if(active, [&](const RoofSpan& span) { return span.far_m <= edges[e]; });
    if (active.empty()) continue;
    RoofSpan top = *std::max_element(active.begin(), active.end(), [](const RoofSpan& p, const RoofSpan& q) {
      return p.roof_y_m < q.roof_y_m;
    });
    // Its own wall stands only where it begins; further on the roof comes out from under a higher one.
    if (top.near_m < edges[e]) top.wall = kNoFace;
    top.near_m = edges[e];
    top.far_m = edges[e + 1];
    disjoint.push_back(top);
  }
  return disjoint;
}

}  // namespace obliq
