#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "server/scene/building_index.h"
#include "server/scene/materials.h"
#include "server/scene/tile_bounds.h"
#include "server/scene/tracer_isa.h"
#include "terrain/progress.h"
#include "terrain/world.h"

namespace obliq {

class EmbreeTracer;

struct SceneStats {
  double build_s = 0;
  std::uint64_t bytes = 0;  ///< what Embree holds for this scene
  std::uint64_t ground_triangles = 0;
  std::uint64_t building_triangles = 0;
  std::string tracer;  ///< name and version, "Embree 3.13.5"
};

/// The world plus its ray-tracing structure and material table. Immutable, shared by all radars and threads.
class Scene {
 public:
  /// materials[id] for every material id in the world. threads: for the build; 0 = all cores. isa: the
  /// tracer's instruction set, for tests that compare them.
  Scene(std::shared_ptr<const World> world, std::vector<Material> materials, int threads,
        const Progress& progress = {}, TracerIsa isa = TracerIsa::best);
  ~Scene();
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  const World& world() const { return *world_; }
  const std::vector<Material>& materials() const { return materials_; }
  const EmbreeTracer& tracer() const { return *tracer_; }
  const TileBounds& tiles() const { return tiles_; }
  const TileBounds& fine_tiles() const { return fine_tiles_; }
  const BuildingIndex& building_index() const { return building_index_; }
  const SceneStats& stats() const { return stats_; }

 private:
  std::shared_ptr<const World> world_;
  std::vector<Material> materials_;
  TileBounds tiles_;
  TileBounds fine_tiles_;
  BuildingIndex building_index_;
  std::unique_ptr<EmbreeTracer> tracer_;
  SceneStats stats_;
};

}  // namespace obliq
