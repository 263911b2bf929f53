// The grid against the program gdallocationinfo, which shares no frames, lattice or reader with us.
#include <gtest/gtest.h>

#include <GeographicLib/Geocentric.hpp>
#include <GeographicLib/LocalCartesian.hpp>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <numbers>
#include <random>

#include "terrain/dem/geodetic_lattice.h"
#include "tests/support/figures.h"
#include "tests/unit/terrain_files.h"

namespace obliq::georeference_test {
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
  const std::string name = "la_nasadem_30m/NASADEM_HGT_n34w119.tif";
  const std::string dem = test::shared_file(name);
  if (dem.empty()) GTEST_SKIP() << test::no_shared_file(name);
  WorldSpec spec = test::scene(-118.45, 34.05, 46250, {dem});
  spec.radius_factor = 4.0 / 3;
  // Cells fine enough for posts to be taken as they are. The file says that its pixels are points: posts
  // stand at whole arc seconds, as the product's guide says.
  spec.terrain.cell_m = 50;
  compare(load_world(spec), dem, {-119, 34, 1.0 / 3600}, kTolerance_m);
}

TEST(GridGeoreference, AgreesWithGdallocationinfoOnAThirdArcSecondTileOfAreas) {
  const std::string name = "nm_ned13_10m/USGS_NED_13_n37w108_Clipped.tif";
  const std::string dem = test::shared_file(name);
  if (dem.empty()) GTEST_SKIP() << test::no_shared_file(name);
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

/// Tangent-plane x, y, z of a geodetic position by earth-centred arithmetic alone.
glm::dvec3 tangent(double lon0, double lat0, double lon, double lat, double h) {
  const GeographicLib::Geocentric& earth = GeographicLib::Geocentric::WGS84();
  double a[3], b[3];
  earth.Forward(lat0, lon0, 0, a[0], a[1], a[2]);
  earth.Forward(lat, lon, h, b[0], b[1], b[2]);
  const double dx = b[0] - a[0], dy = b[1] - a[1], dz = b[2] - a[2];
  const double sl = std::sin(lat0 * kDegree), cl = std::cos(lat0 * kDegree);
  const double so = std::sin(lon0 * kDegree), co = std::cos(lon0 * kDegree);
  return {-so * dx + co * dy, cl * co * dx + cl * so * dy + sl * dz, -sl * co * dx - sl * so * dy + cl * dz};
}

double at_share(const double layers[2], double share) { return layers[0] + share * (layers[1] - layers[0]); }

struct Case {
  const char* crs;
  double lon, lat;         // scene origin
  double x0, y0, pixel;    // a one-pixel raster somewhere in the file's system
  double metres_per_post;  // nearly
};

const Case kCases[] = {{"EPSG:4326", -118.2, 34.1, -118.2, 34.1, 1e-3, 111},
                       {"EPSG:26911", -118.2, 34.1, 400e3, 3700e3, 1, 1},
                       {"EPSG:5070", -95.2, 61.0, 0, 4000e3, 1, 1},
                       {"EPSG:2276", -97, 32.8, 2400e3, 6900e3, 1, 0.3048}};

struct Worst {
  double place_m = 0;
  double y_m = 0;
};

Worst worst_error(const Case& k, double furthest_m, double highest_m) {
  const test::Folder folder;
  test::RasterPlan plan;
  plan.crs = k.crs;
  plan.columns = plan.rows = 1;
  plan.value = [](double, double) { return 0; };
  plan.geotransform = {k.x0, k.pixel, 0, k.y0, 0, k.pixel};
  const Raster raster(test::write_raster(folder, "one.tif", plan), "[terrain] dem", {});

  const WorldFrame frame(k.lat * kDegree, k.lon * kDegree, 4.0 / 3);
  const GeodeticLattice geodetic =
      geodetic_lattice(frame, {-furthest_m, -furthest_m, furthest_m, furthest_m});
  const PostLattice lattice = post_lattice(geodetic, raster);
  std::mt19937_64 random(1);
  const double span_deg = furthest_m / 111e3;
  std::uniform_real_distribution<double> side(-span_deg, span_deg), up(-400, highest_m);
  Worst worst;
  int compared = 0;
  while (compared < 2000) {
    const double lon = k.lon + side(random) / std::cos(k.lat * kDegree), lat = k.lat + side(random);
    const double h = up(random);
    const glm::dvec3 world = tangent(k.lon, k.lat, lon, lat, h);
    if (std::abs(world.x) > furthest_m || std::abs(world.z) > furthest_m) continue;
    ++compared;
    std::vector<double> column{lon}, row{lat};
    raster.posts_from_lonlat(column, row);
    const LatticePoint p = LatticeRow(lattice, world.z).at(world.x);
    const double share = layer_share(h);
    worst.place_m =
        std::max({worst.place_m, k.metres_per_post * std::abs(at_share(p.column, share) - column[0]),
                  k.metres_per_post * std::abs(at_share(p.row, share) - row[0])});
    worst.y_m = std::max(worst.y_m, std::abs(p.world_y_m(h) - (world.y - frame.lift_m(world.x, world.z))));
  }
  std::printf("%s to %.0f km and %.0f m up: place within %.1e m, height within %.1e m\n", k.crs,
              furthest_m / 1000, highest_m, worst.place_m, worst.y_m);
  return worst;
}

TEST(GeodeticLattice, ErrsByLessThanAMillimetreTo110KilometresWithThreeKilometresOfRelief) {
  for (const Case& k : kCases) {
    const Worst worst = worst_error(k, 110e3, 3000);
    EXPECT_LT(worst.place_m, 1e-3) << k.crs;
    EXPECT_LT(worst.y_m, 1e-3) << k.crs;
  }
}

TEST(GeodeticLattice, ErrsByLessThanACentimetreTo200KilometresWithNineKilometresOfRelief) {
  for (const Case& k : kCases) {
    const Worst worst = worst_error(k, 200e3, 9000);
    EXPECT_LT(worst.place_m, 1e-2) << k.crs;
    EXPECT_LT(worst.y_m, 1e-2) << k.crs;
  }
}

}  // namespace
}  // namespace obliq::georeference_test
