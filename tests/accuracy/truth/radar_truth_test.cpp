// Bins behind a beam and a pulse against the reference renderer on 8 times as many bins each way, summed in
// double: the whole chain from ground to bin by a second way.
#include "server/accuracy/radar_truth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "server/accuracy/bin_errors.h"
#include "tests/support/scenes.h"

namespace obliq::radar_truth_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kBinsOfPulse = 4;

/// A beam of 3 degrees over bins of half a degree, a pulse that resolves four range bins; elevation by a
/// cosecant. With bins as long as the pulse resolves E is 0.06, whatever the sampling: where in its bin a
/// house stands is not known any more.
RadarSettings radar() {
  RadarSettings s = test::radar_settings(FrustumKind::sweep, {3000, 6000, 20}, {40, 96}, {80});
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
  const auto scene = test::hills_with_houses(40);
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

// Steeply below the antenna a beam is wider on the ground than over all azimuths: the truth against the
// integral of g^2 at the angle whose sine is cos(e) sin(azimuth) (Simpson's rule over both sides), g of a
// Gaussian beam written out here.

/// Of level ground at a depression through a Gaussian beam, in units of the sharp one's.
double seen_by_beam_rad(double depression_rad, double width_deg) {
  constexpr int kSteps = 20000;
  double sum = 0;
  for (int k = 0; k <= kSteps; ++k) {
    const double azimuth = (static_cast<double>(k) / kSteps - 0.5) * kPi;
    const double u = std::asin(std::cos(depression_rad) * std::sin(azimuth)) * 180 / kPi;
    const double g2 = std::exp(-8 * std::numbers::ln2 * u * u / (width_deg * width_deg));
    sum += g2 * (k == 0 || k == kSteps ? 1 : k % 2 == 1 ? 4 : 2);
  }
  return sum * kPi / kSteps / 3;
}

/// Level ground seen at a depression in the middle of a few range bins, 1 km below: a sharp bin has
/// K gamma h w (1/r1^3 - 1/r2^3) / 3; the beam's width changes within the bin.
struct SteepView {
  RadarSettings settings;
  double expected_w;
};
SteepView steep(double depression_deg, double gamma, double width_deg = 3) {
  const double depression = depression_deg * kPi / 180;
  RadarSettings s = radar();
  s.beam.elevation = ElevationPattern::off;
  s.beam.width_deg = width_deg;
  s.beam.extent_deg = 4 * width_deg;
  s.pulse.kind = PulseKind::off;
  s.azimuth_bins = 40;
  s.range_bins = 5;
  const double range_m = 1000 / std::sin(depression);
  const double half_m = std::min(20.0, (range_m - 1000) / 2);
  s.r_min_m = range_m - half_m;
  s.r_max_m = range_m + half_m;
  constexpr int kParts = 32;
  double sum = 0;
  for (int k = 0; k < kParts; ++k) {
    const double r1 = range_m + half_m / 5 * (2.0 * k / kParts - 1);
    const double r2 = range_m + half_m / 5 * (2.0 * (k + 1) / kParts - 1);
    sum += (std::pow(r1, -3) - std::pow(r2, -3)) * seen_by_beam_rad(std::asin(2000 / (r1 + r2)), width_deg);
  }
  const double lambda = 299792458.0 / (s.frequency_ghz * 1e9);
  return {s, lambda * lambda / std::pow(4 * kPi, 3) * gamma * 1000 / 3 * sum};
}

double db_of(double ratio) { return 10 * std::log10(ratio); }

TEST(RadarTruth, OfGroundSteeplyBelowIsTheIntegralOfTheBeam) {
  const auto scene = test::make_scene(load_world(test::synthetic_spec(SyntheticKind::flat, 4000, 20)));
  for (const double depression_deg : {45.0, 60.0, 65.0, 70.0, 75.0, 80.0, 85.0}) {
    const SteepView view = steep(depression_deg, scene->materials()[0].gamma);
    const TruthBins truth = integrate_radar_truth(*planned(scene, view.settings), {{20, 1}}, {8, 2, 2});
    // The bin's own spread of elevations, and layers of 1 %: some thousandths.
    EXPECT_NEAR(truth.ground_w[2] / view.expected_w, 1, 0.01) << depression_deg;
  }
}

/// What a frame has of the expected power in the middle azimuth of a SteepView.
double steep_frame_db(const std::shared_ptr<const Scene>& scene, const SteepView& view) {
  const RadarSettings& s = view.settings;
  const Frame frame = render(scene, test::snapshot(s), antenna(*scene), {0, s.azimuth_bins});
  return db_of(frame.bins.power_w[static_cast<std::size_t>(s.azimuth_bins / 2 * s.range_bins + 2)] /
               view.expected_w);
}

// By sub-columns, by exact planes and by rays, all of which take the beam's width where they add an echo.
TEST(FramesOfLevelGround, HaveTheBeamsPowerHoweverSteeplyItLooksDown) {
  const auto scene = test::make_scene(load_world(test::synthetic_spec(SyntheticKind::flat, 8000, 20)));
  for (const double width_deg : {3.0, 10.0})
    for (const double depression_deg : {15.0, 30.0, 45.0, 60.0, 65.0, 70.0, 75.0, 80.0, 85.0})
      for (const int sub_columns : {0, 64}) {
        SteepView view = steep(depression_deg, scene->materials()[0].gamma, width_deg);
        view.settings.sub_columns = sub_columns;
        EXPECT_NEAR(steep_frame_db(scene, view), 0, 0.02)
            << width_deg << " degrees at " << depression_deg << ", sub-columns " << sub_columns;
      }
}

// From straight below to 60 degrees: where the ground is seen along the sine s of its depression, dP =
// K gamma W s^2 ds / h^2. A dark or bright nadir would tell.
TEST(FramesOfLevelGround, HaveTheBeamsPowerFromStraightBelowOn) {
  const auto scene = test::make_scene(load_world(test::synthetic_spec(SyntheticKind::flat, 8000, 20)));
  for (const double width_deg : {1.0, 3.0, 10.0}) {
    RadarSettings s = steep(45, 1, width_deg).settings;
    s.r_min_m = 900;
    s.r_max_m = 2000;
    s.range_bins = 110;
    constexpr int kParts = 600;
    double sum = 0;
    for (int k = 0; k < kParts; ++k) {
      const double depression = (30 + 60 * (k + 0.5) / kParts) * kPi / 180;
      sum += seen_by_beam_rad(depression, width_deg) * std::pow(std::sin(depression), 2) *
             std::cos(depression) * kPi / 3 / kParts;
    }
    const double lambda = 299792458.0 / (s.frequency_ghz * 1e9);
    const double expected_w =
        lambda * lambda / std::pow(4 * kPi, 3) * scene->materials()[0].gamma * sum / 1e6;
    for (const int sub_columns : {0, 64}) {
      s.sub_columns = sub_columns;
      const Frame frame = render(scene, test::snapshot(s), antenna(*scene), {0, s.azimuth_bins});
      double total_w = 0;
      for (int r = 0; r < s.range_bins; ++r)
        total_w += frame.bins.power_w[static_cast<std::size_t>(20 * s.range_bins + r)];
      EXPECT_NEAR(total_w / expected_w, 1, 0.01) << width_deg << " degrees, sub-columns " << sub_columns;
    }
  }
}

class RadarTruthOf : public testing::TestWithParam<std::pair<FrustumKind, double>> {};

TEST_P(RadarTruthOf, FramesAreWithinTheirErrorAndSeeAnotherBeam) {
  RadarSettings s = radar();
  const TruthBins truth = truth_of(test::hills_with_houses(40), s);
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
                                         std::pair{FrustumKind::oblique, 0.025}),
                         [](const auto& test) { return std::string(frustum_name(test.param.first)); });

}  // namespace
}  // namespace obliq::radar_truth_test
