#include "terrain/dem/geodetic_lattice.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "terrain/base/parallel.h"
#include "terrain/base/units.h"

namespace obliq {

namespace {

constexpr double kMeanRadius_m = 6371000;

/// Where the plumb line's point of this height stands above world (x, z). Fixed point: a step dy changes the
/// height by dy cos(angle from the origin), so each round leaves 1 - cos of the error (1e-3 at 300 km).
Geodetic above(const WorldFrame& frame, double x_m, double z_m, double height_m, double& y_m) {
  y_m = frame.ellipsoid_y_m(x_m, z_m) - frame.lift_m(x_m, z_m) + height_m;
  Geodetic found;
  for (int round = 0; round < 8; ++round) {
    found = frame.geodetic_from_world(WorldPoint{glm::dvec3(x_m, y_m, z_m)});
    const double missing_m = height_m - found.height_m;
    if (std::abs(missing_m) < 1e-6) break;
    y_m += missing_m;
  }
  return found;
}

/// Weights of the cubic through nodes -1, 0, 1, 2 at t in [0, 1] (Lagrange).
std::array<double, 4> cubic_weights(double t) {
  return {-t * (t - 1) * (t - 2) / 6, (t + 1) * (t - 1) * (t - 2) / 2, -(t + 1) * t * (t - 2) / 2,
          (t + 1) * t * (t - 1) / 6};
}

/// Splits a position in steps into the first of four nodes and the fraction past the second.
int split(double position, int n, double& t) {
  const int base = std::clamp(static_cast<int>(std::floor(position)), 1, n - 3);
  t = position - base;
  return base - 1;
}

/// Longitudes may come back a full turn away: bring the middle near the raster and the rest near the middle.
void run_on(PostLattice& lattice, const Raster& raster) {
  const double turn = raster.turn_columns();
  if (turn == 0) return;
  const auto nearest = [turn](double column, double to) {
    return column + turn * std::round((to - column) / turn);
  };
  const double middle =
      nearest(lattice.column[0][lattice.column[0].size() / 2], (raster.columns() - 1) / 2.0);
  for (std::vector<double>& columns : lattice.column) {
    for (double& column : columns) column = nearest(column, middle);
  }
}

void add(LatticePoint& sum, double weight, const LatticePoint& p) {
  for (int layer = 0; layer < 2; ++layer) {
    sum.column[layer] += weight * p.column[layer];
    sum.row[layer] += weight * p.row[layer];
    sum.y_m[layer] += weight * p.y_m[layer];
  }
}

/// Where the point of a plumb line at world y lies in a raster.
glm::dvec2 place_at(const LatticePoint& p, double y_m) {
  const double height_m = GeodeticLattice::kHigh_m * (y_m - p.y_m[0]) / (p.y_m[1] - p.y_m[0]);
  const double share = layer_share(height_m);
  return {p.column[0] + share * (p.column[1] - p.column[0]), p.row[0] + share * (p.row[1] - p.row[0])};
}

/// Heights of a cell's corners stand for its centre's; unknown ones count as 0, where nothing is seen anyway.
double centre_y_m(const HeightGrid& grid, int i, int j) {
  double sum = 0;
  for (int dj : {0, 1}) {
    for (int di : {0, 1}) {
      if (grid.node_known(i + di, j + dj)) sum += grid.node_y_m(i + di, j + dj) / 4;
    }
  }
  return sum;
}

}  // namespace

double layer_share(double height_m) {
  constexpr double kTop = GeodeticLattice::kHigh_m / (kMeanRadius_m + GeodeticLattice::kHigh_m);
  return height_m / (kMeanRadius_m + height_m) / kTop;
}

GeodeticLattice geodetic_lattice(const WorldFrame& frame, const Rect& rect) {
  constexpr double kStep_m = GeodeticLattice::kStep_m;
  GeodeticLattice lattice;
  const double i0 = std::floor(rect.x0_m / kStep_m) - 1;
  const double j0 = std::floor(rect.z0_m / kStep_m) - 1;
  lattice.x0_m = i0 * kStep_m;
  lattice.z0_m = j0 * kStep_m;
  lattice.nx = static_cast<int>(std::floor(rect.x1_m / kStep_m) - i0) + 3;
  lattice.nz = static_cast<int>(std::floor(rect.z1_m / kStep_m) - j0) + 3;
  const double origin_deg = frame.origin_longitude_rad() / kDegree_rad;
  for (int layer = 0; layer < 2; ++layer) {
    lattice.longitude_deg[layer].resize(lattice.size());
    lattice.latitude_deg[layer].resize(lattice.size());
    lattice.y_m[layer].resize(lattice.size());
  }
  for_each_row(lattice.nz, [&](int j) {
    for (int i = 0; i < lattice.nx; ++i) {
      const std::size_t n =
          static_cast<std::size_t>(j) * static_cast<std::size_t>(lattice.nx) + static_cast<std::size_t>(i);
      for (int layer = 0; layer < 2; ++layer) {
        const Geodetic g = above(frame, lattice.x0_m + i * kStep_m, lattice.z0_m + j * kStep_m,
                                 layer * GeodeticLattice::kHigh_m, lattice.y_m[layer][n]);
        const double longitude_deg = g.longitude_rad / kDegree_rad;
        lattice.longitude_deg[layer][n] =
            longitude_deg + 360 * std::round((origin_deg - longitude_deg) / 360);
        lattice.latitude_deg[layer][n] = g.latitude_rad / kDegree_rad;
      }
    }
  });
  return lattice;
}

PostLattice post_lattice(const GeodeticLattice& geodetic, const Raster& raster) {
  PostLattice lattice;
  lattice.geodetic = &geodetic;
  for (int layer = 0; layer < 2; ++layer) {
    lattice.column[layer] = geodetic.longitude_deg[layer];
    lattice.row[layer] = geodetic.latitude_deg[layer];
    raster.posts_from_lonlat(lattice.column[layer], lattice.row[layer]);
  }
  run_on(lattice, raster);
  return lattice;
}

LatticeRow::LatticeRow(const PostLattice& lattice, double z_m) : x0_m_(lattice.geodetic->x0_m) {
  const GeodeticLattice& g = *lattice.geodetic;
  double t = 0;
  const int first = split((z_m - g.z0_m) / GeodeticLattice::kStep_m, g.nz, t);
  const std::array<double, 4> weights = cubic_weights(t);
  points_.assign(static_cast<std::size_t>(g.nx), LatticePoint{});
  for (int k = 0; k < 4; ++k) {
    for (int i = 0; i < g.nx; ++i) {
      const std::size_t n =
          static_cast<std::size_t>(first + k) * static_cast<std::size_t>(g.nx) + static_cast<std::size_t>(i);
      LatticePoint p;
      for (int layer = 0; layer < 2; ++layer) {
        p.column[layer] = lattice.column[layer][n];
        p.row[layer] = lattice.row[layer][n];
        p.y_m[layer] = g.y_m[layer][n];
      }
      add(points_[static_cast<std::size_t>(i)], weights[static_cast<std::size_t>(k)], p);
    }
  }
}

int LatticeRow::first_column(double x_m) const {
  double t = 0;
  return split((x_m - x0_m_) / GeodeticLattice::kStep_m, static_cast<int>(points_.size()), t);
}

LatticePoint LatticeRow::at(double x_m) const {
  double t = 0;
  const int first = split((x_m - x0_m_) / GeodeticLattice::kStep_m, static_cast<int>(points_.size()), t);
  const std::array<double, 4> weights = cubic_weights(t);
  LatticePoint sum;
  for (std::size_t k = 0; k < 4; ++k) add(sum, weights[k], points_[static_cast<std::size_t>(first) + k]);
  return sum;
}

void node_places(const HeightGrid& grid, int j, int i0, int i1, const PostLattice& lattice, glm::dvec2* to) {
  const LatticeRow row(lattice, grid.node_z_m(j));
  for (int i = i0; i < i1; ++i) {
    const double y_m = grid.node_known(i, j) ? grid.node_y_m(i, j) : 0;
    *to++ = place_at(row.at(grid.node_x_m(i)), y_m);
  }
}

void for_each_cell_place(const HeightGrid& grid, int j, const PostLattice& lattice,
                         const std::function<void(int i, double column, double row)>& at) {
  const LatticeRow row(lattice, grid.node_z_m(j) + grid.cell_m / 2);
  for (int i = 0; i < grid.nx - 1; ++i) {
    const glm::dvec2 place = place_at(row.at(grid.node_x_m(i) + grid.cell_m / 2), centre_y_m(grid, i, j));
    at(i, place.x, place.y);
  }
}

}  // namespace obliq
