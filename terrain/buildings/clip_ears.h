#pragma once
// Triangles of outlines with many corners.
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "terrain/polygon.h"

namespace obliq {

/// Cuts a valid outline (outer ring counter-clockwise, holes clockwise) into triangles, as indices into all
/// points of all rings, counter-clockwise, by joining the holes to the outer ring and clipping ears
/// (D. Eberly, "Triangulation by Ear Clipping", Geometric Tools, 2002). Time grows with the square of the
/// corners, as each corner is looked at anew only when a neighbour has gone (J. O'Rourke, "Computational
/// Geometry in C", 2nd edition, 1.6.5). Arithmetic is that of double: the caller compares areas. Empty where
/// it finds no ear, as where rings touch each other. looks: how many corners were looked at for being in an
/// ear's way is added to it.
std::vector<glm::uvec3> clip_ears(const FloatRings& rings, std::uint64_t* looks = nullptr);

}  // namespace obliq
