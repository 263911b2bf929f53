#include "terrain/world.h"

#include <fmt/core.h>

#include <cmath>

#include "terrain/base/errors.h"
#include "terrain/base/stage_clock.h"
#include "terrain/base/units.h"
#include "terrain/buildings/footprints.h"
#include "terrain/buildings/prisms_random.h"
#include "terrain/buildings/surfaces.h"
#include "terrain/dem/dem_mosaic.h"
#include "terrain/dem/gdal_messages.h"
#include "terrain/grid_area.h"
#include "terrain/world_sum.h"

namespace obliq {
namespace {

WorldFrame frame_of(const WorldSpec& spec) {
  const LonLat& o = spec.origin;
  if (!(std::abs(o.latitude_deg) <= 90) || !(std::abs(o.longitude_deg) <= 540))
    throw InputError(fmt::format(
        "[antenna] latitude_deg, longitude_deg: found {}, {}; allowed: a position on the earth, in degrees",
        o.latitude_deg, o.longitude_deg));
  if (!(spec.radius_factor > 0))
    throw InputError(
        fmt::format("[earth] radius_factor: found {}; allowed: a positive number, or inf for flat ground",
                    spec.radius_factor));
  return WorldFrame(o.latitude_deg * kDegree_rad, o.longitude_deg * kDegree_rad, spec.radius_factor);
}

}  // namespace

std::string file_name(const std::string& path) { return path.substr(path.find_last_of('/') + 1); }

LonLat dem_centre(const TerrainSpec& terrain) {
  const GdalMessages quiet;
  return DemMosaic(terrain).centre();
}

SourcePosting source_posting(const WorldSpec& spec) {
  const GdalMessages quiet;
  const WorldFrame frame = frame_of(spec);
  Rect rect = wanted_area(spec, frame).rect;
  SourcePosting source;
  if (spec.terrain.synthetic == SyntheticKind::none) {
    const DemMosaic mosaic(spec.terrain);
    const Rect covered = mosaic.extent(frame);
    rect = rect.empty() ? covered : rect.intersection(covered);
    if (!rect.empty()) source.posting_m = mosaic.finest_posting_m(frame, rect);
  }
  if (!rect.empty()) source.area_m2 = (rect.x1_m - rect.x0_m) * (rect.z1_m - rect.z0_m);
  return source;
}

World load_world(const WorldSpec& spec, const Progress& progress) {
  const GdalMessages quiet;  // what GDAL has to say is in our errors, or is about tags that we do not use
  World world;
  world.frame = frame_of(spec);
  {
    const StageProbe probe(Stage::grid);
    load_ground(world, spec, progress);
  }
  const StageProbe probe(Stage::outlines);
  const Polygon area = wanted_area(spec, world.frame).polygon;
  paint_surfaces(world, spec, progress);
  load_buildings(world, spec, area, progress);
  scatter_prisms(world, spec, area, progress);
  world.buildings.trim();
  world.buildings.corners = spec.corners;
  world.report.world_sum = world_sum(spec, world.report.dem_files);
  return world;
}

}  // namespace obliq
