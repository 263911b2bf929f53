// Bins behind a beam and a pulse against the reference renderer on 8 times as many bins each way, summed in
// double: the whole chain from ground to bin by a second way.
#include "server/accuracy/radar_truth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "server/accuracy/bin_errors.h"
#include "tests/support/scenes.h"
#include "tests/support/small_frames.h"

namespace obliq {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kBinsOfPulse = 4;

std::shared_ptr<const Scene> hills_with_houses() {
  static const auto scene = [] {
    WorldSpec spec = test::synthetic_spec(SyntheticKind::hills, 9000, 60);
    spec.terrain.shape.height_m = 150;
    PrismSpec houses;
    houses.per_km2 = 40;
    spec.prisms = {houses};
    return test::make_scene(load_world(spec));
  }();
  return scene;
}

/// A beam of 3 degrees over bins of half a degree, a pulse that resolves four range bins; elevation by a
/// cosecant. With bins as long as the pulse resolves E is 0.06, whatever the sampling: where in its bin a
/// house stands is not known any more.
RadarSettings radar() {
  RadarSettings s;
  s.frustum = FrustumKind::sweep;
  s.sector_deg = 20;
  s.azimuth_bins = 40;
  s.pixel_columns = 80;
  s.range_bins = 96;
  s.r_min_m = 3000;
  s.r_max_m = 6000;
  s.beam.pattern = BeamPattern::gaussian;
  s.beam.width_deg = 3;
  s.beam.elevation = ElevationPattern::cosecant;
  s.beam.cosecant_to_deg = 35;
  s.pulse.kind = PulseKind::compressed;
  s.pulse.window = PulseWindow::hamming;
  s.pulse.bandwidth_mhz = 299.792458 / 2 / (31.25 * kBinsOfPulse);
  return s;
}

Pose antenna(const Scene& scene) {
  Pose pose = test::pose_over_origin(scene.world(), 1000);
  pose.settings.tilt_deg = -4;
  return pose;
}

std::shared_ptr<const FramePlan> planned(const std::shared_ptr<const Scene>& scene, const RadarSettings& s) {
  const PlanResult result = plan_frame(scene, test::snapshot(s), antenna(*scene));
  EXPECT_TRUE(result.plan) << all_text(result.errors);
  return result.plan;
}

TruthBins truth_of(const std::shared_ptr<const Scene>& scene, const RadarSettings& s, int planes = 16) {
  return integrate_radar_truth(*planned(scene, s), {{0, s.azimuth_bins}}, {planes, 2, 2});
}

BinErrors errors_of(const RadarSettings& s, const TruthBins& truth) {
  const auto scene = hills_with_houses();
  const Frame frame = render(scene, test::snapshot(s), antenna(*scene), {0, s.azimuth_bins}, {});
  const std::vector<double> power_w(frame.bins.power_w.begin(), frame.bins.power_w.end());
  return bin_errors(power_w, truth.power_w(Returns::all), range_bins(s));
}

TEST(RadarTruth, OfLevelGroundIsTheClosedForm) {
  // Without a pattern in elevation: K gamma H (1/r1^3 - 1/r2^3) / 3 theta_eq, on the ground 1 / cos(e) wider
  // (a beam of small angles), times the sum of p^2 over a Hamming response's bins, 1.3628.
  RadarSettings s = radar();
  s.beam.elevation = ElevationPattern::off;
  s.beam.extent_deg = 12;
  s.pulse.extent_bins = 32 * kBinsOfPulse;
  s.r_min_m = 5000;
  s.r_max_m = 8000;
  const auto scene = test::make_scene(load_world(test::synthetic_spec(SyntheticKind::flat, 12000, 100)));
  const TruthBins truth = truth_of(scene, s, 8);
  const double height_m = 1000;
  const double lambda = 299792458.0 / (s.frequency_ghz * 1e9);
  const double constant = lambda * lambda / std::pow(4 * kPi, 3);
  const double spacing = (s.r_max_m - s.r_min_m) / s.range_bins;
  for (const int m : {40, 60, 80}) {
    const double r1 = s.r_min_m + m * spacing, r2 = r1 + spacing;
    const double cosine = std::sqrt(1 - std::pow(height_m / ((r1 + r2) / 2), 2));
    const double equivalent_rad = 3 * kPi / 180 * std::sqrt(kPi / (8 * std::numbers::ln2)) / cosine;
    const double expected = constant * height_m * (std::pow(r1, -3) - std::pow(r2, -3)) / 3 * equivalent_rad *
                            1.3628 * kBinsOfPulse * scene->materials()[0].gamma;
    for (const int k : {0, 20, 39}) {
      const auto at = static_cast<std::size_t>(k * s.range_bins + m);
      EXPECT_NEAR(truth.ground_w[at] / expected, 1, 2e-3) << k << ", " << m;
    }
  }
}

TEST(RadarTruth, OfACosecantIsTheSameInEveryRangeBin) {
  RadarSettings s = radar();
  s.pulse.kind = PulseKind::off;
  const auto scene = test::make_scene(load_world(test::synthetic_spec(SyntheticKind::flat, 12000, 100)));
  const TruthBins truth = truth_of(scene, s, 8);
  // The nose is 4 degrees down, the cosecant begins 3 degrees below it: at ranges nearer than 8 km.
  for (int m = 0; m < s.range_bins; ++m) {
    const double sine = 1000 / (s.r_min_m + (m + 0.5) * (s.r_max_m - s.r_min_m) / s.range_bins);
    const double wider = std::sqrt(1 - sine * sine);
    const auto at = static_cast<std::size_t>(20 * s.range_bins + m);
    const auto first = static_cast<std::size_t>(20 * s.range_bins);
    const double first_sine = 1000 / (s.r_min_m + 0.5 * (s.r_max_m - s.r_min_m) / s.range_bins);
    EXPECT_NEAR(truth.ground_w[at] * wider / (truth.ground_w[first] * std::sqrt(1 - first_sine * first_sine)),
                1, 2e-3)
        << m;
  }
}

class RadarTruthOf : public testing::TestWithParam<std::pair<FrustumKind, double>> {};

TEST_P(RadarTruthOf, FramesAreWithinTheirErrorAndSeeAnotherBeam) {
  RadarSettings s = radar();
  const TruthBins truth = truth_of(hills_with_houses(), s);
  s.frustum = GetParam().first;
  s.pixel_columns = s.frustum == FrustumKind::sweep ? 80 : 320;
  s.pixel_rows = 1024;
  const BinErrors good = errors_of(s, truth);
  RecordProperty("power_error", std::to_string(good.power_error));
  EXPECT_LT(good.power_error, GetParam().second);
  EXPECT_EQ(good.gaps, 0u);
  RadarSettings wider = s;
  wider.beam.width_deg = 3.3;
  EXPECT_GT(errors_of(wider, truth).power_error, 0.05);
  RadarSettings higher = s;
  higher.beam.elevation_width_deg *= 1.2;
  EXPECT_GT(errors_of(higher, truth).power_error, 0.05);
  RadarSettings another = s;
  another.pulse.window = PulseWindow::hann;
  EXPECT_GT(errors_of(another, truth).power_error, 0.05);
}
INSTANTIATE_TEST_SUITE_P(EachFrustum, RadarTruthOf,
                         testing::Values(std::pair{FrustumKind::sweep, 0.022},
                                         std::pair{FrustumKind::polar, 0.022},
                                         std::pair{FrustumKind::oblique, 0.025}),
                         [](const auto& test) { return std::string(frustum_name(test.param.first)); });

}  // namespace
}  // namespace obliq
