#include "terrain/dem/source_error.h"

#include <algorithm>
#include <cmath>

#include "terrain/base/constants.h"

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

}  // namespace obliq
