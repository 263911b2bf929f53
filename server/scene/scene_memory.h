#pragma once
#include <cstdint>
#include <string>

#include "server/scene/scene.h"

namespace obliq {

/// What a scene holds in memory, in bytes by kind.
struct SceneMemory {
  std::uint64_t heights = 0;      ///< of the grid's posts
  std::uint64_t surfaces = 0;     ///< materials of the ground's cells, and what gamma rasters say of them
  std::uint64_t buildings = 0;    ///< outlines, their convex parts and faces
  std::uint64_t index = 0;        ///< bounds of the ground's tiles, buildings by block, their circles
  std::uint64_t tracer = 0;       ///< all of Embree's, and the buildings' triangles; 0 until rays are cast
  std::uint64_t tracer_peak = 0;  ///< the most of it, while it was built; not part of the sum

  std::uint64_t total() const { return heights + surfaces + buildings + index + tracer; }
};

SceneMemory scene_memory(const Scene& scene);

std::uint64_t grid_bytes(const World& world);
std::uint64_t building_bytes(const Buildings& buildings);
/// Of known ground and of buildings.
std::uint64_t surface_triangles(const World& world);

/// "memory: heights 26.1 MB (4.0 bytes a post), ...; 182.3 MB in all", for the operator.
std::string memory_line(const Scene& scene);

/// "ray-tracing scene: 11.7 M triangles, 155 MB, built in 0.39 s (Embree 3.13.5)"; only of one that is built.
std::string tracer_line(const Scene& scene);

}  // namespace obliq
