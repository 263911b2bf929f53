#include "terrain/buildings/prisms_random.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "terrain/base/errors.h"
#include "terrain/base/hash.h"
#include "terrain/base/units.h"
#include "terrain/buildings/footprints.h"
#include "terrain/buildings/placement.h"

namespace obliq {
namespace {

/// Mean length of a degree of a meridian on WGS84; densities are meant to a percent at best.
constexpr double kDegree_m = 111133;

/// About 5 GB of mesh.
constexpr double kMostPrisms = 8e6;

void check(const PrismSpec& spec) {
  if (!(spec.per_km2 >= 0) || spec.per_km2 > 1e5)
    throw InputError(fmt::format("[[prisms]] per_km2: found {}; allowed: 0 (none) to 100000", spec.per_km2));
  for (const auto& [key, range] : {std::pair{"width_m", spec.width_m}, std::pair{"length_m", spec.length_m},
                                   std::pair{"height_m", spec.height_m}}) {
    if (!(range[0] > 0) || !(range[0] <= range[1]) || !(range[1] <= 2000))
      throw InputError(
          fmt::format("[[prisms]] {}: found [{}, {}]; allowed: [least, most] with 0 < least <= most <= 2000",
                      key, range[0], range[1]));
  }
}

/// The edges of one polygon, sorted into rows of cells, so that a candidate meets the few edges at its
/// latitude.
class RowedPolygon {
 public:
  /// Of the rows that the window touches.
  RowedPolygon(const GeoPolygon& polygon, const PrismCells& cells, const GeoWindow& window) {
    double south = HUGE_VAL, north = -HUGE_VAL;
    for (const auto& ring : polygon.rings) {
      for (const LonLat& p : ring) {
        if (!std::isfinite(p.longitude_deg) || !(std::abs(p.latitude_deg) <= 90)) return;
        south = std::min(south, p.latitude_deg);
        north = std::max(north, p.latitude_deg);
      }
    }
    south = std::max(south, window.south_west.latitude_deg);
    north = std::min(north, window.north_east.latitude_deg);
    if (!(south <= north)) return;
    first_ = cells.row_of(south);
    edges_.resize(static_cast<std::size_t>(cells.row_of(north) - first_ + 1));
    const double middle_deg = (window.south_west.longitude_deg + window.north_east.longitude_deg) / 2;
    for (const auto& ring : polygon.rings) add_ring(ring, cells, middle_deg);
  }

  std::int64_t first_row() const { return first_; }
  std::int64_t end_row() const { return first_ + static_cast<std::int64_t>(edges_.size()); }
  double west_deg() const { return west_deg_; }
  double east_deg() const { return east_deg_; }

  bool contains(std::int64_t row, const LonLat& p) const {
    bool inside = false;
    for (const Edge& e : edges_[static_cast<std::size_t>(row - first_)]) {
      if ((e.a.latitude_deg <= p.latitude_deg) == (e.b.latitude_deg <= p.latitude_deg)) continue;
      const double t = (p.latitude_deg - e.a.latitude_deg) / (e.b.latitude_deg - e.a.latitude_deg);
      if (e.a.longitude_deg + t * (e.b.longitude_deg - e.a.longitude_deg) <= p.longitude_deg)
        inside = !inside;
    }
    return inside;
  }

 private:
  struct Edge {
    LonLat a, b;
  };

  void add_ring(std::vector<LonLat> ring, const PrismCells& cells, double near_longitude_deg) {
    for (LonLat& p : ring) {
      p.longitude_deg += 360 * std::round((near_longitude_deg - p.longitude_deg) / 360);
      west_deg_ = std::min(west_deg_, p.longitude_deg);
      east_deg_ = std::max(east_deg_, p.longitude_deg);
    }
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const Edge edge{ring[k], ring[(k + 1) % ring.size()]};
      const std::int64_t from = cells.row_of(std::min(edge.a.latitude_deg, edge.b.latitude_deg));
      const std::int64_t to = cells.row_of(std::max(edge.a.latitude_deg, edge.b.latitude_deg));
      for (std::int64_t row = std::max(from, first_); row <= std::min(to, end_row() - 1); ++row) {
        edges_[static_cast<std::size_t>(row - first_)].push_back(edge);
        if (++n_edges_ > kMostEdges)
          throw InputError(
              "[[prisms]] within: found a polygon with more than 32 million pieces of its edges between the "
              "rows of prisms; allowed: fewer, so simplify it or lower per_km2");
      }
    }
  }

  static constexpr std::size_t kMostEdges = std::size_t{1} << 25;  ///< about 1 GB

  std::int64_t first_ = 0;
  std::size_t n_edges_ = 0;
  std::vector<std::vector<Edge>> edges_;
  double west_deg_ = HUGE_VAL;
  double east_deg_ = -HUGE_VAL;
};

/// Rows and columns of the candidates inside any of the polygons and the window, each once, in order.
using CellList = std::vector<std::pair<std::int64_t, std::int64_t>>;

void add_cells(const RowedPolygon& polygon, const PrismCells& cells, const GeoWindow& window,
               CellList& list) {
  const double west = std::max(polygon.west_deg(), window.south_west.longitude_deg);
  const double east = std::min(polygon.east_deg(), window.north_east.longitude_deg);
  if (!(west <= east)) return;
  const std::int64_t from = std::max(polygon.first_row(), cells.row_of(window.south_west.latitude_deg));
  const std::int64_t to = std::min(polygon.end_row() - 1, cells.row_of(window.north_east.latitude_deg));
  for (std::int64_t row = from; row <= to; ++row) {
    const std::int64_t last = cells.column_of(row, east);
    for (std::int64_t column = cells.column_of(row, west); column <= last; ++column) {
      if (polygon.contains(row, cells.candidate(row, column).centre)) list.emplace_back(row, column);
    }
    if (static_cast<double>(list.size()) > kMostPrisms)
      throw InputError(
          "[[prisms]] per_km2: found more than 8 million prisms in the loaded area; allowed: "
          "fewer, so lower per_km2 or name smaller polygons in within");
  }
}

std::vector<GeoPolygon> polygons_of(const PrismSpec& spec, const GeoWindow& window, LoadReport& report) {
  std::vector<GeoPolygon> polygons;
  if (!spec.within.empty()) {
    const VectorQuery query{spec.within, "", "", "[[prisms]] within", window.south_west, window.north_east};
    const VectorSummary summary = visit_features(query, [&](const VectorFeature& feature) {
      polygons.insert(polygons.end(), feature.polygons.begin(), feature.polygons.end());
    });
    report.notes.insert(report.notes.end(), summary.notes.begin(), summary.notes.end());
    if (polygons.empty()) report.notes.push_back(spec.within + ": no polygons near the loaded area");
  } else if (!spec.within_polygon.empty()) {
    for (const LonLat& p : spec.within_polygon) {
      if (!std::isfinite(p.longitude_deg) || !(std::abs(p.latitude_deg) <= 90))
        throw InputError(
            "[[prisms]] within_polygon: found a point that is no longitude and latitude; allowed: "
            "degrees");
    }
    polygons.push_back({{spec.within_polygon}});
  } else {
    const LonLat &a = window.south_west, &b = window.north_east;
    polygons.push_back({{{a, {b.longitude_deg, a.latitude_deg}, b, {a.longitude_deg, b.latitude_deg}}}});
  }
  return polygons;
}

/// The candidate's four corners in the world, its length along its bearing.
Polygon rectangle(const PrismCandidate& c, const glm::dvec2& at) {
  const glm::dvec2 along = glm::dvec2(std::sin(c.bearing_rad), std::cos(c.bearing_rad)) * (c.length_m / 2);
  const glm::dvec2 across = glm::dvec2(std::cos(c.bearing_rad), -std::sin(c.bearing_rad)) * (c.width_m / 2);
  return {{{at - along - across, at - along + across, at + along + across, at + along - across}}};
}

}  // namespace

PrismCells::PrismCells(const PrismSpec& spec)
    : spec_(spec), side_m_(1000 / std::sqrt(spec.per_km2)), step_deg_(side_m_ / kDegree_m) {}

std::int64_t PrismCells::row_of(double latitude_deg) const {
  return static_cast<std::int64_t>(std::floor(latitude_deg / step_deg_));
}

double PrismCells::column_step_deg(std::int64_t row) const {
  const double middle_deg = std::min(89.9, std::abs((static_cast<double>(row) + 0.5) * step_deg_));
  return step_deg_ / std::cos(middle_deg * kDegree_rad);
}

std::int64_t PrismCells::column_of(std::int64_t row, double longitude_deg) const {
  return static_cast<std::int64_t>(std::floor(longitude_deg / column_step_deg(row)));
}

PrismCandidate PrismCells::candidate(std::int64_t row, std::int64_t column) const {
  PrismCandidate c;
  c.identity = hash_cell(spec_.seed, row, column);
  std::uint64_t state = c.identity;
  const auto uniform = [&](double low, double high) {
    state = mix64(state);
    return low + (high - low) * unit_from_hash(state);
  };
  c.width_m = uniform(spec_.width_m[0], spec_.width_m[1]);
  c.length_m = uniform(spec_.length_m[0], spec_.length_m[1]);
  c.height_m = uniform(spec_.height_m[0], spec_.height_m[1]);
  c.bearing_rad = uniform(0, std::numbers::pi);
  // A prism that fits stays inside its own cell, so neighbours do not run into each other.
  const double free = std::max(0.0, 1 - std::hypot(c.width_m, c.length_m) / side_m_);
  const double u = uniform(-free / 2, free / 2);
  const double v = uniform(-free / 2, free / 2);
  c.centre.latitude_deg = (static_cast<double>(row) + 0.5 + v) * step_deg_;
  c.centre.longitude_deg = (static_cast<double>(column) + 0.5 + u) * column_step_deg(row);
  return c;
}

void scatter_prisms(World& world, const WorldSpec& spec, const Polygon& area, const Progress& progress) {
  if (spec.prisms.empty()) return;
  const GeoWindow window = geo_window(world);
  OutlineShaper shaper;
  // Candidates that do not stand are no operator's buildings that went missing.
  const std::uint64_t outside = world.report.buildings_outside;
  const std::uint64_t no_ground = world.report.buildings_no_ground;
  for (const PrismSpec& prisms : spec.prisms) {
    check(prisms);
    if (prisms.per_km2 == 0) continue;
    const PrismCells cells(prisms);
    CellList list;
    for (const GeoPolygon& polygon : polygons_of(prisms, window, world.report))
      add_cells(RowedPolygon(polygon, cells, window), cells, window, list);
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    for (std::size_t n = 0; n < list.size(); ++n) {
      if (progress && n % 65536 == 0)
        progress("prisms", static_cast<double>(n) / static_cast<double>(list.size()));
      const PrismCandidate candidate = cells.candidate(list[n].first, list[n].second);
      const GroundPlace place = place_on_ground(world, candidate.centre);
      if (place.state != GroundState::known) continue;
      const Polygon outline = rectangle(candidate, {place.point.m.x, place.point.m.z});
      if (!lies_inside(area, outline)) continue;
      world.report.prisms_placed +=
          stand_outline(world, shaper, outline, {candidate.height_m, prisms.material, candidate.identity});
    }
  }
  world.report.buildings_outside = outside;
  world.report.buildings_no_ground = no_ground;
  if (progress) progress("prisms", 1);
}

}  // namespace obliq
