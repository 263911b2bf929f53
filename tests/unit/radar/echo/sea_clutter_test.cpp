// The sea's models without a scene, against published values.
#include "server/radar/echo/sea_clutter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "server/radar/echo/sea_warnings.h"
#include "server/radar/simd/lanes/exact_math.h"
#include "terrain/base/units.h"
#include "tests/support/scenes.h"

namespace obliq::sea_clutter_test {
namespace {

constexpr Polarisation kH = Polarisation::horizontal, kV = Polarisation::vertical;

double nrl_db(double state, double degrees, Polarisation polarisation, double ghz = 9.4) {
  return sea_sigma0_db(state, degrees * kDegree_rad, ghz, polarisation);
}

TEST(SeaClutter, IsThatOfTheReport) {
  // Equation 7 of NRL/MR/5310-12-9346, worked out in double with numpy, at 9.4 GHz.
  struct Row {
    double state, degrees, h_db, v_db;
  };
  for (const Row& row : {Row{1, 1, -56.56, -52.36}, Row{1, 3, -52.32, -47.28}, Row{1, 10, -46.28, -39.64},
                         Row{3, 0.3, -48.65, -47.50}, Row{3, 1, -43.75, -41.58}, Row{3, 3, -40.83, -37.61},
                         Row{3, 10, -37.86, -32.55}, Row{5, 1, -35.26, -34.44}, Row{5, 3, -33.27, -31.24},
                         Row{5, 10, -32.43, -27.98}}) {
    EXPECT_NEAR(nrl_db(row.state, row.degrees, kH), row.h_db, 0.0051) << row.state << ", " << row.degrees;
    EXPECT_NEAR(nrl_db(row.state, row.degrees, kV), row.v_db, 0.0051) << row.state << ", " << row.degrees;
  }
  // Published: MathWorks, seareflectivity (2.1555e-04); phased-array-systems, its page of validation (-43.8).
  EXPECT_NEAR(nrl_db(2, 10, kH, 30), 10 * std::log10(2.1555e-4), 0.01);
  EXPECT_NEAR(nrl_db(3, 1, kH, 9.3), -43.832, 0.001);
}

TEST(SeaClutter, TakesTheModelsEdgeBeyondIt) {
  EXPECT_NEAR(nrl_db(3, 0.01, kH), nrl_db(3, 0.1, kH), 1e-12);
  EXPECT_NEAR(nrl_db(3, -5, kH), nrl_db(3, 0.1, kH), 1e-12);
  EXPECT_NEAR(nrl_db(3, 90, kV), nrl_db(3, 60, kV), 1e-12);
  EXPECT_EQ(nrl_db(3, 2, kV, 0.1), nrl_db(3, 2, kV, 0.5));
  EXPECT_EQ(nrl_db(3, 2, kV, 94), nrl_db(3, 2, kV, 35));
  EXPECT_LT(nrl_db(3, 2, kV, 0.5), nrl_db(3, 2, kV, 0.6));
  for (const double state : {0.01, 6.0})
    for (const double degrees : {0.0, 0.1, 60.0, 90.0})
      for (const double ghz : {0.5, 35.0})
        EXPECT_TRUE(std::isfinite(nrl_db(state, degrees, kH, ghz)) &&
                    std::isfinite(nrl_db(state, degrees, kV, ghz)));
}

TEST(SeaClutter, ReturnsMoreAgainstTheWind) {
  // GIT, state 3, 1 degree, 9.4 GHz: 5.62 dB from downwind to upwind (-36.20 to -41.82 dB). Over its mean the
  // factor keeps the mean over all bearings.
  const double z = upwind_exponent(1 * kDegree_rad, 9.4);
  EXPECT_NEAR(db_of_ratio(std::exp(2 * z)), 5.62, 0.005);
  double mean = 0;
  for (int k = 0; k < 3600; ++k) mean += std::exp(z * std::cos(k * std::numbers::pi / 1800)) / 3600;
  EXPECT_NEAR(mean / bessel_i0(z), 1, 1e-14);
  EXPECT_EQ(upwind_exponent(40 * kDegree_rad, 9.4), upwind_exponent(10 * kDegree_rad, 9.4));
}

TEST(SeaClutter, GrazesASphere) {
  // sin(psi) = (h^2 + 2 R h - r^2) / (2 r R), R = 4/3 6371 km, worked out with numpy. The depression at
  // the antenna (the named wrong version) is 5.739, 1.549 and 0.172 degrees.
  constexpr double kRadius_m = 4.0 / 3 * 6371e3;
  const auto degrees = [](double h, double r) { return grazing_rad(h, r, kRadius_m) / kDegree_rad; };
  EXPECT_NEAR(degrees(1000, 10000), 5.7056, 6e-5);
  EXPECT_NEAR(degrees(1000, 37000), 1.4240, 6e-5);
  EXPECT_NEAR(degrees(30, 10000), 0.1382, 6e-5);
  EXPECT_NEAR(grazing_rad(1000, 10000, INFINITY), std::asin(0.1), 1e-15);
  EXPECT_LT(degrees(30, 30000), 0);
}

TEST(SeaClutter, TakesItsStateFromTheWind) {
  RadarSettings s;
  EXPECT_EQ(sea_state(s), 0);
  s.sea.state = 3;
  EXPECT_EQ(sea_state(s), 3);
  s.sea.state_auto = true;
  EXPECT_EQ(sea_state(s), 0);
  s.atmosphere.wind_m_s = 3.16 * std::pow(4.0, 0.8);
  EXPECT_NEAR(sea_state(s), 4, 1e-12);
  s.atmosphere.wind_m_s = 40;
  EXPECT_EQ(sea_state(s), 6);
}

/// Warnings of a frame over a sea.
std::vector<std::string> warnings_of(RadarSettings s, double height_m = 1000) {
  std::vector<Material> materials = test::two_materials();
  materials[0].model = ScatteringModel::sea;
  static const World world = load_world(test::synthetic_spec(SyntheticKind::flat, 9000, 300));
  const auto scene = test::make_scene(world, materials);
  const PlanResult planned = plan_frame(scene, test::snapshot(s), test::pose_over_origin(world, height_m));
  EXPECT_TRUE(planned.plan) << all_text(planned.errors);
  return sea_warnings(planned.plan->looks_at());
}

TEST(SeaClutter, WarnsAtTheModelsEdgesAndNamesThem) {
  RadarSettings s = test::radar_settings(FrustumKind::sweep, {6000, 9000, 60}, {16, 16}, {16});
  s.sea.state = 3;
  EXPECT_TRUE(warnings_of(s).empty());
  const auto expect_one = [](const std::vector<std::string>& warnings, const char* what, const char* edge) {
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_NE(warnings[0].find(what), std::string::npos) << warnings[0];
    EXPECT_NE(warnings[0].find(edge), std::string::npos) << warnings[0];
  };
  RadarSettings other = s;
  other.frequency_ghz = 94;
  expect_one(warnings_of(other), "radar.frequency_ghz = 94", "at 35 GHz");
  other.frequency_ghz = 0.3;
  expect_one(warnings_of(other), "radar.frequency_ghz = 0.3", "at 0.5 GHz");
  other = s;
  other.sea.state_auto = true;
  other.atmosphere.wind_m_s = 20;
  expect_one(warnings_of(other), "a wind of 20 m/s raises state 10.0", "ends at state 6");
  // By sin(psi) = h / r over flat ground: 0.1 degrees of 10 m at 5.7 km, 60 of 7 km at 8.1 km, 10 of 1.2 km
  // at 6.9 km.
  expect_one(warnings_of(s, 10), "beyond 5.7 km", "less than 0.1 degrees");
  expect_one(warnings_of(s, 7000), "nearer than 8.1 km", "more than 60 degrees");
  other = s;
  other.atmosphere.wind_m_s = 5;
  expect_one(warnings_of(other, 1200), "nearer than 6.9 km", "more than 10 degrees");
  other = s;
  other.sea.state = 0;
  EXPECT_TRUE(warnings_of(other, 10).empty());
}

TEST(SeaClutter, FindsTheRangeOfAGrazingAngle) {
  for (const double radius_m : {4.0 / 3 * 6371e3, double{INFINITY}})
    for (const double height_m : {2.0, 1000.0, 12000.0})
      for (const double degrees : {0.1, 10.0, 60.0})
        EXPECT_NEAR(
            grazing_rad(height_m, range_of_grazing_m(height_m, degrees * kDegree_rad, radius_m), radius_m) /
                kDegree_rad,
            degrees, 1e-9);
}

}  // namespace
}  // namespace obliq::sea_clutter_test
