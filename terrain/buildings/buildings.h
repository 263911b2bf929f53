#pragma once
#include <cstddef>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <span>
#include <vector>

#include "terrain/base/large_vector.h"

namespace obliq {

constexpr std::uint32_t kNoFace = 0xffffffffu;  ///< instead of a face's index: ground, or nothing

/// One face of a building: a wall quad or the whole flat roof. Worked out where it is asked for.
struct BuildingFace {
  glm::dvec3 centre_m{0.0};    ///< world frame; the face's fixed phase reference point
  std::uint64_t identity = 0;  ///< hash of the face's geometry: the same whatever else is loaded
  double reach_m = 0;          ///< no point of it is farther from its centre along any axis
  bool wall = false;
};

/// One vertical prism: an outline with holes, a flat roof, a base below the ground. Frames look at a million
/// of them in any order: one is a line of memory.
struct alignas(64) Building {
  std::uint32_t first_ring =
      0;  ///< into Buildings::ring_start; the first ring is the outline, the rest holes
  std::uint32_t first_face = 0;  ///< roof first, then the walls in ring order
  std::uint32_t n_faces = 0;
  std::uint32_t first_part = 0;  ///< into Buildings::parts
  std::uint32_t n_parts = 0;     ///< 0: the outline is the only part
  std::uint16_t n_rings = 0;
  std::uint8_t material = 1;
  float roof_y_m = 0;          ///< world y
  float base_y_m = 0;          ///< world y, below the lowest ground under the outline
  std::uint64_t identity = 0;  ///< that of face k is mix64(identity + k)
  glm::dvec2 centre_m{0.0};    ///< of the roof's area
  double walls_y_m = 0;        ///< world y of the walls' centres: half way up what stands out of the ground
};
static_assert(sizeof(Building) == 64);

constexpr std::size_t kMostPartCorners = 32;

/// A convex piece of a building's footprint. A building whose outline is convex, has no holes and at most
/// kMostPartCorners corners is one part, its outline, and has none here.
struct ConvexPart {
  std::uint32_t first_corner = 0;  ///< into part_xz_m and part_wall, counter-clockwise like outlines
  std::uint32_t n_corners = 0;
};

/// The rectangle that bounds some corners; of none, low is above high.
struct Rectangle {
  glm::vec2 low_m{std::numeric_limits<float>::infinity()};
  glm::vec2 high_m{-std::numeric_limits<float>::infinity()};

  explicit Rectangle(std::span<const glm::vec2> corners_m) {
    for (const glm::vec2& corner : corners_m) {
      low_m = glm::min(low_m, corner);
      high_m = glm::max(high_m, corner);
    }
  }
};

/// All buildings of a scene, as footprints. Their triangles are worked out from them where rays are traced
/// (terrain/buildings/building_mesh.h), so that footprint and mesh are the same solid.
struct Buildings {
  LargeVector<Building> list;
  std::vector<std::uint32_t> building_of_face;  ///< into list
  /// Ring r is ring_xz_m[ring_start[r] .. ring_start[r + 1]), closed implicitly, outline counter-clockwise
  /// and holes clockwise as seen on a map (x right, z up).
  std::vector<std::uint32_t> ring_start{0};
  LargeVector<glm::vec2> ring_xz_m;
  std::vector<ConvexPart> parts;
  LargeVector<glm::vec2> part_xz_m;      ///< corners of rings, none besides
  std::vector<std::uint32_t> part_wall;  ///< face of the wall from this corner to the next; kNoFace: an inner
                                         ///< edge, which is no wall
  bool walls = true;                     ///< false: roofs alone have triangles, for a comparison
  bool corners = false;                  ///< of walls with the ground before them: they return

  std::span<const glm::vec2> ring(std::uint32_t r) const {
    return std::span(ring_xz_m).subspan(ring_start[r], ring_start[r + 1] - ring_start[r]);
  }
  std::span<const glm::vec2> outline(const Building& building) const { return ring(building.first_ring); }

  /// Into ring_xz_m: before it each building has a face that is no corner's, its roof.
  std::uint32_t first_corner(std::uint32_t building) const { return list[building].first_face - building; }

  BuildingFace face(std::uint32_t index) const { return face(building_of_face[index], index); }
  BuildingFace face(std::uint32_t building, std::uint32_t index) const;

  /// Gives back the memory that growing has left unused.
  void trim();
};

}  // namespace obliq
