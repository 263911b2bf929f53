// Walls square to the line of sight: what they return together with the ground before them, by every way of
// sampling, against published values and an integral that shares no code (tests/support/corner_oracle.h).
#include "server/radar/echo/corners.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <numeric>

#include "server/accuracy/truth_bins.h"
#include "server/radar/frame_plan.h"
#include "tests/support/corner_oracle.h"
#include "tests/support/made_worlds.h"
#include "tests/support/scenes.h"

namespace obliq {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kLength_m = 20, kHeight_m = 8;

[[maybe_unused]] double db(double ratio) { return 10 * std::log10(ratio); }

/// Ground and walls that return nothing but corners.
std::vector<Material> materials(double rms_slope = 0.1) {
  std::vector<Material> both = test::two_materials();
  both[0].gamma = both[1].gamma = 0;
  both[1].reflectivity = 0;
  both[0].rms_slope = rms_slope;
  both[0].permittivity_re = 6;
  both[0].permittivity_im = 0.6;
  both[1].permittivity_re = 5.3;
  both[1].permittivity_im = 0.3;
  return both;
}

/// A house whose wall faces the antenna, turned clockwise about its middle, and the antenna at a grazing
/// angle.
struct House {
  double heading_deg = 0;
  double distance_m = 20000;
  double grazing_deg = 20;
  double per_x = 0, per_z = 0;  ///< the ground's slopes

  glm::dvec3 antenna_m() const {
    return {0, std::tan(grazing_deg * kPi / 180) * distance_m + per_z * distance_m, 0};
  }
  Ring corners() const {
    const double turn = heading_deg * kPi / 180;
    const glm::dvec2 u(std::cos(turn), -std::sin(turn)), back(std::sin(turn), std::cos(turn));
    const glm::dvec2 foot(0.3, distance_m);
    const glm::dvec2 left = foot - u * (kLength_m / 2), right = foot + u * (kLength_m / 2);
    return {left, right, right + back * kLength_m, left + back * kLength_m};
  }
  World world() const {
    World made = test::made_world(21000, 500, [&](double x, double z) { return per_x * x + per_z * z; });
    test::add_prism(made, corners(), kHeight_m);
    made.buildings.corners = true;
    return made;
  }
};

struct Way {
  const char* name;
  FrustumKind frustum;
  int sub_columns;
  double tolerance;
};

RadarSettings settings(const House& house, const Way& way, double half_swath_m = 150) {
  const double range_m = house.distance_m / std::cos(house.grazing_deg * kPi / 180);
  RadarSettings s = test::radar_settings(way.frustum, {range_m - half_swath_m, range_m + half_swath_m, 1},
                                         {8, static_cast<int>(half_swath_m / 5)}, {1024, 512});
  s.sub_columns = way.sub_columns;
  s.speckle = SpeckleKind::ground;
  return s;
}

std::vector<double> powers(const World& world, const House& house, const RadarSettings& s,
                           const std::vector<Material>& of) {
  const auto scene = test::make_scene(world, of);
  return render(scene, test::snapshot(s), test::pose_at(scene->world(), house.antenna_m(), 0),
                {0, s.azimuth_bins})
      .bins.power_w;
}

double total(const std::vector<double>& w) { return std::accumulate(w.begin(), w.end(), 0.0); }

double reference_total(const World& world, const House& house, const RadarSettings& s) {
  const auto scene = test::make_scene(world, materials());
  const PlanResult planned =
      plan_frame(scene, test::snapshot(s), test::pose_at(scene->world(), house.antenna_m(), 0));
  const ReferenceBins bins = integrate_reference(scene->world(), materials(), reference_view(*planned.plan),
                                                 {16, 1, 0}, 0, s.azimuth_bins);
  EXPECT_EQ(total(bins.ground_w), 0);
  return total(bins.building_w);
}

double constant(const RadarSettings& s) {
  const double wavelength = 299792458.0 / (s.frequency_ghz * 1e9);
  return s.power_w * wavelength * wavelength / std::pow(4 * kPi, 3);
}

test::CornerOracle oracle(const World& world, const House& house, bool vertical = false) {
  // As floats keep them: the wall that faces the antenna lies between the two nearest corners.
  std::vector<glm::vec2> ring(world.buildings.ring_xz_m.begin(), world.buildings.ring_xz_m.end());
  std::ranges::sort(ring, {}, [](const glm::vec2& p) { return p.y; });
  if (ring[0].x > ring[1].x) std::swap(ring[0], ring[1]);
  const auto at = [&](const glm::vec2& p) { return glm::dvec3(p.x, 0, p.y); };
  return {house.antenna_m(),
          at(ring[0]),
          at(ring[1]),
          static_cast<double>(world.buildings.list[0].roof_y_m),
          0,
          house.per_x,
          house.per_z,
          {5.3, -0.3},
          {6, -0.6},
          0.1,
          vertical};
}

/// Exact planes, sub-columns far off and near buildings' strips, rays.
constexpr Way kWays[] = {{"exact", FrustumKind::sweep, 0, 1e-3},
                         {"sub-columns", FrustumKind::sweep, 64, 1e-3},
                         {"rays", FrustumKind::oblique, 0, 2e-2}};

TEST(Corners, OneHouseAtTwelveHeadings) {
  for (const bool slope : {false, true}) {
    for (const Way& way : kWays) {
      for (int k = 0; k < 12; ++k) {
        House house;
        house.heading_deg = -5.5 + k;
        if (slope) {
          // Ten degrees, rising aslant away from the antenna and to its right.
          house.per_x = std::tan(10 * kPi / 180) * std::sin(0.7);
          house.per_z = std::tan(10 * kPi / 180) * std::cos(0.7);
          house.heading_deg -= 1;  // where the lobe is
        }
        const World world = house.world();
        const RadarSettings s = settings(house, way);
        const double found = total(powers(world, house, s, materials()));
        const double wanted = constant(s) * oracle(world, house).total();

        std::printf("%s slope %d heading %5.1f: %.6g, %.6g, %+.2e\n", way.name, slope, house.heading_deg,
                    found, wanted, found / wanted - 1);
        if (&way == kWays) {
          EXPECT_NEAR(reference_total(world, house, s) / wanted, 1, way.tolerance) << house.heading_deg;
        }
        EXPECT_NEAR(found / wanted, 1, way.tolerance) << way.name << " " << slope << " " << house.heading_deg;
      }
    }
  }
}

}  // namespace
}  // namespace obliq
