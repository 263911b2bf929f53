#include "terrain/buildings/surfaces.h"

#include <fmt/core.h>
#include <gdal_priv.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <map>

#include "terrain/base/errors.h"
#include "terrain/base/parallel.h"
#include "terrain/buildings/gamma_raster.h"
#include "terrain/buildings/placement.h"
#include "terrain/dem/gdal_messages.h"
#include "terrain/dem/geodetic_lattice.h"
#include "terrain/dem/raster_values.h"
#include "terrain/dem/resample.h"

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

/// What the cells that a surface paints have of gamma rasters: NaN until its own has been read, 1 without
/// one.
float painted_gamma(const SurfaceSpec& surface) {
  return surface.gamma_raster.empty() ? 1.0F : std::numeric_limits<float>::quiet_NaN();
}

void paint_rows(World& world, RowCrossings& rows, const SurfaceSpec& surface) {
  const HeightGrid& grid = world.grid;
  const auto cell_after = [&](double x_m) {
    const double at = std::ceil((x_m - grid.x0_m) / grid.cell_m - 0.5);
    return static_cast<std::size_t>(std::clamp(at, 0.0, static_cast<double>(grid.nx - 1)));
  };
  for (std::size_t j = 0; j < rows.size(); ++j) {
    std::vector<double>& x_m = rows[j];
    std::sort(x_m.begin(), x_m.end());
    const std::size_t first = j * static_cast<std::size_t>(grid.nx - 1);
    const auto paint = [&](auto* cells, std::size_t k, auto value) {
      std::fill(cells + first + cell_after(x_m[k]), cells + first + cell_after(x_m[k + 1]), value);
    };
    for (std::size_t k = 0; k + 1 < x_m.size(); k += 2) {
      paint(world.surface_material.data(), k, surface.material);
      if (!world.raster_gamma.empty()) paint(world.raster_gamma.data(), k, painted_gamma(surface));
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
      paint_rows(world, rows, surface);
    }
  });
  world.report.notes.insert(world.report.notes.end(), summary.notes.begin(), summary.notes.end());
  if (summary.visited == 0) world.report.notes.push_back(surface.source + ": no features in the loaded area");
  if (too_long > 0)
    world.report.warnings.push_back(fmt::format(
        "[[surfaces]] {}: {} polygons were skipped, the first is feature {}: found more than 4 million edges "
        "once they are cut to 0.01 degrees; allowed: 4 million, so simplify it (ogr2ogr -simplify)",
        file_name(surface.source), too_long, first_too_long));
  if (unusable > 0)
    world.report.notes.push_back(
        fmt::format("{}: {} polygons are not usable and were skipped", surface.source, unusable));
}

}  // namespace

void paint_surfaces(World& world, const WorldSpec& spec, const Progress& progress) {
  if (spec.surfaces.empty()) return;
  const HeightGrid& grid = world.grid;
  const std::size_t cells = static_cast<std::size_t>(grid.nx - 1) * static_cast<std::size_t>(grid.nz - 1);
  // Rasters alone leave the materials as they are.
  if (std::ranges::any_of(spec.surfaces, [](const SurfaceSpec& s) { return !s.source.empty() || s.paints; }))
    world.surface_material.resize(cells, 0);
  if (std::ranges::any_of(spec.surfaces, [](const SurfaceSpec& s) { return !s.gamma_raster.empty(); }))
    world.raster_gamma.assign(cells, 1.0F);
  const GeoWindow window = geo_window(world);
  for (std::size_t k = 0; k < spec.surfaces.size(); ++k) {
    if (progress) progress("surfaces", static_cast<double>(k) / static_cast<double>(spec.surfaces.size()));
    const SurfaceSpec& surface = spec.surfaces[k];
    if (surface.source.empty() && !surface.gamma_raster.empty()) {
      // All ground that the raster knows.
    } else if (surface.classes.empty() && surface.scheme.empty()) {
      paint_polygons(world, surface, window);
    } else {
      paint_classes(world, surface);
    }
    if (!surface.gamma_raster.empty()) apply_gamma_raster(world, surface);
  }
  if (progress) progress("surfaces", 1);
}

namespace {

constexpr double kMostPixels = 0x1p30;

/// What a pixel's byte says: nothing is wanted of it, its class has no material, or which of the materials it
/// has, counted from kFirst on.
constexpr std::uint8_t kUnwanted = 0;
constexpr std::uint8_t kNone = 1;
constexpr std::uint8_t kFirst = 2;

/// Materials of a raster's classes.
class Legend {
 public:
  explicit Legend(const SurfaceSpec& surface) : whole_(!surface.scheme.empty()) {
    for (const int value : surface.classes) add(value, surface.material);
    for (const auto& [value, material] : surface.scheme_materials) add(value, material);
  }

  std::uint8_t code(double value) {
    if (value != newest_) {
      newest_ = value;
      newest_code_ = look_up(value);
    }
    return newest_code_;
  }

  std::uint8_t material(std::uint8_t code) const { return materials_[code - kFirst]; }

  /// The first few values that have no material.
  std::string without() const {
    std::string text;
    for (const double value : without_) {
      const std::string number = fmt::format("{}{:g}", text.empty() ? "" : ", ", value);
      text += number;
    }
    return text.empty() ? "no value" : text;
  }

 private:
  void add(int value, std::uint8_t material) {
    auto at = std::ranges::find(materials_, material);
    if (at == materials_.end()) at = materials_.insert(at, material);
    codes_[value] = static_cast<std::uint8_t>(kFirst + (at - materials_.begin()));
  }

  std::uint8_t look_up(double value) {
    const auto found = std::isnan(value) ? codes_.end() : codes_.find(value);
    if (found != codes_.end()) return found->second;
    if (!whole_) return kUnwanted;
    constexpr std::size_t kMostNamed = 8;
    if (without_.size() < kMostNamed && std::ranges::find(without_, value) == without_.end() &&
        !std::isnan(value))
      without_.push_back(value);
    return kNone;
  }

  bool whole_;  ///< every class should have a material
  std::map<double, std::uint8_t> codes_;
  std::vector<std::uint8_t> materials_;
  std::vector<double> without_;
  double newest_ = std::numeric_limits<double>::quiet_NaN();  ///< neighbours are mostly alike
  std::uint8_t newest_code_ = kUnwanted;
};

/// One byte a pixel of a window.
struct ClassWindow {
  PixelRect rect;
  std::vector<std::uint8_t> code;

  std::uint8_t at(double column, double row) const {
    const double c = std::floor(column + 0.5) - rect.column0;
    const double r = std::floor(row + 0.5) - rect.row0;
    if (!(c >= 0 && r >= 0 && c < rect.columns() && r < rect.rows())) return kUnwanted;
    return code[static_cast<std::size_t>(r) * static_cast<std::size_t>(rect.columns()) +
                static_cast<std::size_t>(c)];
  }
};

ClassWindow read_classes(const Raster& raster, const PixelRect& rect, Legend& legend) {
  if (static_cast<double>(rect.columns()) * rect.rows() > kMostPixels)
    raster.refuse("the loaded area has more than 2^30 of its pixels", "a coarser raster or a smaller area");
  ClassWindow window;
  window.rect = rect;
  require_whole_file(raster, rect.row1);
  window.code.reserve(static_cast<std::size_t>(rect.columns()) * static_cast<std::size_t>(rect.rows()));
  std::vector<double> line(static_cast<std::size_t>(rect.columns()));
  GdalMessages messages;
  for (int r = rect.row0; r < rect.row1; ++r) {
    const CPLErr error = raster.band().RasterIO(GF_Read, rect.column0, r, rect.columns(), 1, line.data(),
                                                rect.columns(), 1, GDT_Float64, 0, 0, nullptr);
    if (error != CE_None || !messages.failure().empty())
      raster.refuse(fmt::format("row {} cannot be read: {}", r, messages.reason("the file is damaged")),
                    "a whole, readable raster");
    for (const double value : line) window.code.push_back(legend.code(value));
  }
  return window;
}

}  // namespace

void paint_classes(World& world, const SurfaceSpec& surface) {
  const HeightGrid& grid = world.grid;
  const Raster raster(surface.source, "[[surfaces]] source", {});
  const GeodeticLattice geodetic =
      geodetic_lattice(world.frame, {grid.x0_m, grid.z0_m, grid.x1_m(), grid.z1_m()});
  const PostLattice lattice = post_lattice(geodetic, raster);
  const double turn = raster.turn_columns();
  Legend legend(surface);
  std::atomic<std::uint64_t> without{0};
  for (double turns : {0.0, -1.0, 1.0}) {
    if (turns != 0 && turn == 0) continue;
    const PixelRect rect = needed_pixels(lattice, grid, raster, 1, turns * turn);
    if (rect.empty()) continue;
    const ClassWindow window = read_classes(raster, rect, legend);
    for_each_row(grid.nz - 1, [&](int j) {
      const std::size_t first = world.cell_index(0, j);
      std::uint64_t none = 0;
      for_each_cell_place(grid, j, lattice, [&](int i, double column, double row) {
        const std::uint8_t code = window.at(column + turns * turn, row);
        const std::size_t cell = first + static_cast<std::size_t>(i);
        if (code >= kFirst) {
          world.surface_material[cell] = legend.material(code);
          if (!world.raster_gamma.empty()) world.raster_gamma[cell] = painted_gamma(surface);
        }
        if (code == kNone && grid.cell_known(i, j)) ++none;
      });
      without += none;
    });
  }
  if (without == 0) return;
  const double cells = static_cast<double>(grid.nx - 1) * (grid.nz - 1);
  const std::string count =
      fmt::format("{} cells ({:.2g} %) are of a class without a material in the scheme \"", without.load(),
                  100 * static_cast<double>(without) / cells);
  world.report.notes.push_back(
      fmt::format("[[surfaces]] {}: {}{}\" ({}); they keep the material that they have without it",
                  surface.source, count, surface.scheme, legend.without()));
}

}  // namespace obliq
