#include <algorithm>
#include <array>
#include <limits>

#include "server/control/sections/materials.h"
#include "server/control/sections/section.h"
#include "server/control/sections/sources.h"
#include "server/control/sections/special_values.h"
#include "terrain/cache/ground_cache.h"

namespace obliq {
namespace {

// The lists follow their enumerations.
constexpr std::array kSyntheticKinds{Choice{"none"}, Choice{"flat"}, Choice{"ramp"}, Choice{"ridge"},
                                     Choice{"wall"}, Choice{"cone"}, Choice{"hills"}};
constexpr std::array kVerticalUnits{Choice{"m"}, Choice{"ft"}, Choice{"us_ft"}};

using Terrain = RowsOf<Change::reload, &SceneConfig::world, &WorldSpec::terrain>;
constexpr std::array kTerrainRows{
    Terrain::row<&TerrainSpec::synthetic>("terrain.synthetic", kSyntheticKinds,
                                          "Synthetic ground instead of a dem."),
    // The least cell is the grid's quantum (terrain/height_grid.h).
    Terrain::row<&TerrainSpec::cell_m>(
        "terrain.cell_m", "m", closed(1.0 / 32, 10000),
        "Spacing of the ground grid. auto starts from the larger of the dem's posting and the radars' "
        "sampling, and halves it while the grid misses 5 % of the dem's posts by more than 0.5 m and half "
        "the dem's own error, the posts stay below a quarter of flight.max_megaposts, and half the size "
        "takes at most 1.3 times the frame time. Then it is halved, twice at most, while that moves the "
        "power "
        "that a radar sees in all from its first pose by more than 0.3 %, whatever the frame time."),
    Terrain::row<&TerrainSpec::fill_void_m>(
        "terrain.fill_void_m", "m", closed(0, 100e3),
        "Voids up to this wide are filled by interpolation; wider ones are not ground. auto: the larger of "
        "200 m and three postings of the finest dem."),
};

using Shape = RowsOf<Change::reload, &SceneConfig::world, &WorldSpec::terrain, &TerrainSpec::shape>;
constexpr std::array kShapeRows{
    Shape::row<&SyntheticSpec::height_m>(
        "terrain.shape.height_m", "m", closed(0, 9000),
        "Height of the crest (ridge, wall) or top (cone), relief of the hills."),
    Shape::row<&SyntheticSpec::base_m>("terrain.shape.base_m", "m", closed(-1000, 9000),
                                       "Height of the ground around the shape."),
    Shape::row<&SyntheticSpec::slope>("terrain.shape.slope", closed(-2, 2), "Rise over run of the ramp."),
    Shape::row<&SyntheticSpec::bearing_deg>(
        "terrain.shape.bearing_deg", "deg", closed(-360, 360),
        "Uphill direction of the ramp; direction from the origin to the crest of a ridge or wall."),
    Shape::row<&SyntheticSpec::distance_m>("terrain.shape.distance_m", "m", closed(0, 500e3),
                                           "Ground distance from the origin to the crest or top."),
    Shape::row<&SyntheticSpec::width_m>(
        "terrain.shape.width_m", "m", above(0, 500e3),
        "Width of the ridge from foot to foot, thickness of the wall, base radius of the cone."),
    Shape::row<&SyntheticSpec::seed>("terrain.shape.seed", "Each seed gives other hills."),
};

using World = RowsOf<Change::reload, &SceneConfig::world>;
constexpr std::array kEarthRows{
    World::row<&WorldSpec::radius_factor>(
        "earth.radius_factor", from(0.5),
        "Effective earth radius: 4/3 for standard refraction (holds for antennas up to 3 km), 1 "
        "for vacuum, inf for a flat earth."),
};

TerrainSpec& terrain_of(SceneConfig& config) { return config.world.terrain; }
const TerrainSpec& terrain_of(const SceneConfig& config) { return config.world.terrain; }

void read_dem(const FoundKey& found, SceneConfig& config) {
  for (const ConfigNode* path : found.reader.texts(found.name))
    terrain_of(config).dem.push_back(resolved_path(*path, found.scene.folder));
}

std::string printed_dem(const SceneConfig& config, const SceneConfig&) {
  const auto& dem = terrain_of(config).dem;
  return dem.empty() ? "" : toml_list(dem, [](const std::string& path) { return toml_string(path); });
}

void read_unit(const FoundKey& found, SceneConfig& config) {
  const std::string* text = found.text();
  const auto unit =
      std::ranges::find(kVerticalUnits, text != nullptr ? std::string_view(*text) : "", &Choice::name);
  if (unit == kVerticalUnits.end()) return found.refuse();
  terrain_of(config).unit = static_cast<VerticalUnit>(unit - kVerticalUnits.begin());
}

std::string printed_unit(const SceneConfig& config, const SceneConfig&) {
  const auto& unit = terrain_of(config).unit;
  return unit ? toml_string(kVerticalUnits.at(static_cast<std::size_t>(*unit)).name) : "";
}

void read_crs(const FoundKey& found, SceneConfig& config) {
  std::string crs;
  if (found.reader.read(found.name, found.key, &crs)) terrain_of(config).crs = crs;
}

std::string printed_crs(const SceneConfig& config, const SceneConfig&) {
  return terrain_of(config).crs ? toml_string(*terrain_of(config).crs) : "";
}

void read_area(const FoundKey& found, SceneConfig& config) {
  std::vector<LonLat>& area = config.world.terrain.area;
  const bool nested = found.node.kind == ConfigNode::Kind::array && !found.node.items.empty() &&
                      found.node.items[0].kind == ConfigNode::Kind::array;
  if (nested) {
    area = polygon_of(found.node);
    if (area.empty()) found.refuse();
    return;
  }
  auto box = found.reader.numbers(found.name, closed(-180, 180), 4, 4);
  if (box.empty()) return;
  // A west beyond the east is a box across the antimeridian; half a turn tells it from two swapped numbers.
  if (box[0] > box[2] && box[0] - box[2] > 180) box[2] += 360;
  if (box[0] < box[2] && box[1] < box[3] && box[1] >= -90 && box[3] <= 90) {
    area = {{box[0], box[1]}, {box[2], box[1]}, {box[2], box[3]}, {box[0], box[3]}};
  } else {
    found.refuse();
  }
}

std::string printed_area(const SceneConfig& config, const SceneConfig&) {
  const auto& area = terrain_of(config).area;
  return area.empty() ? "" : printed_polygon(area);
}

void read_sea(const FoundKey& found, SceneConfig&) {
  const std::string* text = found.text();
  if (text == nullptr || (*text != "auto" && *text != "off")) found.refuse();
}

std::string printed_sea(const SceneConfig& config, const SceneConfig&) {
  if (terrain_of(config).synthetic != SyntheticKind::none) return "";
  return terrain_of(config).water_material ? "\"auto\"" : "\"off\"";
}

void read_cache(const FoundKey& found, SceneConfig& config) {
  const std::string* text = found.text();
  if (text == nullptr) return found.refuse();
  if (text->front() == '~')
    return found.reader.complain(found.node, found.name,
                                 found.allowed + " whose path is written out, without ~");
  std::string& folder = terrain_of(config).cache_folder;
  folder = *text == "off"    ? ""
           : *text == "auto" ? usual_cache_folder()
                             : resolved_path(found.node, found.scene.folder);
}

std::string printed_cache(const SceneConfig& config, const SceneConfig&) {
  const std::string& folder = terrain_of(config).cache_folder;
  return folder.empty() ? "\"off\"" : folder == usual_cache_folder() ? "\"auto\"" : toml_string(folder);
}

const std::array kSpecial{
    special<SceneConfig>("terrain.dem", "", kAny, "a path in quotes, or a list of paths",
                         "Elevation models, any GDAL paths; either this or terrain.synthetic.", read_dem,
                         printed_dem),
    special<SceneConfig>("terrain.unit", "", kVerticalUnits, "", "Unit of the dem's heights.", read_unit,
                         printed_unit, "what the file says"),
    special<SceneConfig>("terrain.crs", "", kAny, "any text GDAL understands",
                         "Coordinate system, for a dem without one.", read_crs, printed_crs,
                         "what the file says"),
    special<SceneConfig>("terrain.area", "", kAny,
                         "[west, south, east, north] in degrees with south < north, at most 180 degrees "
                         "eastward from west to east, or a polygon [[longitude, latitude], ...]",
                         "Area to load.", read_area, printed_area, "the radars' reach and 25 %"),
    special<SceneConfig>("terrain.sea", "", kAny, "\"auto\" or \"off\"",
                         "auto gives the material \"water\" to water that the dem itself shows: posts of "
                         "exactly equal height over 1 km2 where the dem has fractions of its unit, and "
                         "heights from 0 down to -1 m over level ground (0.25 m from post to post, below "
                         "1 m) that covers 10 km2 or reaches the dem's edge. Surfaces override it.",
                         read_sea, printed_sea, "\"auto\""),
    special<SceneConfig>(
        "terrain.cache", "", kAny, "\"auto\", \"off\" or a folder",
        "Folder that keeps the grids made from dems, at most 2 GB; a grid is used again until one of its "
        "inputs changes. auto: the first that is set of $OBLIQ_CACHE_DIR, $CACHE_DIRECTORY (from systemd) "
        "and $XDG_CACHE_HOME/obliq, else ~/.cache/obliq; no cache where that first one is set but empty.",
        read_cache, printed_cache, "\"auto\""),
};

/// What the keys are together, and what those stand for that are not there.
void finish_terrain(SceneReading& scene, SectionReader& reader) {
  const ConfigNode& table = reader.table();
  TerrainSpec& terrain = terrain_of(scene.config);
  const bool has_dem = table.find("dem") != nullptr;
  const bool has_synthetic = terrain.synthetic != SyntheticKind::none;
  if (!has_dem && !has_synthetic)
    scene.complaints.add(table.where,
                         {"terrain", "neither dem nor synthetic",
                          "dem = \"FILE\" (any GDAL path, or a list), or synthetic = \"hills\""});
  if (has_dem && has_synthetic)
    scene.complaints.add(table.where, {"terrain", "both dem and synthetic", "one of them"});
  if (table.find("cache") == nullptr) terrain.cache_folder = usual_cache_folder();
  const ConfigNode* sea = table.find("sea");
  // The materials that ship keep their numbers whatever the scene makes of them.
  if (!has_synthetic && (sea == nullptr || sea->value == Value("auto")))
    if (const auto water = find_material(shipped_materials(), "water"))
      terrain.water_material = static_cast<std::uint8_t>(*water);
}

/// Synthetic ground is flat unless the scene says otherwise.
void finish_earth(SceneReading& scene, SectionReader& reader) {
  if (terrain_of(scene.config).synthetic != SyntheticKind::none &&
      reader.table().find("radius_factor") == nullptr)
    scene.config.world.radius_factor = std::numeric_limits<double>::infinity();
}

}  // namespace

const Section kTerrainSection{"terrain", {kTerrainRows, kSpecial}, finish_terrain};
const Section kShapeSection{"terrain.shape", {kShapeRows}};
const Section kEarthSection{"earth", {kEarthRows}, finish_earth};

}  // namespace obliq
