#include "server/scene/scene_memory.h"

#include <algorithm>
#include <cstdio>
#include <vector>

#include "server/scene/embree_tracer.h"
#include "terrain/buildings/building_mesh.h"

namespace obliq {
namespace {

template <typename List>
std::uint64_t bytes_of(const List& values) {
  return values.capacity() * sizeof values[0];
}

std::uint64_t surface_bytes(const World& world) {
  return bytes_of(world.surface_material) + bytes_of(world.raster_gamma);
}

double megabytes(std::uint64_t bytes) { return static_cast<double>(bytes) / 1e6; }

double ratio(std::uint64_t bytes, std::uint64_t count) {
  return static_cast<double>(bytes) / static_cast<double>(count);
}

template <typename... Values>
std::string format(const char* pattern, Values... values) {
  char text[200];
  std::snprintf(text, sizeof text, pattern, values...);
  return text;
}

}  // namespace

std::uint64_t surface_triangles(const World& world) {
  std::uint64_t n = triangle_count(world.buildings);
  const HeightGrid& grid = world.grid;
  for (int j = 0; j + 1 < grid.nz; ++j)
    for (int i = 0; i + 1 < grid.nx; ++i) n += grid.cell_known(i, j) ? 2U : 0U;
  return n;
}

std::uint64_t grid_bytes(const World& world) { return bytes_of(world.grid.y_m) + surface_bytes(world); }

std::uint64_t building_bytes(const Buildings& b) {
  return bytes_of(b.list) + bytes_of(b.building_of_face) + bytes_of(b.ring_start) + bytes_of(b.ring_xz_m) +
         bytes_of(b.parts) + bytes_of(b.part_xz_m) + bytes_of(b.part_wall);
}

SceneMemory scene_memory(const Scene& scene) {
  const World& world = scene.world();
  SceneMemory memory;
  memory.heights = bytes_of(world.grid.y_m);
  memory.surfaces = surface_bytes(world);
  memory.buildings = building_bytes(world.buildings);
  memory.index = scene.tiles().bytes() + scene.fine_tiles().bytes() + scene.building_index().bytes() +
                 scene.circles().bytes();
  if (const EmbreeTracer* tracer = scene.built_tracer()) {
    memory.tracer = tracer->bytes();
    memory.tracer_peak = tracer->peak_bytes();
  }
  return memory;
}

std::string memory_line(const Scene& scene) {
  const SceneMemory memory = scene_memory(scene);
  const std::uint64_t posts = scene.world().grid.y_m.size();
  std::string line = format("memory: heights %.1f MB (%.1f bytes a post)", megabytes(memory.heights),
                            ratio(memory.heights, posts));
  if (memory.surfaces > 0) line += format(", surfaces %.1f MB", megabytes(memory.surfaces));
  const std::uint64_t buildings = scene.world().buildings.list.size();
  if (buildings > 0)
    line += format(", buildings %.1f MB (%.0f bytes each)", megabytes(memory.buildings),
                   ratio(memory.buildings, buildings));
  line += format(", indices %.1f MB", megabytes(memory.index));
  if (memory.tracer > 0)
    line += format(", Embree %.1f MB (%.1f bytes a post; %.1f MB while it built)", megabytes(memory.tracer),
                   ratio(memory.tracer, posts), megabytes(memory.tracer_peak));
  return line + format("; %.1f MB in all", megabytes(memory.total()));
}

std::string tracer_line(const Scene& scene) {
  const EmbreeTracer& tracer = scene.tracer();
  return format("ray-tracing scene: %.1f M triangles, %.0f MB, built in %.2f s (%s)",
                static_cast<double>(surface_triangles(scene.world())) / 1e6, megabytes(tracer.bytes()),
                tracer.build_s(), EmbreeTracer::version().c_str());
}

}  // namespace obliq
