#include "server/control/scene_keys.h"

#include <array>
#include <limits>
#include <vector>

#include "server/control/flight_keys.h"
#include "server/control/land_cover.h"
#include "server/control/modbus_keys.h"
#include "server/control/operation_keys.h"
#include "server/control/server_keys.h"
#include "server/control/stream_keys.h"

namespace obliq {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The lists follow their enumerations.
constexpr std::array kRayMethods{Choice{"march"}, Choice{"embree"}};
constexpr std::array kSyntheticKinds{Choice{"none"}, Choice{"flat"}, Choice{"ramp"}, Choice{"ridge"},
                                     Choice{"wall"}, Choice{"cone"}, Choice{"hills"}};
constexpr std::array kModels{Choice{"constant_gamma"}, Choice{"geometric_optics"}, Choice{"flat_plate"}};
constexpr std::array kVerticalUnits{Choice{"m"}, Choice{"ft"}, Choice{"us_ft"}};

using Scene = SceneConfig;
const std::array kScene{
    Entry<Scene>{{"terrain.synthetic", "", {}, kSyntheticKinds, "Made-up ground instead of a dem."},
                 [](Scene& c) -> Slot { return &c.world.terrain.synthetic; }},
    Entry<Scene>{{"terrain.shape.height_m",
                  "m",
                  closed(0, 9000),
                  {},
                  "Crest of ridge and wall, top of the cone, relief of the hills."},
                 [](Scene& c) -> Slot { return &c.world.terrain.shape.height_m; }},
    Entry<Scene>{
        {"terrain.shape.base_m", "m", closed(-1000, 9000), {}, "Height of the ground around the shape."},
        [](Scene& c) -> Slot { return &c.world.terrain.shape.base_m; }},
    Entry<Scene>{{"terrain.shape.slope", "", closed(-2, 2), {}, "Rise over run of the ramp."},
                 [](Scene& c) -> Slot { return &c.world.terrain.shape.slope; }},
    Entry<Scene>{{"terrain.shape.bearing_deg",
                  "deg",
                  closed(-360, 360),
                  {},
                  "Uphill of the ramp; from the origin to the crest of ridge and wall."},
                 [](Scene& c) -> Slot { return &c.world.terrain.shape.bearing_deg; }},
    Entry<Scene>{{"terrain.shape.distance_m",
                  "m",
                  closed(0, 500e3),
                  {},
                  "Ground distance of crest or apex from the origin."},
                 [](Scene& c) -> Slot { return &c.world.terrain.shape.distance_m; }},
    Entry<Scene>{{"terrain.shape.width_m",
                  "m",
                  above(0, 500e3),
                  {},
                  "Foot to foot of the ridge, thickness of the wall, base radius of the cone."},
                 [](Scene& c) -> Slot { return &c.world.terrain.shape.width_m; }},
    Entry<Scene>{{"terrain.shape.seed", "", {}, {}, "Another seed, other hills."},
                 [](Scene& c) -> Slot { return &c.world.terrain.shape.seed; }},
    Entry<Scene>{
        {"earth.radius_factor",
         "",
         {0.5, kInfinity, false, false},
         {},
         "Effective earth: 4/3 standard refraction (a rule for antennas up to 3 km), 1 vacuum, inf flat."},
        [](Scene& c) -> Slot { return &c.world.radius_factor; }},
    Entry<Scene>{{"accuracy.max_power_error_db",
                  "dB",
                  {0.0001, kInfinity, false, false},
                  {},
                  "Median error of a bin's power that the user allows. [accuracy] chooses the frustum's "
                  "pixels, whatever "
                  "the scene names, and \"auto\" cells; kind and plates stay."},
                 [](Scene& c) -> Slot { return &c.accuracy.max_power_error_db; }},
    Entry<Scene>{{"accuracy.max_gap_fraction",
                  "",
                  closed(0, 1),
                  {},
                  "Fraction of the lit bins that may be left without a return; 1: any. 0.05 where only "
                  "max_power_error_db is given."},
                 [](Scene& c) -> Slot { return &c.accuracy.max_gap_fraction; }},
    Entry<Scene>{{"run.threads", "", closed(0, 1024), {}, "Threads that render; 0: all cores."},
                 [](Scene& c) -> Slot { return &c.threads; }},
    Entry<Scene>{
        {"run.rays",
         "",
         {},
         kRayMethods,
         "How rays find the ground: by a march of its cells, with Embree for those that come near buildings; "
         "or all by Embree, which takes longer. Same bits, but where a ray meets an edge to rounding."},
        [](Scene& c) -> Slot { return &c.rays; }},
};

using Houses = BuildingSourceSpec;
const std::array kBuildings{
    Entry<Houses>{{"layer", "", {}, {}, "Layer of the source; empty: the first."},
                  [](Houses& b) -> Slot { return &b.layer; }},
    Entry<Houses>{{"height_field", "", {}, {}, "Field that holds the height."},
                  [](Houses& b) -> Slot { return &b.height_field; }},
    Entry<Houses>{{"default_height_m", "m", above(0, 2000), {}, "Height of buildings that name none."},
                  [](Houses& b) -> Slot { return &b.default_height_m; }},
};

const std::array kPrisms{
    Entry<PrismSpec>{{"per_km2", "1/km2", closed(0, 100000), {}, "Prisms per square kilometre; 0: none."},
                     [](PrismSpec& p) -> Slot { return &p.per_km2; }},
    Entry<PrismSpec>{{"seed", "", {}, {}, "Another seed, other prisms."},
                     [](PrismSpec& p) -> Slot { return &p.seed; }},
};

const std::array kSurfaces{
    Entry<SurfaceSpec>{{"layer", "", {}, {}, "Layer of the source; empty: the first."},
                       [](SurfaceSpec& s) -> Slot { return &s.layer; }},
    Entry<SurfaceSpec>{{"where", "", {}, {}, "OGR attribute filter; empty: every feature."},
                       [](SurfaceSpec& s) -> Slot { return &s.where; }},
};

const std::array kMaterials{
    Entry<MaterialKeys>{{"model", "", {}, kModels, "How it scatters."},
                        [](MaterialKeys& m) -> Slot { return &m.material.model; }},
    Entry<MaterialKeys>{{"gamma_db",
                         "dB",
                         closed(-200, 60),
                         {},
                         "Constant gamma; under geometric optics the floor off the specular direction."},
                        [](MaterialKeys& m) -> Slot { return &m.gamma_db; }},
    Entry<MaterialKeys>{{"reflectivity", "", closed(0, 1), {}, "Geometric optics: power reflected head on."},
                        [](MaterialKeys& m) -> Slot { return &m.material.reflectivity; }},
    Entry<MaterialKeys>{{"rms_slope", "", closed(0.001, 10), {}, "Geometric optics: one-axis rms slope."},
                        [](MaterialKeys& m) -> Slot { return &m.material.rms_slope; }},
    Entry<MaterialKeys>{{"plate_tau", "", closed(0, 1e6), {}, "Flat plate: tau head on."},
                        [](MaterialKeys& m) -> Slot { return &m.material.plate_tau; }},
    Entry<MaterialKeys>{
        {"plate_exponent", "", closed(0, 1000), {}, "Flat plate: tau falls as this power of cos(incidence)."},
        [](MaterialKeys& m) -> Slot { return &m.material.plate_exponent; }},
};

constexpr std::array kSpecial{
    SpecialKey{"terrain.dem", "a path or a list of paths", "",
               "Elevation models: any GDAL paths; this or synthetic."},
    SpecialKey{"terrain.unit", "\"m\" | \"ft\" | \"us_ft\"", "what the file says",
               "Unit of the dem's heights."},
    SpecialKey{"terrain.crs", "any text GDAL understands", "what the file says",
               "For a dem that carries none."},
    SpecialKey{"terrain.area", "[west, south, east, north] or [[lon, lat], ...] in degrees",
               "the radars' reach and 25 %", "What is loaded."},
    SpecialKey{
        "terrain.cell_m", "\"auto\" or a number 0.03125 to 10000 m", "\"auto\"",
        "Spacing of the ground grid; auto: the larger of the dem's posting and what the radars sample, "
        "halved "
        "while 95 % of the dem's posts lie further from the grid than 0.5 m and half the dem's own error, up "
        "to a quarter of flight.max_megaposts, and while half the size takes at most 1.3 times the frame "
        "time."},
    SpecialKey{"terrain.fill_void_m", "\"auto\" or a number 0 to 100000 m", "\"auto\"",
               "Voids no wider than this are filled by interpolation, wider ones are no ground; auto: the "
               "larger of 200 m and three postings of the finest dem."},
    SpecialKey{
        "terrain.sea", "\"auto\" | \"off\"", "\"auto\"",
        "Water that a dem itself shows is of material \"water\": posts of exactly equal height over 1 km2 "
        "where it has fractions of its unit, and from 0 down to -1 m over level ground (0.25 m from post "
        "to post, below 1 m) that has 10 km2 or reaches the dem's edge. Surfaces win over it."},
    SpecialKey{
        "terrain.cache", "\"auto\", \"off\" or a folder", "\"auto\"",
        "Grids made of a dem are kept here, 2 GB at most, and used again as long as nothing that they "
        "were made from has changed; auto: $OBLIQ_CACHE_DIR, else $CACHE_DIRECTORY (systemd's), else "
        "$XDG_CACHE_HOME/obliq, else ~/.cache/obliq; off where the first of them that is set is empty."},
    SpecialKey{"modbus.allow", "a list of addresses and networks, such as \"10.0.0.0/24\"", "[]",
               "Who may connect to Modbus; empty: anybody who can reach the address."},
    SpecialKey{
        "frustum.quality", "\"paper\" | \"oblique\" | \"draft\" | \"standard\" | \"reference\"",
        "\"standard\"",
        "Sets kind, plates, pixel_columns and pixel_rows; the default where nothing of [frustum] is named."},
    SpecialKey{"frustum.pixels", "a number, or [columns, rows]", "2048",
               "Sets pixel_columns and pixel_rows."},
    SpecialKey{"buildings.source", "a path", "", "Outlines: any OGR path."},
    SpecialKey{"buildings.unit", "\"m\" | \"ft\"", "\"m\"", "Unit of bare numbers in the height field."},
    SpecialKey{"buildings.material", "a material's name", "\"building\"",
               "What roofs and walls are made of."},
    SpecialKey{"prisms.within", "a path, or [[lon, lat], ...] in degrees", "all that is loaded",
               "Polygons that prisms stand in."},
    SpecialKey{"prisms.width_m", "[least, most], or one number, 0.5 to 1000 m", "[10.0, 30.0]",
               "Shorter side."},
    SpecialKey{"prisms.length_m", "[least, most], or one number, 0.5 to 1000 m", "[10.0, 50.0]",
               "Longer side."},
    SpecialKey{"prisms.height_m", "[least, most], or one number, 0.5 to 1000 m", "[4.0, 30.0]", "Height."},
    SpecialKey{"prisms.material", "a material's name", "\"building\"", "What roofs and walls are made of."},
    SpecialKey{"surfaces.source", "a path", "", "OGR polygons or a GDAL class raster."},
    SpecialKey{"surfaces.classes", "a list of integers", "[]",
               "Class raster: the values that mean this material."},
    SpecialKey{"surfaces.material", "a material's name", "", "What the ground there is made of."},
    SpecialKey{
        "surfaces.scheme", kLandCoverSchemes, "",
        "Class raster with a known legend, instead of classes and material: each class is what clutter "
        "tables have for it."},
};

constexpr std::array<std::string_view, 6> kDaemonSections{
    "server", "stream", "http", "log", "flight", "modbus",
};

}  // namespace

std::span<const std::string_view> daemon_sections() { return kDaemonSections; }

std::span<const Entry<SceneConfig>> scene_entries() {
  static const auto all = [] {
    std::vector<Entry<SceneConfig>> entries(kScene.begin(), kScene.end());
    entries.insert(entries.end(), server_entries().begin(), server_entries().end());
    entries.insert(entries.end(), stream_entries().begin(), stream_entries().end());
    entries.insert(entries.end(), operation_entries().begin(), operation_entries().end());
    entries.insert(entries.end(), flight_entries().begin(), flight_entries().end());
    entries.insert(entries.end(), modbus_entries().begin(), modbus_entries().end());
    return entries;
  }();
  return all;
}
std::span<const Entry<BuildingSourceSpec>> building_entries() { return kBuildings; }
std::span<const Entry<PrismSpec>> prism_entries() { return kPrisms; }
std::span<const Entry<SurfaceSpec>> surface_entries() { return kSurfaces; }
std::span<const Entry<MaterialKeys>> material_entries() { return kMaterials; }
std::span<const SpecialKey> special_keys() { return kSpecial; }
std::span<const Choice> vertical_units() { return kVerticalUnits; }

}  // namespace obliq
