#include "server/scene/scene.h"

#include <algorithm>
#include <chrono>

#include "server/scene/embree_tracer.h"
#include "terrain/errors.h"

namespace obliq {

Scene::Scene(std::shared_ptr<const World> world, std::vector<Material> materials, int threads,
             const Progress& progress, TracerIsa isa)
    : world_(std::move(world)),
      materials_(std::move(materials)),
      tiles_(world_->grid),
      fine_tiles_(world_->grid, TileBounds::kFineCells),
      building_index_(*world_) {
  std::size_t highest = 0;
  for (std::uint8_t id : world_->surface_material) highest = std::max<std::size_t>(highest, id);
  for (const Building& building : world_->buildings.list)
    highest = std::max<std::size_t>(highest, building.material);
  if (highest >= materials_.size())
    throw InputError("materials: surface uses material number " + std::to_string(highest) + ", only " +
                     std::to_string(materials_.size()) + " are defined");
  const auto start = std::chrono::steady_clock::now();
  tracer_ = std::make_unique<EmbreeTracer>(*world_, threads, progress, isa);
  stats_.build_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  stats_.bytes = tracer_->bytes();
  const HeightGrid& grid = world_->grid;
  for (int j = 0; j + 1 < grid.nz; ++j)
    for (int i = 0; i + 1 < grid.nx; ++i) stats_.ground_triangles += grid.cell_known(i, j) ? 2 : 0;
  stats_.building_triangles = world_->buildings.triangles.size();
  stats_.tracer = EmbreeTracer::version();
}

Scene::~Scene() = default;

}  // namespace obliq
