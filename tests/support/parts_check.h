#pragma once
// Checks a building's convex parts against its footprint: in area, in shape, and wall by wall.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "terrain/buildings/buildings.h"
#include "terrain/polygon.h"

namespace obliq::test {

inline double doubled_area(const FloatRing& ring) {
  double doubled = 0;
  const glm::dvec2 from(ring[0]);
  for (std::size_t k = 1; k + 1 < ring.size(); ++k) {
    const glm::dvec2 a = glm::dvec2(ring[k]) - from, b = glm::dvec2(ring[k + 1]) - from;
    doubled += a.x * b.y - b.x * a.y;
  }
  return doubled;
}

/// Every corner of a convex ring lies to the left of every edge. Differences of far floats are exact, their
/// products to 2^-52.
inline void expect_convex(const FloatRing& ring, const std::string& where) {
  const std::size_t n = ring.size();
  for (std::size_t k = 0; k < n; ++k) {
    const glm::dvec2 a(ring[k]), along = glm::dvec2(ring[(k + 1) % n]) - a;
    const double length = std::hypot(along.x, along.y);
    ASSERT_GT(length, 0) << where;
    for (const glm::vec2 corner : ring) {
      const glm::dvec2 to = glm::dvec2(corner) - a;
      // Of a chain of almost straight corners each may be off by a rounding.
      ASSERT_GE(along.x * to.y - along.y * to.x, -1e-9 * length * (std::hypot(to.x, to.y) + 1)) << where;
    }
  }
}

/// What holds of each building's parts. Gives their number, 0 for a footprint that is its own part.
inline std::size_t expect_parts_make_up(const Buildings& all, std::uint32_t index, const std::string& where) {
  const Building& building = all.list[index];
  const auto ring = [&](std::uint32_t r) {
    return FloatRing(all.ring_xz_m.begin() + all.ring_start[r],
                     all.ring_xz_m.begin() + all.ring_start[r + 1]);
  };
  double footprint = 0;
  std::vector<std::pair<glm::vec2, glm::vec2>> walls;  // of the building, by face
  for (std::uint32_t r = building.first_ring; r < building.first_ring + building.n_rings; ++r) {
    const FloatRing corners = ring(r);
    footprint += doubled_area(corners);
    for (std::size_t k = 0; k < corners.size(); ++k)
      walls.emplace_back(corners[k], corners[(k + 1) % corners.size()]);
  }
  EXPECT_EQ(walls.size() + 1, building.n_faces);
  if (building.n_parts == 0) {
    EXPECT_EQ(building.n_rings, 1u) << where;
    EXPECT_LE(walls.size(), kMostPartCorners) << where;
    expect_convex(ring(building.first_ring), where);
    return 0;
  }
  double sum = 0;
  std::vector<int> times(walls.size());
  std::vector<std::pair<glm::vec2, glm::vec2>> inner;
  for (std::uint32_t p = building.first_part; p < building.first_part + building.n_parts; ++p) {
    const ConvexPart& part = all.parts[p];
    EXPECT_GE(part.n_corners, 3u) << where;
    EXPECT_LE(part.n_corners, kMostPartCorners) << where;
    const auto from = all.part_xz_m.begin() + part.first_corner;
    const FloatRing corners(from, from + part.n_corners);
    EXPECT_GT(doubled_area(corners), 0) << where;
    sum += doubled_area(corners);
    expect_convex(corners, where);
    for (std::uint32_t k = 0; k < part.n_corners; ++k) {
      const std::pair edge(corners[k], corners[(k + 1) % part.n_corners]);
      const std::uint32_t face = all.part_wall[part.first_corner + k];
      if (face == kNoFace) {
        inner.push_back(edge);
        continue;
      }
      const std::uint32_t wall = face - building.first_face - 1;
      if (wall >= walls.size()) {
        ADD_FAILURE() << where << ": face " << face << " is another building's";
        continue;
      }
      EXPECT_EQ(walls[wall], edge) << where;
      ++times[wall];
    }
  }
  EXPECT_NEAR(sum, footprint, 1e-9 * footprint) << where;
  for (const int n : times) EXPECT_EQ(n, 1) << where;
  // An inner edge is the same edge of another part, the other way round.
  for (const auto& [a, b] : inner)
    EXPECT_EQ(std::count(inner.begin(), inner.end(), std::pair(b, a)), 1) << where;
  return building.n_parts;
}

}  // namespace obliq::test
