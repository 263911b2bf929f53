#pragma once
#include <atomic>
#include <memory>
#include <mutex>
#include <vector>

#include "server/scene/building_circles.h"
#include "server/scene/building_index.h"
#include "server/scene/materials.h"
#include "server/scene/ray_method.h"
#include "server/scene/surface_bounds.h"
#include "server/scene/tile_bounds.h"
#include "server/scene/tracer_isa.h"
#include "terrain/base/parallel.h"
#include "terrain/world.h"

namespace obliq {

class EmbreeTracer;

/// The world plus what finds its surfaces, and its material table. Immutable, shared by all radars and
/// threads.
class Scene {
 public:
  /// materials[id] for every material id in the world. threads: for building the tracer; 0 = all cores. isa:
  /// the tracer's instruction set, for tests that compare them.
  Scene(std::shared_ptr<const World> world, std::vector<Material> materials, int threads,
        RayMethod rays = RayMethod::march, TracerIsa isa = TracerIsa::best);
  ~Scene();
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  const World& world() const { return *world_; }
  const std::vector<Material>& materials() const { return materials_; }
  RayMethod rays() const { return rays_; }
  /// Only some rays need it (needs_tracer in server/radar/frame_plan.h): built by the first call, while
  /// other callers wait, with the same bits from any thread. Throws InputError when it cannot be built; the
  /// next call tries again.
  const EmbreeTracer& tracer(const Progress& progress = {}) const;
  /// Null until tracer() has built it.
  const EmbreeTracer* built_tracer() const { return built_.load(std::memory_order_acquire); }
  const TileBounds& tiles() const { return tiles_; }
  const TileBounds& fine_tiles() const { return fine_tiles_; }
  const BuildingIndex& building_index() const { return building_index_; }
  const BuildingCircles& circles() const { return circles_; }
  /// For lines of sight: made by the first call, while other callers wait.
  const SurfaceBounds& bounds() const;
  /// World y that neither ground nor roofs exceed; -infinity without any.
  double highest_m() const { return highest_m_; }

 private:
  std::shared_ptr<const World> world_;
  std::vector<Material> materials_;
  TileBounds fine_tiles_;
  TileBounds tiles_;
  BuildingIndex building_index_;
  BuildingCircles circles_;
  double highest_m_;
  int threads_;
  RayMethod rays_;
  TracerIsa isa_;
  mutable std::mutex building_;
  mutable std::unique_ptr<const EmbreeTracer> tracer_;  ///< guarded by building_
  mutable std::atomic<const EmbreeTracer*> built_ = nullptr;
  mutable std::once_flag bounding_;
  mutable std::unique_ptr<const SurfaceBounds> bounds_;  ///< by bounding_
};

}  // namespace obliq
