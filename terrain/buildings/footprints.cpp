#include "terrain/buildings/footprints.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <unordered_set>

#include "terrain/base/errors.h"
#include "terrain/base/hash.h"
#include "terrain/buildings/extrude.h"
#include "terrain/buildings/footprint_heights.h"
#include "terrain/buildings/odd_buildings.h"
#include "terrain/buildings/placement.h"

namespace obliq {
namespace {

constexpr std::uint64_t kProgressEvery = 64;  ///< outlines

bool usable(const GeoPolygon& polygon) {
  if (polygon.rings.empty() || polygon.rings[0].size() < 3) return false;
  for (const auto& ring : polygon.rings) {
    for (const LonLat& p : ring) {
      if (!std::isfinite(p.longitude_deg) || !(std::abs(p.latitude_deg) <= 90)) return false;
    }
  }
  return true;
}

/// The ground at the first of the outline's points that has any.
GroundPlace first_ground(const World& world, const GeoPolygon& polygon) {
  GroundPlace best;
  for (const LonLat& p : polygon.rings[0]) {
    const GroundPlace place = place_on_ground(world, p);
    if (place.state == GroundState::known) return place;
    if (place.state == GroundState::unknown) best = place;
  }
  return best;
}

void check(const BuildingSourceSpec& spec) {
  if (!(spec.default_height_m > 0) || spec.default_height_m > kTallest_m)
    throw InputError(
        fmt::format("[[buildings]] default_height_m: found {}; allowed: more than 0, at most 2000 m",
                    spec.default_height_m));
  if (!spec.unit.empty() && spec.unit != "m" && spec.unit != "ft")
    throw InputError("[[buildings]] unit: found \"" + spec.unit + "\"; allowed: \"m\" or \"ft\"");
}

/// True when the middle of the loaded ground lies inside the outline.
bool lies_around(const GeoPolygon& polygon, const GeoWindow& window) {
  const double x = (window.south_west.longitude_deg + window.north_east.longitude_deg) / 2;
  const double y = (window.south_west.latitude_deg + window.north_east.latitude_deg) / 2;
  Polygon degrees;
  for (const auto& ring : polygon.rings) {
    Ring& to = degrees.rings.emplace_back();
    for (const LonLat& p : ring) to.emplace_back(p.longitude_deg, p.latitude_deg);
  }
  return degrees.contains({x, y});
}

/// Outlines on their way into the world.
class FootprintLoader {
 public:
  FootprintLoader(World& world, const Polygon& area)
      : world_(world), area_(area), window_(geo_window(world)) {}

  const GeoWindow& window() const { return window_; }

  void add(const VectorFeature& feature, const BuildingSourceSpec& spec, SourceHeights& heights) {
    LoadReport& report = world_.report;
    ++report.buildings_read;
    if (feature.polygons.empty()) ++report.buildings_unusable;
    const FeatureHeight height = feature_height(feature, spec);
    const double height_m = height.height_m.value_or(spec.default_height_m);
    bool stands = false;
    for (const GeoPolygon& polygon : feature.polygons) {
      std::string excess;
      stands |= add_polygon(polygon, height_m, spec.material, excess);
      if (!excess.empty() && first_excess_.empty())
        first_excess_ = fmt::format("{}, feature {}: found {}", file_name(spec.source), feature.id(), excess);
    }
    if (!stands) return;
    heights.add(height, feature.id());
    if (!height.height_m) ++report.buildings_default_height;
  }

  void warn_of_excess() const {
    if (first_excess_.empty()) return;
    const std::uint64_t n = world_.report.buildings_too_complex;
    world_.report.warnings.push_back(fmt::format(
        "[[buildings]] {}{} skipped as too complex, the first is {}; simplify them (ogr2ogr -simplify)", n,
        n == 1 ? " outline was" : " outlines were", first_excess_));
  }

 private:
  bool add_polygon(const GeoPolygon& polygon, double height_m, std::uint8_t material, std::string& excess) {
    LoadReport& report = world_.report;
    if (!usable(polygon)) {
      ++report.buildings_unusable;
      return false;
    }
    std::size_t corners = 0;
    for (const auto& ring : polygon.rings) corners += ring.size();
    excess = excess_corners(corners);
    if (!excess.empty()) {
      ++report.buildings_too_complex;
      return false;
    }
    const GroundPlace place = first_ground(world_, polygon);
    const Polygon outline = world_polygon(world_.frame, polygon, place.height_m);
    if (place.state == GroundState::off_grid || !lies_inside(area_, outline)) {
      ++(lies_around(polygon, window_) ? report.buildings_around : report.buildings_outside);
      return false;
    }
    const Rect around = bounds(outline);
    if (std::max(around.x1_m - around.x0_m, around.z1_m - around.z0_m) > kWidest_m) {
      ++report.buildings_too_wide;
      return false;
    }
    if (place.state == GroundState::unknown) {
      ++report.buildings_no_ground;
      return false;
    }
    const std::uint64_t identity = outline_identity(polygon);
    if (!seen_.insert(identity).second) {
      ++report.buildings_duplicate;
      return false;
    }
    return stand_outline(world_, shaper_, outline, {height_m, material, identity}, &excess) > 0;
  }

  World& world_;
  const Polygon& area_;
  GeoWindow window_;
  OutlineShaper shaper_;
  std::unordered_set<std::uint64_t> seen_;
  std::string first_excess_;
};

/// The source's own field is not there; the others may hold heights all the same.
void warn_of_field(const BuildingSourceSpec& source, const VectorSummary& summary, LoadReport& report) {
  report.warnings.push_back(fmt::format(
      "[[buildings]] {}: none of its {} features has a height_field \"{}\"; the fields there are: {}",
      file_name(source.source), summary.visited, source.height_field, summary.fields));
}

}  // namespace

std::uint64_t outline_identity(const GeoPolygon& polygon) {
  std::vector<std::pair<std::int64_t, std::int64_t>> points;
  for (const LonLat& p : polygon.rings[0])
    points.emplace_back(std::llround(std::remainder(p.longitude_deg, 360.0) * 1e7),
                        std::llround(p.latitude_deg * 1e7));
  points.erase(std::unique(points.begin(), points.end()), points.end());
  while (points.size() > 1 && points.front() == points.back()) points.pop_back();
  std::rotate(points.begin(), std::min_element(points.begin(), points.end()), points.end());
  // From the least point on, the way round that has the lesser neighbour first.
  if (points.size() > 2 && points.back() < points[1]) std::reverse(points.begin() + 1, points.end());
  std::uint64_t hash = points.size();
  for (const auto& [x, y] : points) hash = hash_cell(hash, x, y);
  return hash;
}

bool lies_inside(const Polygon& area, const Polygon& outline) {
  return area.rings.empty() || std::all_of(outline.rings[0].begin(), outline.rings[0].end(),
                                           [&](glm::dvec2 p) { return area.contains(p); });
}

std::size_t stand_outline(World& world, OutlineShaper& shaper, const Polygon& polygon, const PrismLook& look,
                          std::string* excess) {
  LoadReport& report = world.report;
  const ShapedOutline shaped = shaper.shape(polygon);
  if (shaped.state == OutlineState::too_complex) ++report.buildings_too_complex;
  if (excess) *excess = shaped.excess;
  if (shaped.state == OutlineState::unusable) ++report.buildings_unusable;
  if (shaped.state == OutlineState::zero_area) ++report.buildings_zero_area;
  if (shaped.state == OutlineState::repaired) ++report.buildings_repaired;
  std::size_t stand = 0;
  for (std::size_t k = 0; k < shaped.parts.size(); ++k) {
    const Outline& part = shaped.parts[k];
    const Footing footing = footing_of(world.grid, part);
    if (footing.state == Footing::State::off_grid) {
      ++report.buildings_outside;
    } else if (footing.state == Footing::State::no_ground) {
      ++report.buildings_no_ground;
    } else {
      PrismLook own = look;
      own.identity = hash_cell(look.identity, 0, static_cast<std::int64_t>(k));
      append_prism(world.buildings, part, footing, own);
      ++stand;
    }
  }
  report.buildings_kept += stand;
  return stand;
}

void load_buildings(World& world, const WorldSpec& spec, const Polygon& area, const Progress& progress) {
  if (spec.buildings.empty()) return;
  FootprintLoader loader(world, area);
  for (std::size_t k = 0; k < spec.buildings.size(); ++k) {
    const BuildingSourceSpec& source = spec.buildings[k];
    check(source);
    const double share = static_cast<double>(k) / static_cast<double>(spec.buildings.size());
    bool has_field = false;
    std::uint64_t visited = 0;
    SourceHeights heights(source);
    VectorQuery query{source.source,
                      source.layer,
                      "",
                      "[[buildings]] source",
                      loader.window().south_west,
                      loader.window().north_east};
    if (source.height_field != BuildingSourceSpec{}.height_field) query.field = source.height_field;
    const VectorSummary summary = visit_features(query, [&](const VectorFeature& feature) {
      if (progress && visited++ % kProgressEvery == 0) progress("buildings", share);  // may end the load
      has_field = has_field || feature.text(source.height_field).has_value();
      loader.add(feature, source, heights);
    });
    world.report.buildings_read += summary.skipped_by_index;
    world.report.buildings_outside += summary.skipped_by_index;
    world.report.notes.insert(world.report.notes.end(), summary.notes.begin(), summary.notes.end());
    if (summary.visited == 0) {
      world.report.notes.push_back(source.source + ": no features in the loaded area");
    } else if (!has_field && heights.by_default() > 0) {
      warn_of_field(source, summary, world.report);
    }
    heights.report(world.report);
  }
  loader.warn_of_excess();
  const OddBuildings odd = count_odd(world.buildings);
  world.report.buildings_slivers = odd.slivers;
  world.report.buildings_copies = odd.copies;
  if (progress) progress("buildings", 1);
}

}  // namespace obliq
