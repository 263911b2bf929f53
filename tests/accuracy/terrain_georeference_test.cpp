// The grid against the program gdallocationinfo, which knows nothing of our frames, lattice or reader.
#include <gtest/gtest.h>

#include <GeographicLib/LocalCartesian.hpp>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <numbers>
#include <random>

#include "tests/support/figures.h"
#include "tests/unit/terrain_files.h"

namespace obliq {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

struct Place {
  double longitude_deg, latitude_deg;
};

/// Heights of the pixels that hold these places, in the file's unit.
std::vector<double> ask_gdal(const test::Folder& folder, const std::string& dem,
                             const std::vector<Place>& at) {
  std::ofstream list(folder.file("places.txt"));
  list.precision(15);
  for (const Place& p : at) list << p.longitude_deg << " " << p.latitude_deg << "\n";
  list.close();
  const std::string command =
      "gdallocationinfo -valonly -wgs84 '" + dem + "' < '" + folder.file("places.txt") + "'";
  std::vector<double> heights;
  FILE* pipe = popen(command.c_str(), "r");
  char line[128];
  while (pipe && std::fgets(line, sizeof line, pipe)) {
    char* end = nullptr;
    const double h = std::strtod(line, &end);
    heights.push_back(end == line ? std::nan("") : h);
  }
  if (pipe) pclose(pipe);
  return heights;
}

struct Posts {
  double longitude_deg, latitude_deg;  // of any post
  double spacing_deg;
};

/// 1,000 random nodes of the grid: the height of each, taken back to longitude, latitude and height by
/// GeographicLib alone, against bilinear interpolation between the four posts that gdallocationinfo reports.
void compare(const World& world, const std::string& dem, const Posts& posts, double tolerance_m) {
  const test::Folder folder;
  const WorldFrame& frame = world.frame;
  const GeographicLib::LocalCartesian tangent(frame.origin_latitude_rad() / kDegree,
                                              frame.origin_longitude_rad() / kDegree, 0);
  std::mt19937_64 random(7);
  std::vector<Place> asked;
  std::vector<std::array<double, 3>> shares;  // s, t, height
  while (shares.size() < 1000) {
    const int i = static_cast<int>(random() % static_cast<unsigned>(world.grid.nx));
    const int j = static_cast<int>(random() % static_cast<unsigned>(world.grid.nz));
    if (!world.grid.node_known(i, j)) continue;
    const double x = world.grid.node_x_m(i), z = world.grid.node_z_m(j);
    double lat, lon, h;
    tangent.Reverse(x, z, world.grid.node_y_m(i, j) + frame.lift_m(x, z), lat, lon, h);
    const double u = (lon - posts.longitude_deg) / posts.spacing_deg;
    const double v = (lat - posts.latitude_deg) / posts.spacing_deg;
    shares.push_back({u - std::floor(u), v - std::floor(v), h});
    for (double dv : {0.0, 1.0}) {
      for (double du : {0.0, 1.0}) {
        asked.push_back({posts.longitude_deg + (std::floor(u) + du) * posts.spacing_deg,
                         posts.latitude_deg + (std::floor(v) + dv) * posts.spacing_deg});
      }
    }
  }
  const std::vector<double> heights = ask_gdal(folder, dem, asked);
  ASSERT_EQ(heights.size(), 4000u) << "gdallocationinfo did not answer";
  double worst_m = 0;
  int compared = 0;
  for (std::size_t n = 0; n < shares.size(); ++n) {
    const auto [s, t, h] = shares[n];
    const double* p = heights.data() + 4 * n;
    const double expected = (1 - t) * ((1 - s) * p[0] + s * p[1]) + t * ((1 - s) * p[2] + s * p[3]);
    if (std::isnan(expected)) continue;
    ++compared;
    worst_m = std::max(worst_m, std::abs(h - expected));
    EXPECT_NEAR(h, expected, tolerance_m) << asked[4 * n].longitude_deg << " " << asked[4 * n].latitude_deg;
  }
  std::printf("%d points, worst difference %.4f m\n", compared, worst_m);
  test::record_figure("grid_worst_m", worst_m);
  EXPECT_GT(compared, 990);
}

/// Root mean square difference between the grid's triangles and the DEM's bilinear surface at 1,000 random
/// places: what a grid of this cell loses between its nodes.
double rms_between_nodes_m(const World& world, const std::string& dem, const Posts& posts, double span_deg) {
  const test::Folder folder;
  const WorldFrame& frame = world.frame;
  const GeographicLib::LocalCartesian tangent(frame.origin_latitude_rad() / kDegree,
                                              frame.origin_longitude_rad() / kDegree, 0);
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> side(-span_deg, span_deg);
  std::vector<Place> at, asked;
  while (at.size() < 1000) {
    at.push_back({frame.origin_longitude_rad() / kDegree + side(random),
                  frame.origin_latitude_rad() / kDegree + side(random)});
    const double u = std::floor((at.back().longitude_deg - posts.longitude_deg) / posts.spacing_deg);
    const double v = std::floor((at.back().latitude_deg - posts.latitude_deg) / posts.spacing_deg);
    for (double dv : {0.0, 1.0}) {
      for (double du : {0.0, 1.0}) {
        asked.push_back({posts.longitude_deg + (u + du) * posts.spacing_deg,
                         posts.latitude_deg + (v + dv) * posts.spacing_deg});
      }
    }
  }
  const std::vector<double> heights = ask_gdal(folder, dem, asked);
  if (heights.size() != 4000) return HUGE_VAL;
  double squares = 0;
  for (std::size_t n = 0; n < at.size(); ++n) {
    const double u = (at[n].longitude_deg - asked[4 * n].longitude_deg) / posts.spacing_deg;
    const double v = (at[n].latitude_deg - asked[4 * n].latitude_deg) / posts.spacing_deg;
    const double* p = heights.data() + 4 * n;
    const double h = (1 - v) * ((1 - u) * p[0] + u * p[1]) + v * ((1 - u) * p[2] + u * p[3]);
    double x, z, y;
    tangent.Forward(at[n].latitude_deg, at[n].longitude_deg, h, x, z, y);
    const double difference = world.grid.height_at_m(x, z) - (y - frame.lift_m(x, z));
    squares += difference * difference;
  }
  const double rms_m = std::sqrt(squares / static_cast<double>(at.size()));
  std::printf("between nodes: %.3f m rms\n", rms_m);
  return rms_m;
}

/// Place within a millimetre on slopes of up to 2, heights settled to 1 mm, float32 steps of 0.1 mm.
constexpr double kTolerance_m = 5e-3;

TEST(GridGeoreference, AgreesWithGdallocationinfoOnANasademTileOfPoints) {
  const std::string dem = test::shared_file("la_nasadem_30m/NASADEM_HGT_n34w119.tif");
  if (dem.empty())
    GTEST_SKIP() << "no shared data: set OBLIQ_SHARED to the folder that holds data/la_nasadem_30m";
  WorldSpec spec = test::scene(-118.45, 34.05, 46250, {dem});
  spec.radius_factor = 4.0 / 3;
  // Cells fine enough for posts to be taken as they are. The file says that its pixels are points: posts
  // stand at whole arc seconds, as the product's guide says.
  spec.terrain.cell_m = 50;
  compare(load_world(spec), dem, {-119, 34, 1.0 / 3600}, kTolerance_m);
}

TEST(GridGeoreference, AgreesWithGdallocationinfoOnAThirdArcSecondTileOfAreas) {
  const std::string dem = test::shared_file("nm_ned13_10m/USGS_NED_13_n37w108_Clipped.tif");
  if (dem.empty())
    GTEST_SKIP() << "no shared data: set OBLIQ_SHARED to the folder that holds data/nm_ned13_10m";
  WorldSpec spec = test::scene(-107.585, 36.4, 12000, {dem});
  spec.radius_factor = 4.0 / 3;
  spec.terrain.cell_m = 10;
  // Upper left corner and pixel size by the program gdalinfo.
  const double pixel = 0.000092592593;
  const Posts posts{-107.704815288716006 + pixel / 2, 36.516296456968 - pixel / 2, pixel};
  const World world = load_world(spec);
  compare(world, dem, posts, kTolerance_m);
  // Badlands with cliffs, resampled once from 10 m posts to 10 m cells; a shift of half a post would be 0.6
  // m.
  EXPECT_LT(rms_between_nodes_m(world, dem, posts, 0.06), 0.3);
}

TEST(GridGeoreference, AgreesWithGdallocationinfo120KilometresFromTheOriginOnThreeKilometresOfRelief) {
  const test::Folder folder;
  test::RasterPlan plan = test::around(-118.5, 34, [](double lon, double lat) {
    return 1500 + 1500 * std::sin(40 * lon) * std::cos(33 * lat);
  });
  plan.columns = plan.rows = 241;
  plan.geotransform = {-118.5 - 120.5 / 1200, 1.0 / 1200, 0, 34 + 120.5 / 1200, 0, -1.0 / 1200};
  const std::string dem = test::write_raster(folder, "relief.tif", plan);
  WorldSpec spec = test::scene(-119.6, 34.6, 150e3, {dem});
  spec.radius_factor = 4.0 / 3;
  spec.terrain.cell_m = 40;
  compare(load_world(spec), dem, {-118.5, 34, 1.0 / 1200}, kTolerance_m);
}

}  // namespace
}  // namespace obliq
