// Mean power of the sea in bins: against a closed integral over a level sea and over a sphere, and against
// the reference renderer where land stands in the way. Both write the model anew.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "server/accuracy/bin_errors.h"
#include "server/accuracy/truth_bins.h"
#include "tests/support/made_worlds.h"
#include "tests/support/same_bits.h"
#include "tests/support/sane_frames.h"
#include "tests/support/scenes.h"

namespace obliq::sea_test {
namespace {

constexpr double kPi = std::numbers::pi;

std::vector<Material> land_and_sea() {
  std::vector<Material> materials = test::two_materials();
  materials[0].gamma = 0.03;
  Material water;
  water.name = "water";
  water.model = ScatteringModel::sea;
  water.gamma = 1e-3;
  materials.push_back(water);
  return materials;
}

/// All ground is sea.
std::vector<Material> sea_alone() {
  std::vector<Material> materials = test::two_materials();
  materials[0].model = ScatteringModel::sea;
  materials[0].gamma = 1e-4;
  return materials;
}

/// A world's cells whose ground is level are water.
void flood(World& world) {
  const HeightGrid& grid = world.grid;
  for (int j = 0; j + 1 < grid.nz; ++j)
    for (int i = 0; i + 1 < grid.nx; ++i) {
      const float y = grid.y_m[grid.index(i, j)];
      const bool level = y == grid.y_m[grid.index(i + 1, j)] && y == grid.y_m[grid.index(i, j + 1)] &&
                         y == grid.y_m[grid.index(i + 1, j + 1)];
      world.surface_material.push_back(level ? 2 : 0);
    }
}

RadarSettings radar(FrustumKind kind, double state, double r_min_m, double r_max_m) {
  RadarSettings s = test::radar_settings(kind, {r_min_m, r_max_m, 60}, {64, 128}, {512, 512});
  s.frequency_ghz = 9.4;
  s.sea.state = state;
  s.sea.shape = 0;
  return s;
}

/// sigma0 at state 3, 9.4 GHz, horizontal: the model's equation 7 in one line.
double sigma0(double grazing_rad) {
  const double deg = std::min(60.0, std::max(0.1, grazing_rad * 180 / kPi));
  const double db = -73.0 + 20.781 * std::log10(std::sin(deg * kPi / 180)) +
                    (27.5 + 7.351 * deg) * std::log10(9.4) / (1 + 0.95 * deg) +
                    25.65 * std::pow(4.0, 1 / (2 + 0.085 * deg + 0.033 * 3)) + 0.0054 * deg * deg;
  return std::pow(10, db / 10);
}

/// Power of a bin of level water on a sphere (radius infinite: a plane), Simpson's rule on K sigma0 / r^4 dA,
/// dA = R / (R + H) r dr dphi. Beyond what the model knows the projected area falls with the true grazing.
double level_power_w(const RadarSettings& s, double height_m, double radius_m, int bin) {
  const double lambda = 299792458.0 / (s.frequency_ghz * 1e9);
  const double k = lambda * lambda / std::pow(4 * kPi, 3);
  const auto at = [&](double r) {
    const double sine = (height_m + (height_m * height_m - r * r) / (2 * radius_m)) / r;
    if (sine <= 0) return 0.0;
    const double grazing = std::asin(std::min(1.0, sine));
    const double within = std::min(60 * kPi / 180, std::max(0.1 * kPi / 180, grazing));
    return sigma0(grazing) / std::sin(within) * sine / (r * r * r);
  };
  const double r1 = s.r_min_m + bin * s.range_bin_m();
  constexpr int kSteps = 64;
  const double h = s.range_bin_m() / kSteps;
  double sum = 0;
  for (int n = 0; n <= kSteps; ++n) sum += (n == 0 || n == kSteps ? 1 : n % 2 == 1 ? 4 : 2) * at(r1 + n * h);
  const double earth = std::isinf(radius_m) ? 1 : radius_m / (radius_m + height_m);
  return k * s.azimuth_bin_rad() * earth * sum * h / 3;
}

/// Greatest relative difference of a row's bins, and of their sum.
struct Differences {
  double worst = 0;
  double total = 0;
};
Differences from_level(const Frame& frame, const RadarSettings& s, double height_m, double radius_m,
                       int last_bin) {
  Differences d;
  double sum = 0, expected_sum = 0;
  for (int r = 0; r < last_bin; ++r) {
    const double expected = level_power_w(s, height_m, radius_m, r);
    for (int a = 0; a < s.azimuth_bins; ++a) {
      const double power = frame.bins.power_w[static_cast<std::size_t>(a * s.range_bins + r)];
      d.worst = std::max(d.worst, std::abs(power / expected - 1));
      sum += power;
      expected_sum += expected;
    }
  }
  d.total = sum / expected_sum - 1;
  std::printf("    worst bin %.2e, total %+.2e\n", d.worst, d.total);
  return d;
}

Frame render_sea(const World& world, const RadarSettings& s, double height_m) {
  const auto scene = test::make_scene(world, sea_alone());
  return render(scene, test::snapshot(s), test::pose_over_origin(scene->world(), height_m),
                {0, s.azimuth_bins});
}

TEST(Sea, OnASlopeRightBelowTheAntennaReturnsWhatTheModelHas) {
  // A piece's sine of grazing by its ends is above 1 there. Whatever it is, the sea returns something between
  // the model's least and its most over its material's gamma.
  double least = INFINITY, most = 0;
  for (int tenths = 1; tenths <= 600; ++tenths) {
    const double grazing = tenths * kPi / 1800;
    least = std::min(least, sigma0(grazing) / std::sin(grazing));
    most = std::max(most, sigma0(grazing) / std::sin(grazing));
  }
  for (const double slope : {0.5, 1.0, 3.0}) {
    const World world = test::made_world(600, 30, [&](double, double z) { return -slope * z; });
    RadarSettings s = radar(FrustumKind::sweep, 3, 1, 401);
    s.range_bins = 8;
    for (const double height_m : {1.0, 5.0, 20.0}) {
      const Frame sea = render_sea(world, s, height_m);
      RadarSettings plain = s;
      plain.sea.state = 0;
      const Frame flat = render_sea(world, plain, height_m);
      int lit = 0;
      for (std::size_t k = 0; k < flat.bins.power_w.size(); ++k) {
        if (!(flat.bins.power_w[k] > 0)) continue;
        ++lit;
        const double gamma = sea.bins.power_w[k] / flat.bins.power_w[k] * sea_alone()[0].gamma;
        EXPECT_GT(gamma, 0.99 * least) << slope << ", " << height_m << " m, bin " << k;
        EXPECT_LT(gamma, 1.01 * most) << slope << ", " << height_m << " m, bin " << k;
      }
      EXPECT_GT(lit, 0);
    }
  }
}

TEST(Sea, OfALevelPlaneIsTheClosedIntegral) {
  // Pieces take the grazing angle of their middles, cells are 60 m wide: 2e-4 of a bin at 2 km.
  const World world = load_world(test::synthetic_spec(SyntheticKind::flat, 12000, 60));
  for (const int sub_columns : {0, 64}) {
    RadarSettings s = radar(FrustumKind::sweep, 3, 1500, 10000);
    s.sub_columns = sub_columns;
    EXPECT_LT(from_level(render_sea(world, s, 1000), s, 1000, INFINITY, s.range_bins).worst, 1e-3);
  }
  for (const FrustumKind kind : {FrustumKind::oblique, FrustumKind::symmetric}) {
    RadarSettings s = radar(kind, 3, 1500, 10000);
    s.pixel_rows = 2048;
    EXPECT_LT(std::abs(from_level(render_sea(world, s, 1000), s, 1000, INFINITY, s.range_bins).total), 3e-3);
  }
}

TEST(Sea, OfASphereIsTheClosedIntegralToTheHorizon) {
  // An antenna 100 m over a sea of 4/3 earth radius, of which cells of 60 m leave 5e-8 rad: to 1/10 degree,
  // at 25.5 km, and on to the horizon at 41 km. The ellipsoid's own radius is 0.3 % off the sphere's, which
  // is 0.0003 degrees, and near the horizon most of the power. A version with the depression at the antenna
  // in place of grazing (no curvature) is 2 dB off at 25 km.
  WorldSpec spec = test::synthetic_spec(SyntheticKind::flat, 42000, 60);
  spec.radius_factor = 4.0 / 3;
  const World world = load_world(spec);
  const RadarSettings s = radar(FrustumKind::sweep, 3, 2000, 40000);
  const Frame frame = render_sea(world, s, 100);
  // The ellipsoid's radii at 33 degrees: of the meridian, of the prime vertical, and their mean curvature's.
  const double e2 = 0.00669437999014, sine = std::sin(33 * kPi / 180);
  const double n = 6378137 / std::sqrt(1 - e2 * sine * sine), m = n * (1 - e2) / (1 - e2 * sine * sine);
  const double radius = 4.0 / 3 * 2 / (1 / n + 1 / m);
  const int to_20_km = static_cast<int>((20000 - s.r_min_m) / s.range_bin_m());
  EXPECT_LT(from_level(frame, s, 100, radius, to_20_km).worst, 3e-3);
  const int to_35_km = static_cast<int>((35000 - s.r_min_m) / s.range_bin_m());
  EXPECT_LT(from_level(frame, s, 100, radius, to_35_km).worst, 3e-2);
  EXPECT_LT(std::abs(from_level(frame, s, 100, radius, to_35_km).total), 1e-3);
}

/// A bay between a plateau of 300 m with a cliff to the east and a headland of 120 m across the north, a lake
/// at 4,000 m west of all: whatever is level is water.
World coast() {
  World world = test::made_world(9000, 40, [](double x, double z) {
    if (x < -5000) return 4000.0;
    if (x < -3000) return 4000.0 * (-3000 - x) / 2000 + 3 * std::sin(x / 90) * std::sin(z / 70);
    if (x > 2500) return 300.0 + 20 * std::sin(x / 300) * std::cos(z / 200);
    const double across = std::abs(z - 4500 - 0.2 * x) / 400;
    return across < 1 && x > -2000 ? 120 * (1 - across) : 0.0;
  });
  flood(world);
  return world;
}

BinErrors against_reference(const std::shared_ptr<const Scene>& scene, const RadarSettings& s,
                            const glm::dvec3& antenna_m, double bearing_deg) {
  const Pose pose = test::pose_at(scene->world(), antenna_m, bearing_deg);
  const PlanResult planned = plan_frame(scene, test::snapshot(s), pose);
  EXPECT_TRUE(planned.plan) << all_text(planned.errors);
  const TruthBins truth = integrate_truth(*planned.plan, {{0, s.azimuth_bins}}, {16, 4, 2});
  const Frame frame = render(scene, test::snapshot(s), pose, {0, s.azimuth_bins});
  const std::vector<double> power_w(frame.bins.power_w.begin(), frame.bins.power_w.end());
  const BinErrors errors = bin_errors(power_w, truth.power_w(Returns::all), range_bins(s));
  std::printf("    E %.4f, median %.4f dB, energy %+.5f\n", errors.power_error, errors.median_db,
              errors.energy_error());
  return errors;
}

TEST(Sea, BesideACliffBehindAHeadlandAndOfALakeIsTheReference) {
  // What the sampling leaves with constant gamma is left with a sea: a bin's ground is cut no otherwise.
  const auto scene = test::make_scene(coast(), land_and_sea());
  for (const bool wind : {false, true}) {
    for (const bool vertical : {false, true}) {
      if (wind && !vertical) continue;
      RadarSettings s = radar(FrustumKind::sweep, 3, 1500, 8000);
      s.sector_deg = 200;
      s.atmosphere.polarisation = vertical ? Polarisation::vertical : Polarisation::horizontal;
      s.atmosphere.wind_m_s = wind ? 8 : 0;
      s.atmosphere.wind_from_deg = 70;
      s.pixel_columns = 2048;
      RadarSettings dry = s;
      dry.sea.state = 0;
      for (const double height_m : {400.0, 5200.0}) {
        const glm::dvec3 antenna_m(-500, height_m, -1500);
        const BinErrors plain = against_reference(scene, dry, antenna_m, -10);
        const BinErrors sea = against_reference(scene, s, antenna_m, -10);
        EXPECT_LT(sea.power_error, plain.power_error * 1.1 + 2e-3);
        EXPECT_LT(sea.median_db, plain.median_db + 0.01);
        EXPECT_LT(std::abs(sea.energy_error()), std::abs(plain.energy_error()) + 1e-3);
        EXPECT_LT(sea.false_light, plain.false_light + 1);
      }
    }
  }
}

TEST(Sea, OfRaysBesideACliffIsTheReference) {
  // From 46 degrees down: steeper, where the sea is brightest, few rays fall into a bin.
  const auto scene = test::make_scene(coast(), land_and_sea());
  RadarSettings s = radar(FrustumKind::oblique, 3, 7000, 9000);
  s.pixel_columns = s.pixel_rows = 2048;
  RadarSettings dry = s;
  dry.sea.state = 0;
  const glm::dvec3 antenna_m(-500, 5200, -1500);
  const BinErrors plain = against_reference(scene, dry, antenna_m, -20);
  const BinErrors sea = against_reference(scene, s, antenna_m, -20);
  EXPECT_LT(sea.power_error, plain.power_error * 1.1 + 5e-3);
  EXPECT_LT(std::abs(sea.energy_error()), std::abs(plain.energy_error()) + 1e-3);
}

TEST(Sea, LeavesFramesWithoutWaterTheirBits) {
  // Hills without water: materials of the sea are there, but no cell has them. And a sea without state is its
  // material.
  World world = test::made_world(
      9000, 60, [](double x, double z) { return 80 * std::sin(x / 400) * std::cos(z / 300); });
  std::vector<Material> materials = land_and_sea();
  for (const FrustumKind kind : {FrustumKind::sweep, FrustumKind::oblique}) {
    RadarSettings on = radar(kind, 4, 2000, 8000), off = on;
    off.sea.state = 0;
    const auto scene = test::make_scene(world, materials);
    const Pose pose = test::pose_at(world, {0, 1000, 0}, 0);
    test::expect_same_bits(render(scene, test::snapshot(on), pose, {0, 64}).bins,
                           render(scene, test::snapshot(off), pose, {0, 64}).bins);
    world.surface_material.assign(static_cast<std::size_t>((world.grid.nx - 1) * (world.grid.nz - 1)), 2);
    const auto flooded = test::make_scene(world, materials);
    std::vector<Material> constant = materials;
    constant[2].model = ScatteringModel::constant_gamma;
    test::expect_same_bits(render(flooded, test::snapshot(off), pose, {0, 64}).bins,
                           render(test::make_scene(world, constant), test::snapshot(on), pose, {0, 64}).bins);
    world.surface_material.clear();
  }
}

TEST(Sea, FollowsAStateThatChanges) {
  // State 3 to 5 at 9.4 GHz, H: 7.5 dB at 3 degrees, 5.4 at 10. Back again the frame has its bits.
  const World world = load_world(test::synthetic_spec(SyntheticKind::flat, 12000, 60));
  const RadarSettings calm = radar(FrustumKind::sweep, 3, 2000, 10000);
  RadarSettings rough = calm;
  rough.sea.state = 5;
  const Frame before = render_sea(world, calm, 500), during = render_sea(world, rough, 500);
  const auto at = static_cast<std::size_t>(calm.range_bins - 8);  // 9.5 km, 3 degrees
  EXPECT_NEAR(10 * std::log10(during.bins.power_w[at] / before.bins.power_w[at]), 7.56, 0.1);
  test::expect_same_bits(before.bins, render_sea(world, calm, 500).bins);
}

TEST(Sea, IsFiniteWhereTheModelEnds) {
  // Straight below, one metre up, at and below the horizon, a lake at 4,000 m beside the sea, at the ends of
  // frequency and state; on one thread and on two.
  const auto scene = test::make_scene(coast(), land_and_sea());
  for (const double ghz : {0.5, 9.4, 35.0})
    for (const double state : {1.0, 6.0})
      for (const glm::dvec3& at : {glm::dvec3(-500, 1, -1500), glm::dvec3(-500, 900, 0),
                                   glm::dvec3(-6000, 4001, 0), glm::dvec3(-4000, 9000, 0)}) {
        RadarSettings s = radar(FrustumKind::sweep, state, 0, 9000);
        s.sector_deg = 360;
        s.frequency_ghz = ghz;
        s.atmosphere.wind_m_s = 10;
        const Pose pose = test::pose_at(scene->world(), at, 0);
        RenderOptions one, two;
        one.threads = 1;
        two.threads = 2;
        const Frame frame = render(scene, test::snapshot(s), pose, {0, s.azimuth_bins}, one);
        test::expect_same_bits(frame.bins,
                               render(scene, test::snapshot(s), pose, {0, s.azimuth_bins}, two).bins);
        for (const auto power : frame.bins.power_w) ASSERT_TRUE(std::isfinite(power) && power >= 0);
        EXPECT_GT(frame.stats.lit_bins, 0u);
      }
}

}  // namespace
}  // namespace obliq::sea_test
