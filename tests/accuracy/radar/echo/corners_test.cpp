// Walls square to the line of sight: what they return together with the ground before them, by every way of
// sampling, against published values and an integral that shares no code
// (tests/accuracy/radar/echo/corner_oracle.h).
#include "server/radar/echo/corners.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <numeric>

#include "server/accuracy/truth_bins.h"
#include "server/radar/frame_plan.h"
#include "tests/accuracy/radar/echo/corner_oracle.h"
#include "tests/accuracy/radar/echo/corners_support.h"
#include "tests/support/made_worlds.h"
#include "tests/support/scenes.h"

namespace obliq::corners_test {
namespace {

using test::CornerWay;
using test::House;
using test::kPi;
using test::total;

double reference_total(const World& world, const House& house, const RadarSettings& s) {
  const auto scene = test::make_scene(world, test::corner_materials());
  const PlanResult planned =
      plan_frame(scene, test::snapshot(s), test::pose_at(scene->world(), house.antenna_m(), 0));
  const ReferenceBins bins = integrate_reference(
      scene->world(), test::corner_materials(), reference_view(*planned.plan), {16, 1, 0}, 0, s.azimuth_bins);
  EXPECT_EQ(total(bins.ground_w), 0);
  return total(bins.building_w);
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

constexpr CornerWay kWays[] = {{"exact", FrustumKind::sweep, 0, 1e-3},
                               {"sub-columns", FrustumKind::sweep, 64, 1e-3},
                               {"rays", FrustumKind::oblique, 0, 2e-2}};

/// What corners_table.py prints: at a grazing angle, of ground of a slope, the peak in dBsm, where half of it
/// is left, and the mean of a house over its orientations.
struct TableRow {
  bool vertical;
  double grazing_deg, slope, peak_dbsm, half_deg, mean_dbsm;
};
constexpr TableRow kTable[] = {
    {false, 5, 0.05, 52.94, 0.30, 26.56},  {false, 5, 0.1, 46.92, 0.60, 23.61},
    {false, 10, 0.05, 49.31, 0.60, 29.02}, {false, 10, 0.1, 43.29, 1.21, 26.07},
    {false, 20, 0.05, 45.22, 1.23, 29.87}, {false, 20, 0.1, 39.20, 2.50, 26.91},
    {false, 30, 0.05, 42.58, 1.96, 29.23}, {false, 30, 0.1, 36.56, 3.96, 26.28},
    {true, 5, 0.05, 49.42, 0.30, 23.03},   {true, 5, 0.1, 43.40, 0.60, 20.07},
    {true, 10, 0.05, 41.68, 0.60, 21.38},  {true, 10, 0.1, 35.66, 1.20, 18.39},
    {true, 20, 0.05, 21.24, 1.21, 5.80},   {true, 20, 0.1, 15.22, 2.30, 2.58},
    {true, 30, 0.05, 26.87, 1.97, 13.56},  {true, 30, 0.1, 20.85, 4.10, 10.72},
};

/// The table's equation with the project's factors.
double by_factors(const TableRow& row, double phi_rad, double lit_m) {
  const CornerTable table(test::corner_materials(row.slope),
                          row.vertical ? Polarisation::vertical : Polarisation::horizontal);
  const double down = std::tan(row.grazing_deg * kPi / 180);
  if (std::cos(phi_rad) <= 0) return 0;
  const double level = std::cos(row.grazing_deg * kPi / 180);
  const CornerSight sight = CornerSight::over_ground(std::cos(phi_rad), std::sin(phi_rad), level, 0, down);
  return table.reflectivity(1, 0, sight.across) * table.lobe(0, sight, {}) * test::kLength_m *
         std::cos(phi_rad) * std::min(test::kHeight_m / down, lit_m);
}

TEST(Corners, FactorsGiveThePublishedTable) {
  for (const TableRow& row : kTable) {
    SCOPED_TRACE(std::to_string(row.vertical) + " " + std::to_string(row.grazing_deg));
    const double peak = by_factors(row, 0, 1e9);
    EXPECT_NEAR(test::db(peak), row.peak_dbsm, 0.006);
    EXPECT_NEAR(by_factors(row, row.half_deg * kPi / 180, 1e9) / peak, 0.5, 0.01 / row.half_deg);
    double mean = 0;
    constexpr int kTurns = 4000;
    for (int k = 0; k < kTurns; ++k) mean += 4 * by_factors(row, 2 * kPi * k / kTurns, 30) / kTurns;
    EXPECT_NEAR(test::db(mean), row.mean_dbsm, 0.01);
  }
}

TEST(Corners, FresnelAtItsLimits) {
  const std::complex<double> ground(6, -0.6), lossless(4, 0);
  for (const Polarisation polarisation : {Polarisation::horizontal, Polarisation::vertical}) {
    EXPECT_NEAR(fresnel_reflectivity(ground, 0, polarisation), 1, 1e-12);
    EXPECT_NEAR(fresnel_reflectivity(lossless, 1, polarisation), 1.0 / 9, 1e-12);
    EXPECT_NEAR(fresnel_reflectivity(1, 0.3, polarisation), 0, 1e-15);
  }
  // Brewster's angle: tan = 2.
  EXPECT_NEAR(fresnel_reflectivity(lossless, std::cos(std::atan(2.0)), Polarisation::vertical), 0, 1e-12);
}

/// Four hundred houses round the antenna, each turned another way.
std::shared_ptr<const Scene> town(bool corners, const std::vector<Material>& of, double distance_m = 12000) {
  World world = test::made_world(13000, 500, [](double, double) { return 0.0; });
  for (int k = 0; k < 400; ++k) {
    const double at = (k + 0.5) / 400 * 2 * kPi / 3 - kPi / 3;
    const double turn = std::fmod(k * 0.6180339887, 1.0) * kPi / 2;
    const glm::dvec2 middle(distance_m * std::sin(at), distance_m * std::cos(at));
    const glm::dvec2 u(10 * std::cos(turn), 10 * std::sin(turn)), v(-u.y, u.x);
    test::add_prism(world, {middle - u - v, middle + u - v, middle + u + v, middle - u + v}, 8);
  }
  world.buildings.corners = corners;
  return test::make_scene(std::move(world), of);
}

double mean_of_town_m2(double grazing_deg, bool corners, const std::vector<Material>& of) {
  const auto scene = town(corners, of);
  const double height_m = 12000 * std::tan(grazing_deg * kPi / 180);
  const double range_m = std::hypot(12000, height_m);
  RadarSettings s = test::radar_settings(FrustumKind::sweep, {range_m - 200, range_m + 200, 120}, {1440, 80});
  s.pixel_columns = 2880;
  s.range_normalisation = true;
  return total(render(scene, test::snapshot(s), test::pose_at(scene->world(), {0, height_m, 0}, 0),
                      {0, s.azimuth_bins})
                   .bins.power_w) /
         test::radar_constant(s) / 400;
}

TEST(Corners, MeanOfFourHundredHousesIsTheTables) {
  // The strip is shorter than the table's 30 m. 400 orientations of a lobe 2.5 degrees wide: 0.05 dB.
  EXPECT_NEAR(test::db(mean_of_town_m2(20, true, test::corner_materials())), 26.91, 0.1);
  EXPECT_NEAR(test::db(mean_of_town_m2(30, true, test::corner_materials())), 26.28, 0.1);
}

TEST(Corners, LoweredFloorKeepsATownsMean) {
  for (const double grazing_deg : {20.0, 30.0}) {
    std::vector<Material> today = test::corner_materials();
    today[1].reflectivity = 0.5;
    today[1].gamma = 1;
    std::vector<Material> lowered = today;
    lowered[1].gamma = 0.1;
    const double rise_db =
        test::db(mean_of_town_m2(grazing_deg, true, lowered) / mean_of_town_m2(grazing_deg, false, today));
    std::printf("mean of a town at %.0f deg with corners: %+.2f dB\n", grazing_deg, rise_db);
    EXPECT_NEAR(rise_db, 0, 2.1);
  }
}

TEST(Corners, TownOnHillsAgainstTheReference) {
  // Streets of houses that hide each other's feet in part, over ground whose slopes turn the lobes.
  World world = test::made_world(
      7000, 20, [](double x, double z) { return 12 * std::sin(x / 170 + 1) * std::cos(z / 210) + 0.01 * z; });
  for (int k = 0; k < 900; ++k) {
    const double turn = 0.02 + 0.04 * std::sin(k * 1.7);
    const double x = (k % 30 - 14.5) * 26 + (k / 30 % 3) * 9, z = 5000 + (k / 30) * 41;
    const glm::dvec2 middle(x, z), u(8 * std::cos(turn), 8 * std::sin(turn)), v(-0.7 * u.y, 0.7 * u.x);
    test::add_prism(world, {middle - u - v, middle + u - v, middle + u + v, middle - u + v}, 5 + k * 7 % 11);
  }
  world.buildings.corners = true;
  const auto scene = test::make_scene(std::move(world), test::corner_materials());
  for (const double height_m : {600.0, 1500.0}) {
    RadarSettings s = test::radar_settings(FrustumKind::sweep, {4800, 6600, 10}, {80, 120});
    s.pixel_columns = 160;
    const Pose pose = test::pose_at(scene->world(), {0, height_m, 0}, 0);
    const PlanResult planned = plan_frame(scene, test::snapshot(s), pose);
    const ReferenceBins truth =
        integrate_reference(scene->world(), test::corner_materials(), reference_view(*planned.plan),
                            {16, 1, 0}, 0, s.azimuth_bins);
    for (const int sub_columns : {0, 64}) {
      s.sub_columns = sub_columns;
      const std::vector<double> w = render(scene, test::snapshot(s), pose, {0, s.azimuth_bins}).bins.power_w;
      const double all = total(truth.building_w);
      double off = 0;
      for (std::size_t k = 0; k < w.size(); ++k) off += std::abs(w[k] - truth.building_w[k]);
      std::printf("from %.0f m, %d sub-columns: sum %+.3f, bins off by %.3f of it\n", height_m, sub_columns,
                  total(w) / all - 1, off / all);
      // Sub-columns take a shadow's edge to half their width, and the ground's own shadows to a node.
      EXPECT_NEAR(total(w) / all, 1, sub_columns == 0 ? 0.02 : 0.06);
      EXPECT_LT(off / all, sub_columns == 0 ? 0.05 : 0.09);
    }
  }
}

TEST(Corners, OneHouseAtTwelveHeadings) {
  for (const bool slope : {false, true}) {
    for (const CornerWay& way : kWays) {
      for (int k = 0; k < 12; ++k) {
        House house;
        house.heading_deg = -5.5 + k;
        if (slope) {
          // Ten degrees, rising aslant away from the antenna and to its right.
          house.per_x = std::tan(10 * kPi / 180) * std::sin(0.7);
          house.per_z = std::tan(10 * kPi / 180) * std::cos(0.7);
          house.heading_deg -= 2.5;  // where the lobe is
        }
        const World world = house.world();
        const RadarSettings s = test::corner_settings(house, way);
        const double found = total(test::corner_powers(world, house, s, test::corner_materials()));
        const double wanted = test::radar_constant(s) * oracle(world, house).total();

        if (&way == kWays) {
          EXPECT_NEAR(reference_total(world, house, s) / wanted, 1, way.tolerance) << house.heading_deg;
        }
        EXPECT_NEAR(found / wanted, 1, way.tolerance) << way.name << " " << slope << " " << house.heading_deg;
      }
    }
  }
}

}  // namespace
}  // namespace obliq::corners_test
