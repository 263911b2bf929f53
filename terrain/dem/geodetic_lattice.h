#pragma once
// The exact map from world (x, z) and height to the earth, kept sparsely.
#include <functional>
#include <glm/vec2.hpp>
#include <vector>

#include "terrain/dem/raster.h"
#include "terrain/frames.h"
#include "terrain/height_grid.h"
#include "terrain/polygon.h"

namespace obliq {

/// Nodes every kLatticeStep_m in world x and z, one more than needed on every side, each with its exact
/// geodetic position at two heights. Between nodes cubic (Lagrange, 4 x 4 nodes).
///
/// Why two heights: a plumb line is not parallel to world y away from the origin. On a sphere the position of
/// the point of height h above world (x, z) is a function of x / (R + h), so positions are interpolated
/// linearly in h / (R + h), which leaves no error of first order in x, and y linearly in h. Errors of
/// place and height, by test: under 1 mm to 110 km and 3 km of height, under 1 cm to 200 km and 9 km.
struct GeodeticLattice {
  static constexpr double kStep_m = 2048;
  static constexpr double kHigh_m = 4000;  ///< the upper layer; the lower one is at height 0

  double x0_m = 0;
  double z0_m = 0;
  int nx = 0;
  int nz = 0;
  /// [layer][nz * nx]. Longitudes run on from the origin's without a jump at +-180.
  std::vector<double> longitude_deg[2];
  std::vector<double> latitude_deg[2];
  std::vector<double> y_m[2];  ///< world y, lift included

  std::size_t size() const { return static_cast<std::size_t>(nx) * static_cast<std::size_t>(nz); }
};

GeodeticLattice geodetic_lattice(const WorldFrame& frame, const Rect& rect);

/// The same nodes in the post coordinates of one raster. Infinite where the raster's projection ends.
struct PostLattice {
  const GeodeticLattice* geodetic = nullptr;
  std::vector<double> column[2];
  std::vector<double> row[2];
};

PostLattice post_lattice(const GeodeticLattice& geodetic, const Raster& raster);

/// Share of the upper layer at height h; goes on outside the two layers.
double layer_share(double height_m);

/// One world point as a lattice sees it, still as a function of height.
struct LatticePoint {
  double column[2] = {0, 0};
  double row[2] = {0, 0};
  double y_m[2] = {0, 0};

  double world_y_m(double height_m) const {
    return y_m[0] + height_m / GeodeticLattice::kHigh_m * (y_m[1] - y_m[0]);
  }
};

/// Everything at one world z: the lattice's columns, already interpolated in z.
class LatticeRow {
 public:
  LatticeRow(const PostLattice& lattice, double z_m);

  LatticePoint at(double x_m) const;
  /// First of the four lattice columns that at(x) uses.
  int first_column(double x_m) const;
  const std::vector<LatticePoint>& points() const { return points_; }

 private:
  double x0_m_;
  std::vector<LatticePoint> points_;
};

/// Where nodes [i0, i1) of one row of the grid lie in a raster's post coordinates: to[i1 - i0], columns and
/// rows. Unknown nodes count as of height 0.
void node_places(const HeightGrid& grid, int j, int i0, int i1, const PostLattice& lattice, glm::dvec2* to);

/// Calls at(i, column, row) for the cells of one row of the grid: where the ground over the cell's centre
/// lies in a raster's post coordinates.
void for_each_cell_place(const HeightGrid& grid, int j, const PostLattice& lattice,
                         const std::function<void(int i, double column, double row)>& at);

}  // namespace obliq
