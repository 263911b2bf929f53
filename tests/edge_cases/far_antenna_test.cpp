// The antenna far from the scene's origin, near a pole and on the antimeridian: a tower falls into the bin
// that earth-centred arithmetic gives. tests/accuracy/radar/sweep/tower_test.cpp does the same through the
// program within 46 km.
#include <gtest/gtest.h>

#include <GeographicLib/Geocentric.hpp>
#include <GeographicLib/Geodesic.hpp>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "proto/obliq.pb.h"
#include "server/output/describe_frame.h"
#include "server/radar/frame_plan.h"
#include "server/radar/render.h"
#include "terrain/base/units.h"
#include "tests/support/samplings.h"
#include "tests/support/sane_frames.h"
#include "tests/support/scenes.h"
#include "tests/unit/terrain_files.h"

namespace obliq::far_antenna_test {
namespace {

constexpr double kGround_m = 300, kTower_m = 60, kAbove_m = 3000, kSide_m = 80;
constexpr double kSector_deg = 60, kRMin_m = 4000, kRMax_m = 14000;
constexpr int kAzimuthBins = 512, kRangeBins = 256;  // of 0.117 degrees and 39 m

struct Place {
  double longitude_deg, latitude_deg;
};

glm::dvec3 ecef(const Place& place, double height_m) {
  double x, y, z;
  GeographicLib::Geocentric::WGS84().Forward(place.latitude_deg, place.longitude_deg, height_m, x, y, z);
  return {x, y, z};
}

Place moved(const Place& from, double bearing_deg, double distance_m) {
  Place to{};
  GeographicLib::Geodesic::WGS84().Direct(from.latitude_deg, from.longitude_deg, bearing_deg, distance_m,
                                          to.latitude_deg, to.longitude_deg);
  return to;
}

double dot(const glm::dvec3& a, const glm::dvec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/// East, up and north of a place, in earth-centred axes.
struct Axes {
  glm::dvec3 east, up, north;

  explicit Axes(const Place& at) {
    const double lat = at.latitude_deg * kDegree_rad, lon = at.longitude_deg * kDegree_rad;
    east = {-std::sin(lon), std::cos(lon), 0};
    up = {std::cos(lat) * std::cos(lon), std::cos(lat) * std::sin(lon), std::sin(lat)};
    north = {-std::sin(lat) * std::cos(lon), -std::sin(lat) * std::sin(lon), std::cos(lat)};
  }
};

/// Where a tower of four corners lies: bins, with fractions.
struct Bounds {
  double azimuth_low = HUGE_VAL, azimuth_high = -HUGE_VAL, range_low = HUGE_VAL, range_high = -HUGE_VAL;

  void add(double offset_deg, double range_m) {
    const double azimuth = (offset_deg + kSector_deg / 2) / kSector_deg * kAzimuthBins;
    const double range = (range_m - kRMin_m) / (kRMax_m - kRMin_m) * kRangeBins;
    azimuth_low = std::min(azimuth_low, azimuth), azimuth_high = std::max(azimuth_high, azimuth);
    range_low = std::min(range_low, range), range_high = std::max(range_high, range);
  }
  void widen(double degrees, double metres) {
    azimuth_low -= degrees / kSector_deg * kAzimuthBins, azimuth_high += degrees / kSector_deg * kAzimuthBins;
    range_low -= metres / (kRMax_m - kRMin_m) * kRangeBins;
    range_high += metres / (kRMax_m - kRMin_m) * kRangeBins;
  }
  bool holds(int azimuth, int range) const {
    return azimuth >= std::floor(azimuth_low) && azimuth <= std::floor(azimuth_high) &&
           range >= std::floor(range_low) && range <= std::floor(range_high);
  }
};

struct Result {
  double lean_deg = 0;     ///< most that azimuths about the antenna's own vertical differ
  double stretched_m = 0;  ///< most that the world's slant range differs from the straight line's
};

/// A tower seen at 15 degrees down from an antenna at `place`, its near side towards the antenna, in a scene
/// whose origin is elsewhere. `bearing_deg` is the tower's from the antenna's true north.
Result check_tower(const Place& origin, const Place& place, double bearing_deg, double radius_factor) {
  SCOPED_TRACE("antenna at " + std::to_string(place.longitude_deg) + ", " +
               std::to_string(place.latitude_deg) + ", tower at " + std::to_string(bearing_deg) +
               " degrees, k " + std::to_string(radius_factor));
  const double distance_m = kAbove_m / std::tan(15 * kDegree_rad);
  const double looking_deg = bearing_deg - 11;
  const Place near = moved(place, bearing_deg, distance_m),
              far = moved(place, bearing_deg, distance_m + kSide_m);
  const Place corners[4] = {
      moved(near, bearing_deg - 90, kSide_m / 2), moved(near, bearing_deg + 90, kSide_m / 2),
      moved(far, bearing_deg + 90, kSide_m / 2), moved(far, bearing_deg - 90, kSide_m / 2)};

  // Scene: a plain, in posts of about 900 m, whose longitudes go on over the antimeridian.
  const test::Folder folder;
  test::RasterPlan plan;
  const double step = 1.0 / 120;
  const double wide = 0.16 / std::cos(place.latitude_deg * kDegree_rad);
  plan.columns = static_cast<int>(2 * wide / step);
  plan.rows = static_cast<int>(2 * 0.16 / step);
  plan.geotransform = {place.longitude_deg - wide, step, 0, place.latitude_deg + 0.16, 0, -step};
  plan.value = [](double, double) { return kGround_m; };
  std::ostringstream ring;
  ring.precision(15);
  for (int k = 0; k <= 4; ++k)
    ring << (k ? ", " : "") << "[" << corners[k % 4].longitude_deg << ", " << corners[k % 4].latitude_deg
         << "]";
  WorldSpec spec;
  spec.terrain.dem = {test::write_raster(folder, "plain.tif", plan)};
  spec.terrain.cell_m = 100;
  spec.origin = {origin.longitude_deg, origin.latitude_deg};
  spec.reaches = {{{place.longitude_deg, place.latitude_deg}, kRMax_m}};
  spec.radius_factor = radius_factor;
  BuildingSourceSpec tower;
  tower.source = folder.text("tower.geojson",
                             R"({"type": "FeatureCollection", "features": [{"type": "Feature", "properties":
      {"height": 60.0}, "geometry": {"type": "Polygon", "coordinates": [[)" +
                                 ring.str() + "]]}}]}");
  spec.buildings = {tower};
  const auto scene = test::make_scene(load_world(spec));
  EXPECT_EQ(scene->world().buildings.list.size(), 1u);
  PoseSettings at;
  at.longitude_deg = place.longitude_deg;
  at.latitude_deg = place.latitude_deg;
  at.height_m = kGround_m + kAbove_m;
  at.bearing_deg = std::remainder(looking_deg, 360);
  std::vector<FieldError> errors;
  const auto pose = place_antenna(scene->world(), at, errors);
  if (!pose) {
    ADD_FAILURE() << errors.front().text();
    return {};
  }

  // Earth-centred arithmetic. Azimuths count about the scene origin's vertical (PAPER.md, frames) from the
  // antenna's true north; `own` about the antenna's vertical. The effective earth lifts y by (1 - 1/k) of the
  // ellipsoid's drop below the origin's tangent plane.
  const Axes axes(origin), own_axes(place);
  const glm::dvec3 zero = ecef(origin, 0);
  const auto drop = [&](const glm::dvec3& p) {
    // The point of the ellipsoid on the line through p along the origin's vertical, by Newton.
    double y = 0;
    for (int k = 0; k < 30; ++k) {
      double lat, lon, h;
      const glm::dvec3 q = p + y * axes.up;
      GeographicLib::Geocentric::WGS84().Reverse(q.x, q.y, q.z, lat, lon, h);
      y -= h / dot(Axes({lon, lat}).up, axes.up);
    }
    return dot(p + y * axes.up - zero, axes.up);
  };
  const double lift = 1 - 1 / radius_factor;
  const glm::dvec3 antenna = ecef(place, at.height_m);
  const double north = std::atan2(dot(own_axes.north, axes.east), dot(own_axes.north, axes.north));
  Bounds bounds;
  Result result;
  const auto add = [&](const Place& corner, double height_m) {
    const glm::dvec3 p = ecef(corner, height_m), d = p - antenna;
    const double azimuth = std::atan2(dot(d, axes.east), dot(d, axes.north)) - north;
    const double own = std::atan2(dot(d, own_axes.east), dot(d, own_axes.north));
    const double straight_m = std::sqrt(dot(d, d));
    const double y = dot(d, axes.up) - lift * (drop(p) - drop(antenna));
    const double range_m = std::hypot(dot(d, axes.east), dot(d, axes.north), y);
    bounds.add(std::remainder(azimuth / kDegree_rad - looking_deg, 360), range_m);
    result.lean_deg = std::max(result.lean_deg, std::abs(std::remainder((azimuth - own) / kDegree_rad, 360)));
    result.stretched_m = std::max(result.stretched_m, std::abs(range_m - straight_m));
  };
  // What can be seen: the near wall, from the ground up, and the roof. The wall's middle is nearer than its
  // corners.
  for (const double h : {kGround_m, kGround_m + kTower_m})
    for (const Place& corner : {corners[0], corners[1], near}) add(corner, h);
  for (const int k : {2, 3}) add(corners[k], kGround_m + kTower_m);
  // Walls are parallel to the origin's vertical, not to the plumb line: the roof stands height x rho / R
  // aside. Corners are rounded to float32, 2^-5 m beyond 262 km.
  const glm::dvec3 away = antenna - zero;
  const double aside_m = kTower_m * std::sqrt(dot(away, away)) / kMeanEarthRadius_m + 0.05;
  bounds.widen(aside_m / (distance_m * kDegree_rad), aside_m);

  for (const test::Sampling& sampling : test::kSamplings) {
    SCOPED_TRACE(sampling.name);
    RadarSettings s = test::radar_settings(FrustumKind::oblique, {kRMin_m, kRMax_m, kSector_deg},
                                           {kAzimuthBins, kRangeBins}, {1024, 512});
    s = test::sampled(s, sampling);
    const PlanResult planned = plan_frame(scene, test::snapshot(s), *pose);
    if (!planned.plan) {
      ADD_FAILURE() << planned.errors.front().text();
      continue;
    }
    RenderOptions options;
    options.surfaces = Surfaces::buildings;  // the tower alone
    const Frame frame = render(scene, test::snapshot(s), *pose, {0, kAzimuthBins}, options);
    test::expect_sane(frame, s, scene->materials());
    int inside = 0, outside = 0;
    for (int a = 0; a < kAzimuthBins; ++a) {
      for (int r = 0; r < kRangeBins; ++r) {
        const std::size_t bin = static_cast<std::size_t>(a) * kRangeBins + static_cast<std::size_t>(r);
        if (frame.bins.count[bin] == 0) continue;
        EXPECT_GT(frame.bins.power_w[bin], 0);
        (bounds.holds(a, r) ? inside : outside) += 1;
      }
    }
    EXPECT_GT(inside, 0);
    EXPECT_EQ(outside, 0) << "azimuth bins " << bounds.azimuth_low << " to " << bounds.azimuth_high
                          << ", range bins " << bounds.range_low << " to " << bounds.range_high;
    wire::FrameDescriptor descriptor;
    describe_frame(*planned.plan, "main", "test", descriptor);
    // What frame.json states as the bound of the azimuth error holds.
    EXPECT_LE(result.lean_deg, descriptor.azimuth_error_bound_rad() / kDegree_rad + 1e-4);
  }
  return result;
}

constexpr Place kOrigin{-99.5, 33};

TEST(HardFarAntenna, ATowerFallsIntoItsBinAt37And100And300KilometresFromTheOrigin) {
  for (const double rho_m : {37e3, 100e3, 300e3}) {
    double lean_deg = 0;
    // East, north and south-west of the origin; looking outwards, across and back.
    for (const auto& [away_deg, bearing_deg] :
         {std::pair{90.0, 90.0}, {90.0, 0.0}, {0.0, 200.0}, {225.0, 315.0}}) {
      const Result result = check_tower(kOrigin, moved(kOrigin, away_deg, rho_m), bearing_deg, 1);
      lean_deg = std::max(lean_deg, result.lean_deg);
      // k = 1 is a rigid motion of the earth: slant range is the straight line, to a rounding of 6,400 km.
      EXPECT_LT(result.stretched_m, 1e-8 * 10);
    }
    // The two verticals differ by rho / R, and azimuths by at most rho / R tan(15 degrees): 0.09, 0.24, 0.72.
    const double bound_deg = rho_m / kMeanEarthRadius_m * std::tan(15 * kDegree_rad) / kDegree_rad;
    std::printf("    %.0f km: azimuths about the antenna's own vertical differ by %.3f degrees, bound %.3f\n",
                rho_m / 1000, lean_deg, bound_deg);
    EXPECT_LT(lean_deg,
              1.05 * bound_deg);  // the tower's foot lies 15.4 degrees down, and 300 km is 2.7 degrees
    EXPECT_GT(lean_deg, 0.9 * bound_deg) << "looking across, the bound is nearly reached";
  }
}

TEST(HardFarAntenna, TheEffectiveEarthsDepartureIsTheDocumentedOne) {
  // The lift is a function of world (x, z). Far away it shears the scene: y changes by (1 - 1/k) rho / R of
  // the horizontal distance outwards, and a slant range by that times the sine of its angle below the
  // origin's horizontal. frame.json's warnings state the bound. The rest, (1 - 1/k) d^2 / 2R x 3 / 11.6 = 0.6
  // m, is what refraction does anywhere.
  for (const double rho_m : {37e3, 100e3, 300e3}) {
    const Result out = check_tower(kOrigin, moved(kOrigin, 90, rho_m), 90, 4.0 / 3);
    const Result across = check_tower(kOrigin, moved(kOrigin, 90, rho_m), 0, 4.0 / 3);
    const double down = 15 * kDegree_rad + rho_m / kMeanEarthRadius_m;  // below the origin's horizontal
    const double shear_m = 0.25 * rho_m / kMeanEarthRadius_m * std::sin(down) * std::cos(down) * kAbove_m /
                           std::sin(15 * kDegree_rad);
    std::printf("    %.0f km: slant range off by %.1f m outwards (shear %.1f m), %.1f m across\n",
                rho_m / 1000, out.stretched_m, shear_m, across.stretched_m);
    EXPECT_NEAR(out.stretched_m, shear_m, 0.02 * shear_m + 1);
    EXPECT_LT(across.stretched_m, 0.2 * shear_m + 1);
  }
}

TEST(HardFarAntenna, ATowerFallsIntoItsBinAtEightyFiveDegreesNorth) {
  // 30 km east of the origin true north has turned by 3 degrees, 26 bins.
  const Place origin{20, 85};
  EXPECT_LT(check_tower(origin, origin, 40, 1).lean_deg, 1e-9) << "at the origin both verticals are one";
  check_tower(origin, moved(origin, 90, 30e3), 130, 1);
}

TEST(HardFarAntenna, ATowerFallsIntoItsBinAcrossTheAntimeridian) {
  const Place origin{179.99, 52};
  check_tower(origin, {179.98, 52}, 90, 4.0 / 3);
  check_tower(origin, {-179.99, 52}, 270, 4.0 / 3);
}

TEST(HardFarAntenna, ATowerFallsIntoItsBinOnTheEquatorAndInTheSouth) {
  check_tower({0, 0}, {0.05, -0.05}, 225, 4.0 / 3);
  check_tower({18.4, -34}, {18.5, -34.1}, 10, 1);
}

}  // namespace
}  // namespace obliq::far_antenna_test
