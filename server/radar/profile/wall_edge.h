#pragma once
#include <cstdint>

#include "terrain/buildings/buildings.h"

namespace obliq {

/// The corners of a wall, into Buildings::ring_xz_m.
struct WallEdge {
  std::uint32_t from;
  std::uint32_t to;
};

/// `face`: a wall. Walls stand in ring order behind their building's roof.
inline WallEdge edge_of_wall(const Buildings& all, std::uint32_t face) {
  const Building& building = all.list[all.faces[face].building];
  std::uint32_t edge = face - building.first_face - 1;
  std::uint32_t ring = building.first_ring;
  while (edge >= all.ring_start[ring + 1] - all.ring_start[ring]) {
    edge -= all.ring_start[ring + 1] - all.ring_start[ring];
    ++ring;
  }
  const std::uint32_t begin = all.ring_start[ring];
  const std::uint32_t size = all.ring_start[ring + 1] - begin;
  return {begin + edge, begin + (edge + 1) % size};
}

}  // namespace obliq
