#include "terrain/world_sum.h"

#include <filesystem>

#include "terrain/cache/cache_key.h"
#include "terrain/cache/file_sum.h"

namespace obliq {
namespace {

void add_places(CacheKey& key, std::string_view name, const std::vector<LonLat>& places) {
  std::vector<double> numbers;
  for (const LonLat& place : places) numbers.insert(numbers.end(), {place.longitude_deg, place.latitude_deg});
  key.add(name, numbers);
}

void add_terrain(CacheKey& key, const WorldSpec& spec) {
  const TerrainSpec& terrain = spec.terrain;
  key.add("earth", spec.radius_factor);
  key.add("unit", terrain.unit ? static_cast<double>(*terrain.unit) : -1);
  key.add("crs", terrain.crs.value_or(""));
  key.add("fill", terrain.fill_void_m.value_or(-1));
  key.add("water", terrain.water_material ? *terrain.water_material : -1.0);
  key.add("made-up", static_cast<double>(terrain.synthetic));
  if (terrain.synthetic == SyntheticKind::none) return;
  const SyntheticSpec& shape = terrain.shape;
  for (const double value : {shape.height_m, shape.base_m, shape.slope, shape.bearing_deg, shape.distance_m,
                             shape.width_m, static_cast<double>(shape.seed)})
    key.add("shape", value);
  add_places(key, "about", {shape.anchor.value_or(spec.origin)});
}

/// The file, and what else an Esri shapefile consists of.
void add_source(std::vector<std::string>& files, const std::string& path) {
  files.push_back(path);
  std::filesystem::path part(path);
  if (part.extension() != ".shp") return;
  for (const char* suffix : {".dbf", ".prj", ".cpg"})
    if (std::filesystem::exists(part.replace_extension(suffix))) files.push_back(part);
}

void add_buildings(CacheKey& key, std::vector<std::string>& files, const WorldSpec& spec) {
  for (const BuildingSourceSpec& source : spec.buildings) {
    add_source(files, source.source);
    key.add("buildings", source.layer);
    key.add("height field", source.height_field);
    key.add("unit", source.unit);
    key.add("default height", source.default_height_m);
    key.add("material", source.material);
  }
  if (spec.corners) key.add("corners", 1);
  for (const PrismSpec& prisms : spec.prisms) {
    if (!prisms.within.empty()) add_source(files, prisms.within);
    add_places(key, "prisms", prisms.within_polygon);
    for (const double value : {prisms.per_km2, prisms.width_m[0], prisms.width_m[1], prisms.length_m[0],
                               prisms.length_m[1], prisms.height_m[0], prisms.height_m[1],
                               static_cast<double>(prisms.seed), static_cast<double>(prisms.material)})
      key.add("prisms", value);
  }
}

void add_surfaces(CacheKey& key, std::vector<std::string>& files, const WorldSpec& spec) {
  for (const SurfaceSpec& surface : spec.surfaces) {
    if (!surface.source.empty()) add_source(files, surface.source);
    key.add("surface", surface.layer);
    key.add("where", surface.where);
    key.add("material", surface.material);
    for (const int value : surface.classes) key.add("class", value);
    key.add("scheme", surface.scheme);
    for (const auto& [value, material] : surface.scheme_materials) {
      key.add("class", value);
      key.add("material", material);
    }
    if (surface.gamma_raster.empty()) continue;
    files.push_back(surface.gamma_raster);
    key.add("gamma raster", surface.raster_is_gamma ? "gamma" : "offset");
    key.add("paints", surface.paints ? 1.0 : 0.0);
  }
}

}  // namespace

std::string world_sum(const WorldSpec& spec, const std::vector<std::string>& dem_files) {
  CacheKey key;
  key.add("obliq world", "1");
  add_terrain(key, spec);
  std::vector<std::string> files;
  for (const std::string& file : dem_files) {
    // Overviews and statistics that other programs have left beside it.
    if (file.ends_with(".ovr") || file.ends_with(".aux.xml")) continue;
    files.push_back(file);
  }
  add_buildings(key, files, spec);
  add_surfaces(key, files, spec);
  for (const std::string& sum : file_sums(files)) key.add("source", sum);
  return key.name();
}

}  // namespace obliq
