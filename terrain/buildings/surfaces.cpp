#include "terrain/buildings/surfaces.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "terrain/base/errors.h"
#include "terrain/buildings/class_raster.h"
#include "terrain/buildings/placement.h"

namespace obliq {
namespace {

/// Longest edge that is taken as straight in the world, degrees: it leaves a meridian's or parallel's chord
/// by a few centimetres.
constexpr double kLongestEdge_deg = 0.01;

/// So many of these edges of one polygon take seconds: the coasts of all oceans at 1:10 million have half a
/// million corners.
constexpr double kMostPieces = 4e6;

/// x of the polygon's edges where they cross each row of cell centres.
using RowCrossings = std::vector<std::vector<double>>;

glm::dvec2 on_ground(const World& world, const LonLat& p) {
  const GroundPlace place = place_on_ground(world, p);
  return {place.point.m.x, place.point.m.z};
}

void add_edge(const HeightGrid& grid, glm::dvec2 a, glm::dvec2 b, RowCrossings& rows) {
  if (a.y > b.y) std::swap(a, b);
  const double first = std::ceil((a.y - grid.z0_m) / grid.cell_m - 0.5);
  const double last = std::ceil((b.y - grid.z0_m) / grid.cell_m - 0.5) - 1;
  const int j1 = static_cast<int>(std::min(last, static_cast<double>(grid.nz - 2)));
  for (int j = static_cast<int>(std::clamp(first, 0.0, static_cast<double>(grid.nz))); j <= j1; ++j) {
    const double z_m = grid.z0_m + (j + 0.5) * grid.cell_m;
    rows[static_cast<std::size_t>(j)].push_back(a.x + (z_m - a.y) / (b.y - a.y) * (b.x - a.x));
  }
}

bool finite(const GeoPolygon& polygon) {
  for (const auto& ring : polygon.rings) {
    for (const LonLat& p : ring) {
      if (!std::isfinite(p.longitude_deg) || !(std::abs(p.latitude_deg) <= 90)) return false;
    }
  }
  return true;
}

int pieces(const LonLat& a, const LonLat& b) {
  const double span_deg =
      std::max(std::abs(b.longitude_deg - a.longitude_deg), std::abs(b.latitude_deg - a.latitude_deg));
  return std::clamp(static_cast<int>(std::ceil(span_deg / kLongestEdge_deg)), 1, 36000);
}

/// Of all the edges of a polygon.
double pieces(const GeoPolygon& polygon) {
  double n = 0;
  for (const auto& ring : polygon.rings) {
    for (std::size_t k = 0; k < ring.size(); ++k) n += pieces(ring[k], ring[(k + 1) % ring.size()]);
  }
  return n;
}

/// Adds one ring's edges, each split so that it is straight in degrees.
void add_ring(const World& world, const std::vector<LonLat>& ring, RowCrossings& rows) {
  if (ring.size() < 3) return;
  glm::dvec2 from = on_ground(world, ring[0]);
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const LonLat a = ring[k];
    const LonLat b = ring[(k + 1) % ring.size()];
    const int n = pieces(a, b);
    for (int step = 1; step <= n; ++step) {
      const double t = static_cast<double>(step) / n;
      const glm::dvec2 to = on_ground(world, {a.longitude_deg + t * (b.longitude_deg - a.longitude_deg),
                                              a.latitude_deg + t * (b.latitude_deg - a.latitude_deg)});
      add_edge(world.grid, from, to, rows);
      from = to;
    }
  }
}

void paint_rows(World& world, RowCrossings& rows, std::uint8_t material) {
  const HeightGrid& grid = world.grid;
  const auto cell_after = [&](double x_m) {
    const double at = std::ceil((x_m - grid.x0_m) / grid.cell_m - 0.5);
    return static_cast<std::size_t>(std::clamp(at, 0.0, static_cast<double>(grid.nx - 1)));
  };
  for (std::size_t j = 0; j < rows.size(); ++j) {
    std::vector<double>& x_m = rows[j];
    std::sort(x_m.begin(), x_m.end());
    std::uint8_t* row = world.surface_material.data() + j * static_cast<std::size_t>(grid.nx - 1);
    for (std::size_t k = 0; k + 1 < x_m.size(); k += 2) {
      std::fill(row + cell_after(x_m[k]), row + cell_after(x_m[k + 1]), material);
    }
    x_m.clear();
  }
}

/// Longitude and latitude box around a polygon against the window; false when they cannot meet.
bool near(const GeoPolygon& polygon, const GeoWindow& window) {
  double south = HUGE_VAL, north = -HUGE_VAL;
  for (const LonLat& p : polygon.rings[0]) {
    south = std::min(south, p.latitude_deg);
    north = std::max(north, p.latitude_deg);
  }
  return south <= window.north_east.latitude_deg && north >= window.south_west.latitude_deg;
}

void paint_polygons(World& world, const SurfaceSpec& surface, const GeoWindow& window) {
  RowCrossings rows(static_cast<std::size_t>(world.grid.nz - 1));
  const VectorQuery query{surface.source,        surface.layer,     surface.where,
                          "[[surfaces]] source", window.south_west, window.north_east};
  std::uint64_t unusable = 0;
  std::uint64_t too_long = 0;
  std::int64_t first_too_long = 0;
  const VectorSummary summary = visit_features(query, [&](const VectorFeature& feature) {
    for (const GeoPolygon& polygon : feature.polygons) {
      if (polygon.rings.empty() || polygon.rings[0].size() < 3 || !finite(polygon)) {
        ++unusable;
        continue;
      }
      if (!near(polygon, window)) continue;
      if (pieces(polygon) > kMostPieces) {
        if (too_long++ == 0) first_too_long = feature.id();
        continue;
      }
      for (const auto& ring : polygon.rings) add_ring(world, ring, rows);
      paint_rows(world, rows, surface.material);
    }
  });
  world.report.notes.insert(world.report.notes.end(), summary.notes.begin(), summary.notes.end());
  if (summary.visited == 0) world.report.notes.push_back(surface.source + ": no features in the loaded area");
  if (too_long > 0) {
    world.report.warnings.push_back(fmt::format(
        "[[surfaces]] {}: {} polygons were skipped, the first is feature {}: found more than 4 million edges "
        "once they are cut to 0.01 degrees; allowed: 4 million, so simplify it (ogr2ogr -simplify)",
        file_name(surface.source), too_long, first_too_long));
  }
  if (unusable > 0) {
    world.report.notes.push_back(
        fmt::format("{}: {} polygons are not usable and were skipped", surface.source, unusable));
  }
}

}  // namespace

void paint_surfaces(World& world, const WorldSpec& spec, const Progress& progress) {
  if (spec.surfaces.empty()) return;
  const HeightGrid& grid = world.grid;
  world.surface_material.resize(static_cast<std::size_t>(grid.nx - 1) * static_cast<std::size_t>(grid.nz - 1),
                                0);
  const GeoWindow window = geo_window(world);
  for (std::size_t k = 0; k < spec.surfaces.size(); ++k) {
    if (progress) progress("surfaces", static_cast<double>(k) / static_cast<double>(spec.surfaces.size()));
    const SurfaceSpec& surface = spec.surfaces[k];
    if (surface.classes.empty() && surface.scheme.empty()) {
      paint_polygons(world, surface, window);
    } else {
      paint_classes(world, surface);
    }
  }
  if (progress) progress("surfaces", 1);
}

}  // namespace obliq
