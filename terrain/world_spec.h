#pragma once
// What to load: plain values, filled from the scene file by server/control, read by terrain alone.
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace obliq {

enum class VerticalUnit { metre, foot, us_survey_foot };
enum class SyntheticKind { none, flat, ramp, ridge, wall, cone, hills };

/// Longitude and latitude in degrees, as polygons on the wire and in files have them.
struct LonLat {
  double longitude_deg = 0;
  double latitude_deg = 0;
};

/// A disc that a radar can see; the union of all reaches is loaded when no area is given.
struct Reach {
  LonLat centre;
  double radius_m = 0;
};

/// Shape of synthetic ground. Heights are world y above the (possibly curved) datum surface.
struct SyntheticSpec {
  double height_m =
      100;              ///< of the ridge's crest, wall's or cone's top; hills: the most they rise over base_m
  double base_m = 0;    ///< height of the ground around the shape
  double slope = 0.05;  ///< ramp: rise over run
  double bearing_deg = 0;     ///< ramp: uphill; ridge and wall: direction from the origin to the crest
  double distance_m = 10000;  ///< from the origin to the ridge's crest, the cone's apex, the wall's near face
  double width_m = 2000;      ///< ridge: foot to foot; wall: thickness; cone: base radius
  std::uint64_t seed = 1;     ///< hills
  std::optional<LonLat> anchor{};  ///< what distances and hills count from; empty: the scene's origin
};

struct TerrainSpec {
  std::vector<std::string> dem;      ///< any GDAL paths; later ones fill where earlier ones are void
  std::optional<VerticalUnit> unit;  ///< overrides what the bands say
  std::optional<std::string> crs;    ///< for rasters that carry none: any string GDAL understands
  SyntheticKind synthetic = SyntheticKind::none;
  SyntheticSpec shape;
  std::vector<LonLat> area;      ///< polygon; empty: the union of the reaches
  std::optional<double> cell_m;  ///< empty: auto
  double most_auto_posts = 0;    ///< auto cells become no finer than this many posts; 0: than the posting
  /// What water that the elevation models show is made of (terrain/dem/water_cells.h); empty: none is looked
  /// for.
  std::optional<std::uint8_t> water_material;
  /// Voids no wider than this are filled by interpolation; empty: the larger of 200 m and three postings.
  std::optional<double> fill_void_m;
  /// Folder of grids that were made before (terrain/cache/ground_cache.h); empty: none is used nor kept.
  std::string cache_folder;
  bool cache_keeps = true;  ///< false: nothing new is kept there
};

struct BuildingSourceSpec {
  std::string source;  ///< any OGR path
  std::string layer;   ///< empty: the first
  std::string height_field = "height";
  std::string unit;  ///< "", "m" or "ft": unit of bare numbers in the field
  double default_height_m = 8.0;
  std::uint8_t material = 1;
  bool corners = false;  ///< as stated there: WorldSpec::corners is the scene's
};

struct PrismSpec {
  std::string within;                  ///< any OGR path of polygons; empty: within_polygon
  std::vector<LonLat> within_polygon;  ///< both empty: the whole loaded area
  double per_km2 = 300;
  std::array<double, 2> width_m{10, 30};
  std::array<double, 2> length_m{10, 50};
  std::array<double, 2> height_m{4, 30};
  std::uint64_t seed = 7;
  std::uint8_t material = 1;
};

struct SurfaceSpec {
  std::string source;  ///< OGR polygons or a GDAL class raster
  std::string layer;
  std::string where;         ///< OGR attribute filter; empty: every feature
  std::vector<int> classes;  ///< class raster: the values that mean this material
  std::uint8_t material = 0;
  std::string scheme;  ///< class raster with a known legend, its name; empty: classes and material count
  std::vector<std::pair<int, std::uint8_t>> scheme_materials;  ///< of the legend's classes, by value
  /// A GDAL raster of decibels; empty: none. Of the ground that `source` paints, or where that is empty of
  /// all ground.
  std::string gamma_raster;
  bool raster_is_gamma = false;  ///< its values stand in place of the material's gamma; else they add to it
  bool paints = true;            ///< cells get `material`; false, without a source: they keep their own
};

struct WorldSpec {
  TerrainSpec terrain;
  std::vector<BuildingSourceSpec> buildings;
  std::vector<PrismSpec> prisms;
  std::vector<SurfaceSpec> surfaces;  ///< applied in order; later ones win
  bool corners = false;             ///< of walls and the ground before them: they return (Buildings::corners)
  double radius_factor = 4.0 / 3;   ///< effective earth; infinity: flat
  LonLat origin;                    ///< scene origin: the first radar's position
  std::vector<Reach> reaches;       ///< already with the 25 % margin
  double sampling_footprint_m = 0;  ///< finest sampling any radar does on the ground, for auto cells
};

}  // namespace obliq
