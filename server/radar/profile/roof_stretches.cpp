#include <algorithm>
#include <cmath>

#include "server/radar/profile/local_surface.h"

namespace obliq {
namespace {

/// Where the plane's line crosses an edge of a footprint.
struct Crossing {
  double at_m;
  std::uint32_t face;
  double normal_along;
};

}  // namespace

void add_roof_stretches(const Buildings& buildings, std::uint32_t building, double x_m, double z_m,
                        double sin_bearing, double cos_bearing, std::vector<RoofStretch>& stretches) {
  const Building& b = buildings.list[building];
  std::vector<Crossing> crossings;
  for (std::uint32_t ring = b.first_ring; ring < b.first_ring + b.n_rings; ++ring) {
    const std::uint32_t begin = buildings.ring_start[ring];
    const std::uint32_t end = buildings.ring_start[ring + 1];
    if (end == begin) continue;
    std::uint32_t a = end - 1;
    double ax = static_cast<double>(buildings.ring_xz_m[a].x) - x_m;
    double az = static_cast<double>(buildings.ring_xz_m[a].y) - z_m;
    double a_side = ax * cos_bearing - az * sin_bearing;
    for (std::uint32_t k = begin; k < end; a = k++) {
      const double bx = static_cast<double>(buildings.ring_xz_m[k].x) - x_m;
      const double bz = static_cast<double>(buildings.ring_xz_m[k].y) - z_m;
      const double b_side = bx * cos_bearing - bz * sin_bearing;
      // An edge counts when its ends lie on different sides (exactly on the line counts as right of it), so
      // that the number of crossings is always even.
      if ((a_side >= 0) != (b_side >= 0)) {
        const double a_along = ax * sin_bearing + az * cos_bearing;
        const double b_along = bx * sin_bearing + bz * cos_bearing;
        // Walls stand in ring order behind the roof in the list of faces. Across the edge, the component
        // along the plane of its unit normal is the edge's own side component.
        crossings.push_back({a_along + (b_along - a_along) * (a_side / (a_side - b_side)),
                             b.first_face + 1 + (a - buildings.ring_start[b.first_ring]),
                             std::abs(b_side - a_side) / std::hypot(bx - ax, bz - az)});
      }
      ax = bx;
      az = bz;
      a_side = b_side;
    }
  }
  std::sort(crossings.begin(), crossings.end(), [](const Crossing& p, const Crossing& q) {
    return p.at_m != q.at_m ? p.at_m < q.at_m : p.face < q.face;
  });
  for (std::size_t k = 0; k + 1 < crossings.size(); k += 2) {
    if (crossings[k + 1].at_m <= 0) continue;
    RoofStretch stretch;
    stretch.near_m = std::max(0.0, crossings[k].at_m);
    stretch.far_m = crossings[k + 1].at_m;
    stretch.roof_y_m = static_cast<double>(b.roof_y_m);
    stretch.building = building;
    stretch.near_wall = crossings[k].at_m > 0 ? crossings[k].face : kNoFace;
    stretch.wall_normal_along = -crossings[k].normal_along;
    stretches.push_back(stretch);
  }
}

void make_disjoint(std::vector<RoofStretch>& stretches) {
  std::sort(stretches.begin(), stretches.end(), [](const RoofStretch& p, const RoofStretch& q) {
    return p.near_m != q.near_m ? p.near_m < q.near_m : p.building < q.building;
  });
  bool overlap = false;
  for (std::size_t k = 0; k + 1 < stretches.size(); ++k)
    overlap = overlap || stretches[k].far_m > stretches[k + 1].near_m;
  if (!overlap) return;
  std::vector<double> edges;
  for (const RoofStretch& stretch : stretches) {
    edges.push_back(stretch.near_m);
    edges.push_back(stretch.far_m);
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  std::vector<RoofStretch> disjoint;
  std::vector<RoofStretch> active;
  std::size_t next = 0;
  for (std::size_t e = 0; e + 1 < edges.size(); ++e) {
    while (next < stretches.size() && stretches[next].near_m <= edges[e]) active.push_back(stretches[next++]);
    std::erase_if(active, [&](const RoofStretch& stretch) { return stretch.far_m <= edges[e]; });
    if (active.empty()) continue;
    RoofStretch top =
        *std::max_element(active.begin(), active.end(),
                          [](const RoofStretch& p, const RoofStretch& q) { return p.roof_y_m < q.roof_y_m; });
    // Its own wall stands only where it begins; further on the roof comes out from under a higher one.
    if (top.near_m < edges[e]) top.near_wall = kNoFace;
    top.near_m = edges[e];
    top.far_m = edges[e + 1];
    disjoint.push_back(top);
  }
  stretches = std::move(disjoint);
}

}  // namespace obliq
