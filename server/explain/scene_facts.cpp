#include "server/explain/scene_facts.h"

#include <cmath>

#include "server/explain/variants.h"
#include "server/radar/frame_plan.h"

namespace obliq {

SceneFacts facts_of(const ExplainInput& input, const FramePlan& own) {
  const World& world = own.scene().world();
  SceneFacts f;
  f.scene = input.scene;
  f.radar = input.radar;
  f.settings = input.settings;
  f.materials = input.materials;
  f.radius_factor = world.frame.radius_factor();
  f.earth_factor = std::isfinite(f.radius_factor) ? f.radius_factor : kStandardEarth;
  f.height_m =
      world.frame.geodetic_from_world(own.pose().antenna).height_m - own.looks_at().extent().median_height_m;
  f.range_spacing_m = own.bins().range_spacing_m;
  f.cell_m = world.grid.cell_m;
  f.nodes = world.grid.y_m.size();
  f.source_error = world.report.source_error;
  f.buildings = world.buildings.list.size();
  f.sizes = median_sizes(world.buildings);
  if (f.buildings > 0) f.building_material = world.buildings.list.front().material;
  f.flat_plates = flat_plates(f.materials);
  return f;
}

}  // namespace obliq
