#pragma once
#include <cstddef>
#include <glm/vec2.hpp>
#include <vector>

namespace obliq {

using FloatRing = std::vector<glm::vec2>;   ///< closed implicitly
using FloatRings = std::vector<FloatRing>;  ///< of one polygon, the outer one first

/// How many pairs of edges have a point in common, neighbours at a corner not counted; stops at `most`.
std::size_t count_crossings(const FloatRings& rings, std::size_t most);

}  // namespace obliq
