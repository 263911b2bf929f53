#include "server/control/scene_keys.h"

#include <array>
#include <vector>

#include "server/control/flight_keys.h"
#include "server/control/land_cover.h"
#include "server/control/modbus_keys.h"
#include "server/control/operation_keys.h"
#include "server/control/server_keys.h"
#include "server/control/stream_keys.h"

namespace obliq {

namespace {

// The lists follow their enumerations.
constexpr std::array kRayMethods{Choice{"march"}, Choice{"embree"}};
constexpr std::array kSyntheticKinds{Choice{"none"}, Choice{"flat"}, Choice{"ramp"}, Choice{"ridge"},
                                     Choice{"wall"}, Choice{"cone"}, Choice{"hills"}};
constexpr std::array kModels{Choice{"constant_gamma"}, Choice{"geometric_optics"}, Choice{"flat_plate"}};
constexpr std::array kVerticalUnits{Choice{"m"}, Choice{"ft"}, Choice{"us_ft"}};

using World = RowsOf<&SceneConfig::world>;
using Terrain = RowsOf<&SceneConfig::world, &WorldSpec::terrain>;
using Shape = RowsOf<&SceneConfig::world, &WorldSpec::terrain, &TerrainSpec::shape>;
using Accuracy = RowsOf<&SceneConfig::accuracy>;
const std::array kScene{
    Terrain::row<&TerrainSpec::synthetic>("terrain.synthetic", kSyntheticKinds,
                                          "Synthetic ground instead of a dem."),
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
    World::row<&WorldSpec::radius_factor>(
        "earth.radius_factor", from(0.5),
        "Effective earth radius: 4/3 for standard refraction (holds for antennas up to 3 km), 1 "
        "for vacuum, inf for a flat earth."),
    Accuracy::row<&AccuracyWish::max_power_error_db>(
        "accuracy.max_power_error_db", "dB", from(0.0001),
        "Largest allowed median error of a bin's power. [accuracy] chooses the frustum's pixels, "
        "even where the scene names some, and \"auto\" cells; kind and plates stay."),
    Accuracy::row<&AccuracyWish::max_gap_fraction>(
        "accuracy.max_gap_fraction", closed(0, 1),
        "Largest allowed fraction of lit bins without a return; 1: any; 0.05 where only "
        "max_power_error_db is given."),
    row<&SceneConfig::threads>("run.threads", closed(0, 1024),
                               "Number of rendering threads; 0: one per core."),
    row<&SceneConfig::rays>(
        "run.rays", kRayMethods,
        "How rays find the ground: march its cells and use Embree only for rays near buildings, or "
        "use Embree for all, which takes longer. The bits are the same except where a ray meets an "
        "edge within rounding."),
};

const std::array kBuildings{
    row<&BuildingSourceSpec::layer>("layer", "Layer of the source; empty: the first."),
    row<&BuildingSourceSpec::height_field>("height_field", "Field with the building's height."),
    row<&BuildingSourceSpec::default_height_m>("default_height_m", "m", above(0, 2000),
                                               "Height of buildings without one."),
};

const std::array kPrisms{
    row<&PrismSpec::per_km2>("per_km2", "1/km2", closed(0, 100000), "Prisms per square kilometre; 0: none."),
    row<&PrismSpec::seed>("seed", "Each seed gives other prisms."),
};

const std::array kSurfaces{
    row<&SurfaceSpec::layer>("layer", "Layer of the source; empty: the first."),
    row<&SurfaceSpec::where>("where", "OGR attribute filter; empty: every feature."),
};

const std::array kMaterials{
    row<&MaterialKeys::material, &Material::model>("model", kModels, "Scattering model."),
    row<&MaterialKeys::gamma_db>(
        "gamma_db", "dB", closed(-200, 60),
        "Constant gamma; with geometric optics the floor away from the specular direction."),
    row<&MaterialKeys::material, &Material::reflectivity>(
        "reflectivity", closed(0, 1), "Geometric optics: power reflectivity at normal incidence."),
    row<&MaterialKeys::material, &Material::rms_slope>("rms_slope", closed(0.001, 10),
                                                       "Geometric optics: rms slope along one axis."),
    row<&MaterialKeys::material, &Material::plate_tau>("plate_tau", closed(0, 1e6),
                                                       "Flat plate: tau at normal incidence."),
    row<&MaterialKeys::material, &Material::plate_exponent>(
        "plate_exponent", closed(0, 1000), "Flat plate: tau falls as this power of cos(incidence)."),
};

constexpr std::array kSpecial{
    SpecialKey{"terrain.dem", "a path or a list of paths", "",
               "Elevation models, any GDAL paths; either this or terrain.synthetic."},
    SpecialKey{"terrain.unit", "\"m\" | \"ft\" | \"us_ft\"", "what the file says",
               "Unit of the dem's heights."},
    SpecialKey{"terrain.crs", "any text GDAL understands", "what the file says",
               "Coordinate system, for a dem without one."},
    SpecialKey{"terrain.area", "[west, south, east, north] or [[lon, lat], ...] in degrees",
               "the radars' reach and 25 %", "Area to load."},
    SpecialKey{"terrain.cell_m", "\"auto\" or a number 0.03125 to 10000 m", "\"auto\"",
               "Spacing of the ground grid. auto starts from the larger of the dem's posting and the radars' "
               "sampling, and halves it while the grid misses 5 % of the dem's posts by more than 0.5 m and "
               "half the dem's own error, the posts stay below a quarter of flight.max_megaposts, and half "
               "the size takes at most 1.3 times the frame time."},
    SpecialKey{"terrain.fill_void_m", "\"auto\" or a number 0 to 100000 m", "\"auto\"",
               "Voids up to this wide are filled by interpolation; wider ones are not ground. auto: the "
               "larger of 200 m and three postings of the finest dem."},
    SpecialKey{"terrain.sea", "\"auto\" | \"off\"", "\"auto\"",
               "auto gives the material \"water\" to water that the dem itself shows: posts of exactly equal "
               "height over 1 km2 where the dem has fractions of its unit, and heights from 0 down to -1 m "
               "over level ground (0.25 m from post to post, below 1 m) that covers 10 km2 or reaches the "
               "dem's edge. Surfaces override it."},
    SpecialKey{
        "terrain.cache", "\"auto\", \"off\" or a folder", "\"auto\"",
        "Folder that keeps the grids made from dems, at most 2 GB; a grid is used again until one of its "
        "inputs changes. auto: the first that is set of $OBLIQ_CACHE_DIR, $CACHE_DIRECTORY (from systemd) "
        "and $XDG_CACHE_HOME/obliq, else ~/.cache/obliq; no cache where that first one is set but empty."},
    SpecialKey{"modbus.allow", "a list of addresses and networks, such as \"10.0.0.0/24\"", "[]",
               "Addresses and networks that may connect to Modbus; empty: any that can reach it."},
    SpecialKey{"frustum.quality", "\"paper\" | \"oblique\" | \"draft\" | \"standard\" | \"reference\"",
               "\"standard\"",
               "Sets kind, plates, pixel_columns and pixel_rows; the default where [frustum] is empty."},
    SpecialKey{"frustum.pixels", "a number, or [columns, rows]", "2048",
               "Sets pixel_columns and pixel_rows."},
    SpecialKey{"buildings.source", "a path", "", "Building outlines, any OGR path."},
    SpecialKey{"buildings.unit", "\"m\" | \"ft\"", "\"m\"",
               "Unit of heights without a unit of their own in the height field."},
    SpecialKey{"buildings.material", "a material's name", "\"building\"", "Material of roofs and walls."},
    SpecialKey{"prisms.within", "a path, or [[lon, lat], ...] in degrees", "all that is loaded",
               "Polygons to scatter the prisms in."},
    SpecialKey{"prisms.width_m", "[least, most], or one number, 0.5 to 1000 m", "[10.0, 30.0]",
               "Shorter side."},
    SpecialKey{"prisms.length_m", "[least, most], or one number, 0.5 to 1000 m", "[10.0, 50.0]",
               "Longer side."},
    SpecialKey{"prisms.height_m", "[least, most], or one number, 0.5 to 1000 m", "[4.0, 30.0]", "Height."},
    SpecialKey{"prisms.material", "a material's name", "\"building\"", "Material of roofs and walls."},
    SpecialKey{"surfaces.source", "a path", "", "OGR polygons or a GDAL class raster."},
    SpecialKey{"surfaces.classes", "a list of integers", "[]",
               "For a class raster: the values of this material."},
    SpecialKey{"surfaces.material", "a material's name", "", "Material of the ground there."},
    SpecialKey{"surfaces.scheme", kLandCoverSchemes, "",
               "For a class raster with a known legend, instead of classes and material: each class gets a "
               "material from clutter tables."},
};

constexpr std::array<std::string_view, 6> kDaemonSections{
    "server", "stream", "http", "log", "flight", "modbus",
};

}  // namespace

std::span<const std::string_view> daemon_sections() { return kDaemonSections; }

std::span<const Row<SceneConfig>> scene_entries() {
  static const auto all = [] {
    std::vector<Row<SceneConfig>> entries(kScene.begin(), kScene.end());
    entries.insert(entries.end(), server_entries().begin(), server_entries().end());
    entries.insert(entries.end(), stream_entries().begin(), stream_entries().end());
    entries.insert(entries.end(), operation_entries().begin(), operation_entries().end());
    entries.insert(entries.end(), flight_entries().begin(), flight_entries().end());
    entries.insert(entries.end(), modbus_entries().begin(), modbus_entries().end());
    return entries;
  }();
  return all;
}
std::span<const Row<BuildingSourceSpec>> building_entries() { return kBuildings; }
std::span<const Row<PrismSpec>> prism_entries() { return kPrisms; }
std::span<const Row<SurfaceSpec>> surface_entries() { return kSurfaces; }
std::span<const Row<MaterialKeys>> material_entries() { return kMaterials; }
std::span<const SpecialKey> special_keys() { return kSpecial; }
std::span<const Choice> vertical_units() { return kVerticalUnits; }

}  // namespace obliq
