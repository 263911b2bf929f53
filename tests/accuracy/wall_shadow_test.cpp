// A wall of height H at ground distance g throws a shadow that ends at ground distance g y_c / (y_c - H): as
// slant range, in every azimuth bin, in the state, power and count planes.
#include <gtest/gtest.h>

#include <GeographicLib/LocalCartesian.hpp>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <sstream>

#include "tests/support/scenes.h"
#include "tests/unit/terrain_files.h"

namespace obliq {
namespace {

constexpr double kAntenna_m = 1000;  // y_c
constexpr double kWall_m = 100;      // H
constexpr double kDistance_m = 6000;

RadarSettings settings(FrustumKind kind) {
  RadarSettings s;
  s.frustum = kind;
  s.sector_deg = 40;
  s.r_min_m = 3700;
  s.r_max_m = 12000;
  s.azimuth_bins = 256;
  s.range_bins = 512;
  s.pixel_columns = 1024;
  s.pixel_rows = 2048;
  return s;
}

struct Wall {
  double near_m, far_m;  ///< ground distances of the top's edges, across the sector's centre
};

void check_shadow(const World& world, const Wall& wall, FrustumKind kind) {
  const RadarSettings s = settings(kind);
  const Frame frame = render(test::make_scene(world), test::snapshot(s),
                             test::pose_over_origin(world, kAntenna_m), {0, s.azimuth_bins});
  const double spacing = (s.r_max_m - s.r_min_m) / s.range_bins;
  const auto bin = [&](double ground, double below) {
    return static_cast<int>(std::floor((std::hypot(ground, below) - s.r_min_m) / spacing));
  };
  int worst_first = 0, worst_last = 0;
  for (int a = 0; a < s.azimuth_bins; ++a) {
    // The wall runs straight across: farther away towards the sector's sides.
    const double sector = s.sector_deg * std::numbers::pi / 180;
    const double aside = 1 / std::cos(sector * ((a + 0.5) / s.azimuth_bins - 0.5));
    // The foot of the wall, or its top's far edge, whichever is farther in slant range, is the last that
    // shows.
    const int expected_first =
        std::max(bin(wall.near_m * aside, kAntenna_m), bin(wall.far_m * aside, kAntenna_m - kWall_m)) + 1;
    const int expected_lit = bin(wall.far_m * aside * kAntenna_m / (kAntenna_m - kWall_m), kAntenna_m);
    // The longest run of shadow in this azimuth.
    const std::size_t row = static_cast<std::size_t>(a) * static_cast<std::size_t>(s.range_bins);
    int first = 0, end = 0;
    for (int r = 0; r < s.range_bins;) {
      int stop = r;
      while (stop < s.range_bins && frame.bins.state[row + static_cast<std::size_t>(stop)] == 2) ++stop;
      if (stop - r > end - first) first = r, end = stop;
      r = std::max(stop, r + 1);
    }
    worst_first = std::max(worst_first, std::abs(first - expected_first));
    worst_last = std::max(worst_last, std::abs(end - expected_lit));
    // Nothing returns from the shadow, and the first bin beyond it is lit within one bin.
    for (int r = first; r < end; ++r) {
      EXPECT_EQ(frame.bins.power_w[row + static_cast<std::size_t>(r)], 0);
      EXPECT_EQ(frame.bins.count[row + static_cast<std::size_t>(r)], 0u);
      EXPECT_EQ(std::abs(frame.bins.iq[row + static_cast<std::size_t>(r)]), 0);
    }
    int lit = first;
    while (lit < s.range_bins && !(frame.bins.power_w[row + static_cast<std::size_t>(lit)] > 0)) ++lit;
    EXPECT_LE(std::abs(lit - expected_lit), 1) << "azimuth bin " << a;
    EXPECT_LE(std::abs(end - expected_lit), 1) << "azimuth bin " << a;
    EXPECT_LE(std::abs(first - expected_first), 1) << "azimuth bin " << a;
    if (testing::Test::HasFailure()) break;
  }
  std::printf("    shadow begins within %d and ends within %d bins of %.1f m\n", worst_first, worst_last,
              spacing);
}

constexpr FrustumKind kKinds[] = {FrustumKind::oblique, FrustumKind::symmetric, FrustumKind::sweep};

TEST(WallShadow, OfAWallOfGroundEndsWhereSimilarTrianglesSay) {
  WorldSpec spec = test::synthetic_spec(SyntheticKind::wall, 13000, 20);
  spec.terrain.shape.height_m = kWall_m;
  spec.terrain.shape.distance_m = kDistance_m;  // a row of nodes: a crest without thickness
  spec.terrain.shape.width_m = 1e-3;
  const World world = load_world(spec);
  ASSERT_EQ(world.grid.height_at_m(0, kDistance_m), kWall_m);
  // The face rises within one cell: its foot stands 20 m nearer.
  for (const FrustumKind kind : kKinds) check_shadow(world, {kDistance_m - 20, kDistance_m}, kind);
}

TEST(WallShadow, OfABuildingEndsWhereSimilarTrianglesSay) {
  const test::Folder folder;
  WorldSpec spec = test::synthetic_spec(SyntheticKind::flat, 13000, 100);
  const GeographicLib::LocalCartesian tangent(spec.origin.latitude_deg, spec.origin.longitude_deg, 0);
  std::ostringstream ring;
  ring.precision(12);
  const double corners[5][2] = {{-3000, 0}, {3000, 0}, {3000, 30}, {-3000, 30}, {-3000, 0}};
  for (const auto& [x, back] : corners) {
    double latitude, longitude, height;
    // The position whose plumb line meets the plane y = 0 there: the flat ground of this scene is the plane.
    tangent.Reverse(x, kDistance_m + back, 0, latitude, longitude, height);
    ring << (ring.tellp() > 0 ? ", " : "") << "[" << longitude << ", " << latitude << "]";
  }
  spec.buildings.push_back({});
  spec.buildings.back().source =
      folder.text("wall.geojson", R"({"type": "FeatureCollection", "features": [{"type": "Feature",
        "properties": {"height": 100.0}, "geometry": {"type": "Polygon", "coordinates": [[)" +
                                      ring.str() + "]]}}]}");
  const World world = load_world(spec);
  ASSERT_EQ(world.buildings.list.size(), 1u);
  EXPECT_NEAR(static_cast<double>(world.buildings.list[0].roof_y_m), kWall_m, 1e-3);
  for (const FrustumKind kind : kKinds) check_shadow(world, {kDistance_m, kDistance_m + 30}, kind);
}

}  // namespace
}  // namespace obliq
