// A tower given by longitude and latitude, through the whole program, against other programs and against
// earth-centred arithmetic that is written out here.
// A wall of height H at ground distance g throws a shadow that ends at ground distance g y_c / (y_c - H): as
// slant range, in every azimuth bin, in the state, power and count planes.
#include <gtest/gtest.h>

#include <GeographicLib/LocalCartesian.hpp>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <numbers>
#include <sstream>
#include <vector>

#include "tests/support/npy.h"
#include "tests/support/scenes.h"
#include "tests/unit/terrain_files.h"

namespace obliq::tower_test {
namespace {

constexpr double kDegree_rad = std::numbers::pi / 180;
using Vec = std::array<double, 3>;

// WGS84 (NIMA TR8350.2): semi-major axis and flattening.
constexpr double kA_m = 6378137.0;
constexpr double kF = 1 / 298.257223563;
constexpr double kE2 = kF * (2 - kF);

Vec ecef(double lon_deg, double lat_deg, double h) {
  const double lat = lat_deg * kDegree_rad, lon = lon_deg * kDegree_rad;
  const double n = kA_m / std::sqrt(1 - kE2 * std::sin(lat) * std::sin(lat));
  return {(n + h) * std::cos(lat) * std::cos(lon), (n + h) * std::cos(lat) * std::sin(lon),
          (n * (1 - kE2) + h) * std::sin(lat)};
}

struct Tangent {
  Vec o, east, north, up;

  Tangent(double lon_deg, double lat_deg) : o(ecef(lon_deg, lat_deg, 0)) {
    const double lat = lat_deg * kDegree_rad, lon = lon_deg * kDegree_rad;
    east = {-std::sin(lon), std::cos(lon), 0};
    north = {-std::sin(lat) * std::cos(lon), -std::sin(lat) * std::sin(lon), std::cos(lat)};
    up = {std::cos(lat) * std::cos(lon), std::cos(lat) * std::sin(lon), std::sin(lat)};
  }
  static double dot(const Vec& a, const Vec& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

  /// East, up, north with the effective-earth lift: the ellipsoid's own drop at the place is shrunk to 1/k.
  Vec world(const Vec& p, double k) const {
    const Vec d{p[0] - o[0], p[1] - o[1], p[2] - o[2]};
    const double x = dot(d, east), y = dot(d, up), z = dot(d, north);
    // Where the line through (x, z) along `up` meets the ellipsoid: X^2 + Y^2 + Z^2 / (1 - f)^2 = a^2.
    const double squash = 1 / ((1 - kF) * (1 - kF));
    const Vec q{o[0] + x * east[0] + z * north[0], o[1] + x * east[1] + z * north[1],
                o[2] + x * east[2] + z * north[2]};
    const double a = up[0] * up[0] + up[1] * up[1] + squash * up[2] * up[2];
    const double b = q[0] * up[0] + q[1] * up[1] + squash * q[2] * up[2];
    const double c = q[0] * q[0] + q[1] * q[1] + squash * q[2] * q[2] - kA_m * kA_m;
    const double y0 = -c / (b + std::sqrt(b * b - a * c));
    return {x, y - (1 - 1 / k) * y0, z};
  }
};

std::string output_of(const std::string& command) {
  std::string text;
  FILE* pipe = popen(command.c_str(), "r");
  char line[512];
  while (pipe && std::fgets(line, sizeof line, pipe)) text += line;
  if (pipe) pclose(pipe);
  return text;
}

constexpr double kLon = -118.3, kLat = 34.4;  // the antenna
constexpr double kGround_m = 300, kAntenna_m = 1500, kTower_m = 100, kDistance_m = 20000;
constexpr double kBearing_deg = 40, kSector_deg = 120, kRMin_m = 3700, kRMax_m = 37000;
constexpr int kBins = 1024;

struct Corner {
  double lon, lat;
};

/// A square of 60 m whose first side faces the antenna, on a sphere's arithmetic: its exact place does not
/// matter, since the file's coordinates are what is compared.
std::vector<Corner> square(double bearing_deg) {
  const double b = bearing_deg * kDegree_rad;
  std::vector<Corner> corners;
  for (const auto& [across, along] : {std::pair{-30.0, 0.0}, {30.0, 0.0}, {30.0, 60.0}, {-30.0, 60.0}}) {
    const double east = (kDistance_m + along) * std::sin(b) + across * std::cos(b);
    const double north = (kDistance_m + along) * std::cos(b) - across * std::sin(b);
    corners.push_back({kLon + east / (111320 * std::cos(kLat * kDegree_rad)), kLat + north / 110950});
  }
  return corners;
}

/// Renders the tower and compares; bearing of the tower in degrees. The scene's origin is its first radar,
/// that many degrees west of the one that looks.
void check_tower(double bearing_deg, const std::string& frustum, double radius_factor,
                 double origin_west_deg = 0) {
  const test::Folder folder;
  test::RasterPlan plan = test::around(kLon, kLat, [](double, double) { return kGround_m; });
  plan.columns = plan.rows = 901;
  plan.geotransform = {kLon - 450.5 / 900, 1.0 / 900, 0, kLat + 450.5 / 900, 0, -1.0 / 900};
  test::write_raster(folder, "plain.tif", plan);
  const std::vector<Corner> corners = square(bearing_deg);
  std::ostringstream ring;
  ring.precision(15);
  for (std::size_t k = 0; k <= 4; ++k)
    ring << (k ? ", " : "") << "[" << corners[k % 4].lon << ", " << corners[k % 4].lat << "]";
  folder.text("tower.geojson", R"({"type": "FeatureCollection", "features": [{"type": "Feature",
      "properties": {"height": 100.0}, "geometry": {"type": "Polygon", "coordinates": [[)" +
                                   ring.str() + "]]}}]}");
  std::ostringstream scene;
  scene.precision(15);
  scene << "[terrain]\ndem = [\"plain.tif\"]\ncell_m = 100.0\n[earth]\nradius_factor = " << std::showpoint
        << radius_factor << "\n[[buildings]]\nsource = \"tower.geojson\"\n[frustum]\nkind = \"" << frustum
        << "\"\n";
  for (const auto& [name, lon] : {std::pair{"origin", kLon - origin_west_deg}, {"main", kLon}})
    scene << "[[radar]]\nname = \"" << name << "\"\nsector_deg = " << kSector_deg << "\nr_min_m = " << kRMin_m
          << "\nr_max_m = " << kRMax_m << "\n[radar.antenna]\nlatitude_deg = " << kLat
          << "\nlongitude_deg = " << lon << "\nheight_m = " << kAntenna_m
          << "\nbearing_deg = " << kBearing_deg << "\n";
  const std::string toml = folder.text("scene.toml", scene.str());
  const std::string out = folder.file("out");
  ASSERT_EQ(std::system((OBLIQ_PROGRAM " render '" + toml + "' --radar main --out '" + out + "' >'" +
                         folder.file("log") + "' 2>&1")
                            .c_str()),
            0);

  // The bins that the near wall spans, by earth-centred arithmetic.
  const Tangent tangent(kLon - origin_west_deg, kLat);
  const Vec antenna = tangent.world(ecef(kLon, kLat, kAntenna_m), radius_factor);
  const Vec northwards = tangent.world(ecef(kLon, kLat + 1e-3, kAntenna_m), radius_factor);
  const double north = std::atan2(northwards[0] - antenna[0], northwards[2] - antenna[2]);
  double azimuth_low = 1e9, azimuth_high = -1e9, range_low = 1e9, range_high = -1e9;
  for (const std::size_t k : {0u, 1u}) {
    for (const double h : {kGround_m, kGround_m + kTower_m}) {
      const Vec p = tangent.world(ecef(corners[k].lon, corners[k].lat, h), radius_factor);
      const Vec d{p[0] - antenna[0], p[1] - antenna[1], p[2] - antenna[2]};
      const double offset_deg =
          (std::atan2(d[0], d[2]) - north) / kDegree_rad - (kBearing_deg - kSector_deg / 2);
      const double azimuth = offset_deg / kSector_deg * kBins;
      const double range = (std::sqrt(Tangent::dot(d, d)) - kRMin_m) / (kRMax_m - kRMin_m) * kBins;
      azimuth_low = std::min(azimuth_low, azimuth), azimuth_high = std::max(azimuth_high, azimuth);
      range_low = std::min(range_low, range), range_high = std::max(range_high, range);
    }
  }
  const auto power = test::read_npy<double>(out + "/power.npy");
  ASSERT_EQ(power.size(), static_cast<std::size_t>(kBins) * kBins);
  // Ground loses r^3 of power: the tower is the brightest after range normalisation.
  int best_a = 0, best_r = 0;
  double best = 0, inside = 0, around = 0;
  for (int a = 0; a < kBins; ++a) {
    for (int r = 0; r < kBins; ++r) {
      const double range = kRMin_m + (r + 0.5) * (kRMax_m - kRMin_m) / kBins;
      const double p =
          power[static_cast<std::size_t>(a) * kBins + static_cast<std::size_t>(r)] * range * range * range;
      if (p > best) best = p, best_a = a, best_r = r;
      const bool near = std::abs(a - azimuth_low) < 6 && std::abs(r - range_low) < 6;
      const bool on = a >= std::floor(azimuth_low) && a <= std::floor(azimuth_high) &&
                      r >= std::floor(range_low) && r <= std::floor(range_high);
      around += near ? p : 0;
      inside += on ? p : 0;
    }
  }
  std::printf(
      "    %s, k %.3g, bearing %.0f: wall in azimuth bins %.2f..%.2f, range bins %.2f..%.2f; brightest "
      "(%d, %d), %.2f %% of the neighbourhood's power in them\n",
      frustum.c_str(), radius_factor, bearing_deg, azimuth_low, azimuth_high, range_low, range_high, best_a,
      best_r, 100 * inside / around);
  EXPECT_GE(best_a, std::floor(azimuth_low));
  EXPECT_LE(best_a, std::floor(azimuth_high));
  EXPECT_GE(best_r, std::floor(range_low));
  EXPECT_LE(best_r, std::floor(range_high));
  // The rest is the ground of 120 bins around it.
  EXPECT_GT(inside / around, 0.9);

  // The map: ask gdallocationinfo where the wall's middle lies and what is there.
  const std::string map = out + "/ground_map.tif";
  std::ostringstream place;
  place.precision(15);
  place << (corners[0].lon + corners[1].lon) / 2 << " " << (corners[0].lat + corners[1].lat) / 2;
  int column = -1, line = -1;
  const std::string answer = output_of("gdallocationinfo -wgs84 '" + map + "' " + place.str());
  const std::size_t at = answer.find("Location: (");
  ASSERT_NE(at, std::string::npos) << answer;
  ASSERT_EQ(std::sscanf(answer.c_str() + at, "Location: (%dP,%dL)", &column, &line), 2) << answer;
  // Where the map itself is brightest within 10 pixels, as gdal_translate prints it.
  const std::string xyz = folder.file("near.xyz");
  ASSERT_EQ(std::system(("gdal_translate -q -b 1 -of XYZ -srcwin " + std::to_string(column - 10) + " " +
                         std::to_string(line - 10) + " 21 21 '" + map + "' '" + xyz + "'")
                            .c_str()),
            0);
  std::ifstream list(xyz);
  double x, y, value, brightest = -1e9;
  int n = 0, bright_n = 0;
  while (list >> x >> y >> value) {
    if (value > brightest) brightest = value, bright_n = n;
    ++n;
  }
  ASSERT_EQ(n, 441);
  std::printf("    map pixel (%d, %d); brightest %+d, %+d pixels away\n", column, line, bright_n % 21 - 10,
              bright_n / 21 - 10);
  EXPECT_LE(std::abs(bright_n % 21 - 10), 1);
  EXPECT_LE(std::abs(bright_n / 21 - 10), 1);
}

TEST(Tower, AppearsAtItsCoordinatesAndInItsBin) {
  check_tower(17, "sweep", 4.0 / 3);
  check_tower(73, "oblique", 4.0 / 3);
}

TEST(Tower, AppearsAtItsCoordinatesAndInItsBinFarFromTheScenesOrigin) {
  // 46 km: true north turns by 0.28 degrees, 2.4 azimuth bins.
  check_tower(17, "sweep", 4.0 / 3, 0.5);
}

TEST(Tower, AppearsInItsBinWithoutRefraction) { check_tower(40, "sweep", 1.0); }

constexpr double kAbove_m = 1000;  // y_c
constexpr double kWall_m = 100;    // H
constexpr double kWallAt_m = 6000;

RadarSettings settings(FrustumKind kind) {
  return test::radar_settings(kind, {3700, 12000, 40}, {256, 512}, {1024, 2048});
}

struct Wall {
  double near_m, far_m;  ///< ground distances of the top's edges, across the sector's centre
};

void check_shadow(const World& world, const Wall& wall, FrustumKind kind) {
  const RadarSettings s = settings(kind);
  const Frame frame = render(test::make_scene(world), test::snapshot(s),
                             test::pose_over_origin(world, kAbove_m), {0, s.azimuth_bins});
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
        std::max(bin(wall.near_m * aside, kAbove_m), bin(wall.far_m * aside, kAbove_m - kWall_m)) + 1;
    const int expected_lit = bin(wall.far_m * aside * kAbove_m / (kAbove_m - kWall_m), kAbove_m);
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
  spec.terrain.shape.distance_m = kWallAt_m;  // a row of nodes: a crest without thickness
  spec.terrain.shape.width_m = 1e-3;
  const World world = load_world(spec);
  ASSERT_EQ(world.grid.height_at_m(0, kWallAt_m), kWall_m);
  // The face rises within one cell: its foot stands 20 m nearer.
  for (const FrustumKind kind : kKinds) check_shadow(world, {kWallAt_m - 20, kWallAt_m}, kind);
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
    tangent.Reverse(x, kWallAt_m + back, 0, latitude, longitude, height);
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
  for (const FrustumKind kind : kKinds) check_shadow(world, {kWallAt_m, kWallAt_m + 30}, kind);
}

}  // namespace
}  // namespace obliq::tower_test
