#pragma once
// Outlines as convex parts. Inside one, a line has one entry and one exit, which is all that a quick look at
// a building needs to know of its outline.
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "terrain/buildings/buildings.h"
#include "terrain/polygon.h"

namespace obliq {

/// One edge of a part, from its corner to that of the next.
struct PartEdge {
  std::uint32_t corner = 0;      ///< index into all points of all rings in order
  std::uint32_t wall = kNoFace;  ///< index of the wall's first corner; kNoFace: an edge between two parts
};
using PartRing = std::vector<PartEdge>;  ///< counter-clockwise on a map (x right, z up), closed implicitly

/// Cuts a valid outline (outer ring counter-clockwise, holes clockwise) along edges of its roof's triangles
/// into convex parts of at most kMostPartCorners corners: at most four times as many as the fewest possible,
/// unless the number of corners bounds them (S. Hertel, K. Mehlhorn, "Fast triangulation of simple polygons",
/// FCT 1983). None when one part is enough, which is then the outline. Every wall is an edge of one part.
/// `roof`: triangles that fill the outline, as indices into all points of all rings, clockwise on a map.
std::vector<PartRing> convex_parts(const FloatRings& rings, const std::vector<glm::uvec3>& roof);

}  // namespace obliq
