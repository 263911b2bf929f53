#include <gtest/gtest.h>

#include <GeographicLib/Geocentric.hpp>
#include <cmath>
#include <numbers>
#include <random>

#include "terrain/dem/geodetic_lattice.h"
#include "tests/unit/terrain_files.h"

namespace obliq {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

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
}  // namespace obliq
