// A street of houses close to the antenna, against the reference renderer: the sweep without a plane of its
// own for each house is as good as with exact planes.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "server/accuracy/bin_errors.h"
#include "server/accuracy/truth_bins.h"
#include "tests/support/made_worlds.h"
#include "tests/support/scenes.h"

namespace obliq::street_test {
namespace {

/// Houses of 20 to 60 m on both sides of a street that runs north from 20 to 300 m, and behind them, over
/// ground that rises and falls by a few metres; one of 30 m under the antenna.
std::shared_ptr<const Scene> street(const std::vector<Material>& materials) {
  World world = test::made_world(
      600, 10, [](double x, double z) { return 3 * std::sin(x / 60) * std::cos(z / 80) + 0.01 * z; });
  test::add_prism(world, test::rectangle(0, 0, 16, 12), 30);
  for (int n = 0; n < 60; ++n) {
    const double golden = n * 0.618 - std::floor(n * 0.618);
    const double side = n % 2 == 0 ? -1 : 1;
    const double x = side * (14 + 26 * (n % 6 / 2) + 8 * golden), z = 20 + 280 * (n / 6) / 10.0 + 12 * golden;
    const double turn = n % 3 == 0 ? 0 : 0.6 * golden;
    const double width = 12 + 6 * golden, depth = 10 + 8 * (1 - golden);
    const glm::dvec2 at(x, z), u(width * std::cos(turn), width * std::sin(turn));
    const glm::dvec2 v(-depth * std::sin(turn), depth * std::cos(turn));
    test::add_prism(world, {at, at + u, at + u + v, at + v}, 20 + 40 * (n * 7 % 60) / 59.0);
  }
  return test::make_scene(std::move(world), materials);
}

RadarSettings settings() {
  RadarSettings s;
  s.frustum = FrustumKind::sweep;
  s.sector_deg = 60;
  s.azimuth_bins = 120;
  s.range_bins = 76;
  s.r_min_m = 20;
  s.r_max_m = 400;
  s.pixel_columns = 240;
  return s;
}

BinErrors errors_of(const std::shared_ptr<const Scene>& scene, const Pose& pose, int sub_columns,
                    const TruthBins& truth) {
  RadarSettings s = settings();
  s.sub_columns = sub_columns;
  RenderOptions options;
  options.states = false;
  const Frame frame = render(scene, test::snapshot(s), pose, {0, s.azimuth_bins}, options);
  return bin_errors(frame.bins.power_w, truth.power_w(Returns::all), range_bins(s));
}

TEST(Street, IsAsGoodAsWithAPlaneForEachHouse) {
  std::vector<Material> gamma = test::two_materials();
  gamma[1].model = ScatteringModel::constant_gamma;
  gamma[1].gamma = 3;
  for (const auto& materials : {gamma, test::two_materials()}) {
    const auto scene = street(materials);
    const double ground_m = scene->world().grid.height_at_m(0, 0);
    for (const double height_m : {32.0, 70.0}) {
      const Pose pose = test::pose_at(scene->world(), {0.5, ground_m + height_m, 1}, 0);
      const PlanResult planned = plan_frame(scene, test::snapshot(settings()), pose);
      ASSERT_TRUE(planned.plan) << all_text(planned.errors);
      const TruthBins truth = integrate_truth(*planned.plan, {{0, settings().azimuth_bins}}, {32, 2, 2});
      const BinErrors exact = errors_of(scene, pose, 0, truth);
      const BinErrors echoes = errors_of(scene, pose, 64, truth);
      std::printf("    antenna %.0f m up: E %.4f, with exact planes %.4f; gaps %.2f %% and %.2f %%\n",
                  height_m, echoes.power_error, exact.power_error, 100 * echoes.gap_fraction(),
                  100 * exact.gap_fraction());
      EXPECT_GT(echoes.lit, 1000u);
      EXPECT_LE(echoes.power_error, exact.power_error + 0.005);
    }
  }
}

}  // namespace
}  // namespace obliq::street_test
