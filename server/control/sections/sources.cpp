#include "server/control/sections/sources.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "server/control/sections/materials.h"
#include "server/control/sections/special_values.h"

namespace obliq {
namespace {

/// One class of a land cover map.
struct LandCoverClass {
  int value;
  std::string_view material;  ///< one of those that ship; empty: no clutter table has it
};

constexpr std::array kLandCoverSchemes{Choice{"nlcd"}, Choice{"worldcover"}};

// What each class is made of; material_library.cpp has the values and their sources. Classes that a table
// does not name go with the nearest that it does, as said; snow and ice return from -20 to +5 dB with their
// wetness, so that one number would be made up.

// MRLC, National Land Cover Database class legend and description, 2021.
const std::vector<LandCoverClass> kNlcd = {
    {11, "water"},   // open water
    {12, ""},        // perennial ice and snow
    {21, "grass"},   // developed, open space: lawns, less than 20 % of it built
    {22, "suburb"},  // developed, low intensity: houses
    {23, "suburb"},  // developed, medium intensity: houses
    {24, "urban"},   // developed, high intensity: blocks, commerce, industry
    {31, "barren"},  // rock, sand, clay
    {41, "forest"},  // deciduous
    {42, "forest"},  // evergreen
    {43, "forest"},  // mixed
    {51, "shrubs"},  // dwarf scrub
    {52, "shrubs"},  // shrub, scrub
    {71, "grass"},   // grassland
    {72, "grass"},   // sedge
    {73, "barren"},  // lichens: on rock
    {74, "grass"},   // moss
    {81, "grass"},   // pasture, hay
    {82, "ground"},  // cultivated crops: farmland
    {90, "forest"},  // woody wetlands: the canopy returns
    {95, "marsh"},   // emergent herbaceous wetlands
};

// ESA WorldCover 10 m product user manual, version 2.0, 2022.
const std::vector<LandCoverClass> kWorldCover = {
    {10, "forest"},   // tree cover
    {20, "shrubs"},   // shrubland
    {30, "grass"},    // grassland
    {40, "ground"},   // cropland: farmland
    {50, "urban"},    // built-up
    {60, "barren"},   // bare, sparse vegetation
    {70, ""},         // snow and ice
    {80, "water"},    // permanent water bodies
    {90, "marsh"},    // herbaceous wetland
    {95, "forest"},   // mangroves
    {100, "barren"},  // moss and lichen: on rock, tundra
};

/// All classes of a scheme that surfaces.scheme may name, in the order of its legend; nothing for other
/// names.
std::optional<std::vector<LandCoverClass>> land_cover(std::string_view scheme) {
  if (scheme == kLandCoverSchemes[0].name) return kNlcd;
  if (scheme == kLandCoverSchemes[1].name) return kWorldCover;
  return std::nullopt;
}

constexpr std::string_view kPath = "a path in quotes";
constexpr std::string_view kMaterial = "a material's name in quotes";
constexpr std::string_view kSpan = "[least, most], or one number,";

// --- [[buildings]] ---

using Houses = BuildingSourceSpec;
constexpr std::array kBuildingUnits{Choice{"m"}, Choice{"ft"}};

/// [buildings] without a source: the switch alone, as of a scene whose buildings are prisms.
bool is_corners_alone(const ConfigNode& table) {
  return table.items.size() == 1 && table.items.front().key == "corners";
}

void read_building_unit(const FoundKey& found, Houses& houses) {
  if (found.reader.read(found.name, Key{"buildings.unit", ""}, &houses.unit) && !houses.unit.empty() &&
      std::ranges::find(kBuildingUnits, std::string_view(houses.unit), &Choice::name) == kBuildingUnits.end())
    found.refuse();
}

const std::array kSpecialOfBuildings{
    special<Houses>("source", "", kAny, kPath, "Building outlines, any OGR path.", read_path<&Houses::source>,
                    printed_text<&Houses::source>, "required"),
    special<Houses>("unit", "", kBuildingUnits, "",
                    "Unit of heights without a unit of their own in the height field.", read_building_unit,
                    printed_text<&Houses::unit>, "\"m\""),
    special<Houses>("material", "", kAny, kMaterial, "Material of roofs and walls.", read_material<Houses>,
                    printed_material<Houses>),
};
constexpr std::array kRowsOfBuildings{
    row<&Houses::layer>("layer", "Layer of the source; empty: the first."),
    row<&Houses::height_field>("height_field", "Field with the building's height."),
    row<&Houses::default_height_m>("default_height_m", "m", above(0, 2000),
                                   "Height of buildings without one."),
    row<&Houses::corners>(
        "corners", kAny,
        "Walls that stand square to the line of sight flash: they return together with the lit ground before "
        "them. Of all buildings of the scene, prisms too, wherever it stands; [buildings] may have it "
        "alone."),
};

void finish_buildings(SceneReading& scene, SectionReader& reader, Houses&) {
  if (is_corners_alone(reader.table())) return;
  require(scene, reader, "source", std::string(kPath));
}

// --- [[prisms]] ---

constexpr Limits kSide = closed(0.5, 1000);

void read_within(const FoundKey& found, PrismSpec& prisms) {
  if (found.node.kind != ConfigNode::Kind::array) return read_path<&PrismSpec::within>(found, prisms);
  prisms.within_polygon = polygon_of(found.node);
  if (prisms.within_polygon.empty()) found.refuse();
}

std::string printed_within(const PrismSpec& prisms, const SceneConfig&) {
  if (!prisms.within.empty()) return toml_string(prisms.within);
  return prisms.within_polygon.empty() ? "" : printed_polygon(prisms.within_polygon);
}

const std::array kSpecialOfPrisms{
    special<PrismSpec>(
        "within", "", kAny, "a path in quotes, or a polygon [[longitude, latitude], ...] in degrees",
        "Polygons to scatter the prisms in.", read_within, printed_within, "all that is loaded"),
    special<PrismSpec>("width_m", "m", kSide, kSpan, "Shorter side.", read_span<&PrismSpec::width_m>,
                       printed_span<&PrismSpec::width_m>),
    special<PrismSpec>("length_m", "m", kSide, kSpan, "Longer side.", read_span<&PrismSpec::length_m>,
                       printed_span<&PrismSpec::length_m>),
    special<PrismSpec>("height_m", "m", kSide, kSpan, "Height.", read_span<&PrismSpec::height_m>,
                       printed_span<&PrismSpec::height_m>),
    special<PrismSpec>("material", "", kAny, kMaterial, "Material of roofs and walls.",
                       read_material<PrismSpec>, printed_material<PrismSpec>),
};
constexpr std::array kRowsOfPrisms{
    row<&PrismSpec::per_km2>("per_km2", "1/km2", closed(0, 100000), "Prisms per square kilometre; 0: none."),
    row<&PrismSpec::seed>("seed", "Each seed gives other prisms."),
};

// --- [[surfaces]] ---

void read_classes(const FoundKey& found, SurfaceSpec& surface) {
  for (const double value : found.reader.numbers(found.name, closed(-1e9, 1e9), 1, 4096)) {
    if (value != std::floor(value)) found.refuse();
    surface.classes.push_back(static_cast<int>(value));
  }
}

std::string printed_classes(const SurfaceSpec& surface, const SceneConfig&) {
  if (surface.classes.empty()) return "";
  return toml_list(surface.classes, [](int value) { return std::to_string(value); });
}

/// A class raster whose legend is known: its classes have their materials from that.
void read_scheme(const FoundKey& found, SurfaceSpec& surface) {
  if (!found.reader.read(found.name, Key{"surfaces.scheme", ""}, &surface.scheme)) return;
  const auto classes = land_cover(surface.scheme);
  if (!classes) return found.refuse();
  for (const std::string_view other : {"classes", "material", "where", "layer"}) {
    if (const ConfigNode* both = found.reader.table().find(other))
      found.reader.complain(*both, other, "nothing beside scheme, which says what each class is made of");
  }
  for (const LandCoverClass& each : *classes) {
    if (each.material.empty()) continue;
    const auto material = find_material(found.scene.config.materials, each.material);
    surface.scheme_materials.emplace_back(each.value, static_cast<std::uint8_t>(material.value()));
  }
}

std::string printed_surface_material(const SurfaceSpec& surface, const SceneConfig& config) {
  return surface.scheme.empty() && surface.paints ? printed_material(surface, config) : "";
}

// A file of decibels does not say whether -12 is a dark field or the gamma of grass.
constexpr std::array kRasterMeanings{Choice{"offset"}, Choice{"gamma"}};

void read_raster_meaning(const FoundKey& found, SurfaceSpec& surface) {
  const std::string* const text = found.text();
  if (text == nullptr || std::ranges::find(kRasterMeanings, *text, &Choice::name) == kRasterMeanings.end())
    return found.refuse();
  surface.raster_is_gamma = *text == kRasterMeanings[1].name;
}

std::string printed_raster_meaning(const SurfaceSpec& surface, const SceneConfig&) {
  if (surface.gamma_raster.empty()) return "";
  return toml_string(kRasterMeanings[surface.raster_is_gamma ? 1 : 0].name);
}

const std::array kSpecialOfSurfaces{
    special<SurfaceSpec>("source", "", kAny, kPath, "OGR polygons or a GDAL class raster.",
                         read_path<&SurfaceSpec::source>, printed_text<&SurfaceSpec::source>,
                         "required without gamma_raster"),
    special<SurfaceSpec>("classes", "", kAny, "a list of whole numbers",
                         "For a class raster: the values of this material.", read_classes, printed_classes,
                         "[]"),
    special<SurfaceSpec>("material", "", kAny, kMaterial, "Material of the ground there.",
                         read_material<SurfaceSpec>, printed_surface_material,
                         "required without scheme or gamma_raster"),
    special<SurfaceSpec>(
        "scheme", "", kLandCoverSchemes, "",
        "For a class raster with a known legend, instead of classes and material: each class gets a "
        "material from clutter tables.",
        read_scheme, printed_text<&SurfaceSpec::scheme>),
    special<SurfaceSpec>(
        "gamma_raster", "", kAny, kPath,
        "GDAL raster of decibels, one a pixel, of the ground that the source paints or, without a source, of "
        "all ground; voids keep the material.",
        read_path<&SurfaceSpec::gamma_raster>, printed_text<&SurfaceSpec::gamma_raster>, "none"),
    special<SurfaceSpec>(
        "gamma_raster_is", "", kRasterMeanings, "",
        "offset: added to the material's cross section; gamma: in its place, constant gamma.",
        read_raster_meaning, printed_raster_meaning, "\"offset\""),
    special<SurfaceSpec>("layer", "", kAny, "a text in quotes", "Layer of the source; empty: the first.",
                         read_text<&SurfaceSpec::layer>, printed_text<&SurfaceSpec::layer>, "\"\""),
    special<SurfaceSpec>("where", "", kAny, "a text in quotes", "OGR attribute filter; empty: every feature.",
                         read_text<&SurfaceSpec::where>, printed_text<&SurfaceSpec::where>, "\"\""),
};

void finish_surfaces(SceneReading& scene, SectionReader& reader, SurfaceSpec& surface) {
  const ConfigNode& table = reader.table();
  if (surface.gamma_raster.empty()) {
    require(scene, reader, "source", std::string(kPath));
    if (const ConfigNode* alone = table.find("gamma_raster_is"))
      reader.complain(*alone, "gamma_raster_is", "nothing without gamma_raster");
  } else if (surface.source.empty()) {
    surface.paints = table.find("material") != nullptr;
    for (const std::string_view of_source : {"classes", "scheme", "layer", "where"})
      if (const ConfigNode* alone = table.find(of_source))
        reader.complain(*alone, of_source, "nothing without source");
    return;
  }
  if (surface.scheme.empty()) require(scene, reader, "material", std::string(kMaterial));
}

}  // namespace

void settle_corners(SceneReading& scene) {
  WorldSpec& world = scene.config.world;
  for (const Houses& houses : world.buildings) world.corners = world.corners || houses.corners;
  std::erase_if(world.buildings, [](const Houses& houses) { return houses.source.empty(); });
  for (Houses& houses : world.buildings) houses.corners = world.corners;
  if (world.corners) lower_building_floor(scene);
}

std::string printed_corners(const SceneConfig& config) {
  return config.world.corners && config.world.buildings.empty() ? "\n[buildings]\ncorners = true\n" : "";
}

const ListSection<BuildingSourceSpec> kBuildings{
    "buildings", {kRowsOfBuildings, kSpecialOfBuildings}, &WorldSpec::buildings, finish_buildings};
const ListSection<PrismSpec> kPrisms{"prisms", {kRowsOfPrisms, kSpecialOfPrisms}, &WorldSpec::prisms};
const ListSection<SurfaceSpec> kSurfaces{
    "surfaces", {{}, kSpecialOfSurfaces}, &WorldSpec::surfaces, finish_surfaces};

}  // namespace obliq
