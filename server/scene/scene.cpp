#include "server/scene/scene.h"

#include <algorithm>
#include <limits>

#include "server/scene/embree_tracer.h"
#include "terrain/base/errors.h"

namespace obliq {
namespace {

double highest_of(const World& world, const TileBounds& tiles) {
  double highest_m = -std::numeric_limits<double>::infinity();
  for (int tj = 0; tj < tiles.tiles_z(); ++tj)
    for (int ti = 0; ti < tiles.tiles_x(); ++ti)
      highest_m = std::max(highest_m, static_cast<double>(tiles.tile(ti, tj).highest_m));
  for (const Building& building : world.buildings.list)
    highest_m = std::max(highest_m, static_cast<double>(building.roof_y_m));
  return highest_m;
}

}  // namespace

Scene::Scene(std::shared_ptr<const World> world, std::vector<Material> materials, int threads, RayMethod rays,
             TracerIsa isa)
    : world_(std::move(world)),
      materials_(std::move(materials)),
      fine_tiles_(world_->grid, TileBounds::kFineCells),
      tiles_(fine_tiles_, TileBounds::kCells / TileBounds::kFineCells),
      building_index_(*world_),
      circles_(world_->buildings),
      highest_m_(highest_of(*world_, tiles_)),
      threads_(threads),
      rays_(rays),
      isa_(isa) {
  std::size_t highest = 0;
  for (std::uint8_t id : world_->surface_material) highest = std::max<std::size_t>(highest, id);
  for (const Building& building : world_->buildings.list)
    highest = std::max<std::size_t>(highest, building.material);
  if (highest >= materials_.size())
    throw InputError("materials: surface uses material number " + std::to_string(highest) + ", only " +
                     std::to_string(materials_.size()) + " are defined");
}

Scene::~Scene() = default;

const SurfaceBounds& Scene::bounds() const {
  std::call_once(bounding_,
                 [this] { bounds_ = std::make_unique<const SurfaceBounds>(*world_, fine_tiles_); });
  return *bounds_;
}

const EmbreeTracer& Scene::tracer(const Progress& progress) const {
  if (const EmbreeTracer* built = built_tracer()) return *built;
  const std::lock_guard lock(building_);
  if (!tracer_) {
    tracer_ = std::make_unique<const EmbreeTracer>(*world_, threads_, progress, isa_);
    built_.store(tracer_.get(), std::memory_order_release);
  }
  return *tracer_;
}

}  // namespace obliq
