#include "terrain/dem/source_error.h"

#include <fmt/core.h>
#include <gdal_priv.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "terrain/base/units.h"
#include "terrain/dem/load_report.h"
#include "terrain/grid_area.h"

namespace obliq {

namespace {

/// False where the surface at (x, z) could owe anything to nodes known so far, and off the grid.
bool over_unknown_cell(const HeightGrid& grid, double x_m, double z_m) {
  const double u = std::floor((x_m - grid.x0_m) / grid.cell_m);
  const double v = std::floor((z_m - grid.z0_m) / grid.cell_m);
  if (!(u >= 0 && v >= 0 && u < grid.nx - 1 && v < grid.nz - 1)) return false;
  const int i = static_cast<int>(u);
  const int j = static_cast<int>(v);
  return !grid.node_known(i, j) && !grid.node_known(i + 1, j) && !grid.node_known(i, j + 1) &&
         !grid.node_known(i + 1, j + 1);
}

// A linear error at 90 % is 1.6449 times the root mean square of a normal distribution.
constexpr double kLidar_m = 0.10;  // USGS Lidar Base Specification, quality level 2: RMSEz at most 0.10 m
constexpr double k3dep13_m =
    0.82;  // J. Stoker, B. Miller, Remote Sensing 14(4), 940, 2022: 3DEP, 1/3 arc-second
constexpr double kNed_m = 1.55;      // D. Gesch, M. Oimoen, G. Evans, USGS Open-File Report 2014-1008: NED
constexpr double kUsgs75_m = 7;      // USGS Standards for Digital Elevation Models, 1998: 7.5-minute, level 1
constexpr double kSrtm_m = 5.5;      // E. Rodriguez et al., PE&RS 72(3), 2006: LE90 of 9.0 m in North America
constexpr double kNasadem_m = 3.66;  // M. A. Aziz et al., Int. J. of Geoinformatics: 7757 GNSS points
constexpr double kAster_m = 8.52;    // ASTER GDEM version 3 validation, USGS 2020
constexpr double kCopernicus_m = 1.56;  // Copernicus DEM Product Handbook, Airbus 2022: LE90 of 2.57 m

struct Named {
  const char* part;  ///< of the file's name, in lower case
  const char* product;
  double rmse_m;
};
constexpr Named kNamed[] = {
    {"nasadem", "NASADEM", kNasadem_m},
    {"srtm", "SRTM", kSrtm_m},
    {"astgtm", "ASTER GDEM", kAster_m},
    {"gdem", "ASTER GDEM", kAster_m},
    {"copernicus", "Copernicus DEM", kCopernicus_m},
    {"cop-dem", "Copernicus DEM", kCopernicus_m},
    {"glo-30", "Copernicus DEM", kCopernicus_m},
    {"glo-90", "Copernicus DEM", kCopernicus_m},
    {"usgs_1m", "3DEP, 1 m", kLidar_m},
    {"usgs_13_", "3DEP, 1/3 arc-second", k3dep13_m},
    {"3dep", "3DEP", k3dep13_m},
    {"usgs_1_", "3DEP, 1 arc-second", kNed_m},
    {"usgs_ned", "NED", kNed_m},
};

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

constexpr double kLeastAllowed_m = 0.5;

/// Time of marching over ground with one cell a footprint, by a frame's other time. Of the sweep, measured
/// over mountains (30 m posts, 60 degrees, 3 to 22 km, 512 x 1024 bins) with cells of 60, 30, 15 and 7.5 m:
/// 184, 268, 472 and 862 ms, which is 100 ms and 47 m of cell. Frusta with pixels pay a ninth of this.
constexpr double kMarchShare = 5;

}  // namespace

SourceErrors::SourceErrors(const HeightGrid& grid)
    : spacing_m_(std::max(std::sqrt((grid.x1_m() - grid.x0_m) * (grid.z1_m() - grid.z0_m) / kPosts),
                          grid.cell_m / 2)) {}

PostSample SourceErrors::sample(const Raster& raster) const {
  return PostSample(static_cast<int>(std::clamp(std::ceil(spacing_m_ / raster.posting_m()), 1.0, 1e6)));
}

std::vector<WorldPoint> SourceErrors::place(const PostSample& sample, const Raster& raster,
                                            const WorldFrame& frame, const HeightGrid& grid) const {
  std::vector<double> longitude_deg, latitude_deg;
  for (const PostSample::Post& post : sample.posts()) {
    longitude_deg.push_back(post.column);
    latitude_deg.push_back(post.row);
  }
  raster.lonlat_from_posts(longitude_deg, latitude_deg);
  std::vector<WorldPoint> points;
  for (std::size_t n = 0; n < sample.posts().size(); ++n) {
    if (!std::isfinite(longitude_deg[n]) || !(std::abs(latitude_deg[n]) <= 90)) continue;
    const WorldPoint p = frame.world_from_geodetic(
        {latitude_deg[n] * kDegree_rad, longitude_deg[n] * kDegree_rad, sample.posts()[n].height_m});
    if (over_unknown_cell(grid, p.m.x, p.m.z)) points.push_back(p);
  }
  return points;
}

void SourceErrors::compare(const std::vector<WorldPoint>& points, const HeightGrid& grid) {
  for (const WorldPoint& p : points) {
    const double error_m = grid.height_at_m(p.m.x, p.m.z) - p.m.y;
    if (!std::isnan(error_m)) distances_.push_back({p.m.x, p.m.z, std::abs(error_m)});
  }
}

std::vector<glm::dvec2> SourceErrors::places(const HeightGrid& grid) const {
  std::vector<glm::dvec2> places;
  const int columns = static_cast<int>((grid.x1_m() - grid.x0_m) / spacing_m_);
  const int rows = static_cast<int>((grid.z1_m() - grid.z0_m) / spacing_m_);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const std::uint64_t hash = hash_cell(0, column, row);
      places.emplace_back(grid.x0_m + (column + unit_from_hash(hash)) * spacing_m_,
                          grid.z0_m + (row + unit_from_hash(mix64(hash))) * spacing_m_);
    }
  }
  return places;
}

SourceError SourceErrors::summary(const HeightGrid& grid) const {
  std::vector<double> errors_m;
  double squares = 0;
  for (const Distance& d : distances_) {
    if (std::isnan(grid.height_at_m(d.x_m, d.z_m))) continue;
    errors_m.push_back(d.error_m);
    squares += d.error_m * d.error_m;
  }
  SourceError error;
  error.posts = errors_m.size();
  if (errors_m.empty()) return error;
  std::sort(errors_m.begin(), errors_m.end());
  const auto at = [&](double share) {
    return errors_m[static_cast<std::size_t>(share * static_cast<double>(errors_m.size() - 1))];
  };
  error.median_m = at(0.5);
  error.p95_m = at(0.95);
  error.greatest_m = errors_m.back();
  error.rms_m = std::sqrt(squares / static_cast<double>(errors_m.size()));
  return error;
}

DemAccuracy dem_accuracy(const Raster& raster) {
  const std::string name = lower(file_name(raster.path()));
  for (const Named& named : kNamed) {
    if (name.find(named.part) != std::string::npos) return {named.product, named.rmse_m};
  }
  const std::string driver = raster.band().GetDataset()->GetDriverName();
  if (driver == "SRTMHGT") return {"SRTM", kSrtm_m};
  if (driver == "USGSDEM") return {"USGS 7.5-minute DEM", kUsgs75_m};
  // Names that say nothing: what is usual at this posting, of two the better one.
  const double posting_m = raster.posting_m();
  const bool whole = !GDALDataTypeIsFloating(raster.band().GetRasterDataType());
  if (posting_m <= 3) return {"lidar, by its posting", kLidar_m};
  if (posting_m <= 12) return {"3DEP at 1/3 arc-second, by its posting", k3dep13_m};
  if (posting_m <= 120) {
    if (whole) return {"SRTM, by its posting and whole numbers", kSrtm_m};
    return {"NED, by its posting", kNed_m};
  }
  return {"a model of unknown accuracy", 0};
}

double allowed_error_m(const DemAccuracy& accuracy) { return std::max(kLeastAllowed_m, accuracy.rmse_m / 2); }

double halving_time(double cell_m, double footprint_m) {
  const double march = kMarchShare * footprint_m / cell_m;
  return (1 + 2 * march) / (1 + march);
}

double finer_cell_m(const AutoCellLimits& limits, double cell_m, double posts, const SourceError& error,
                    std::string& left) {
  left.clear();
  if (!(limits.most_posts > 0) || error.posts == 0 || error.p95_m <= allowed_error_m(limits.accuracy))
    return 0;
  const double finer_m = round_to_quantum_m(cell_m / 2);
  if (4 * posts > limits.most_posts) {
    left = fmt::format("{:.3g} million posts, of {:.3g} million (a quarter of flight.max_megaposts)",
                       4e-6 * posts, 1e-6 * limits.most_posts);
  } else if (const double time = halving_time(cell_m, limits.footprint_m); time > kMostHalvingTime) {
    left = fmt::format("{:.3g} times the frame time, of {:.3g}", time, kMostHalvingTime);
  } else if (finer_m < cell_m) {
    return finer_m;
  }
  return 0;
}

}  // namespace obliq
