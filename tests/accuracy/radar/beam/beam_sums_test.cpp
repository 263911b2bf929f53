// Beam and pulse through the whole pipeline against closed forms: mean powers. Statistics are in
// beam_statistics_test.cpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/radar/beam/beam_on_ground.h"
#include "server/radar/beam/echo_plan.h"
#include "server/radar/beam/patterns.h"
#include "server/radar/beam/point_response.h"
#include "server/radar/wedge_work.h"
#include "tests/support/made_worlds.h"
#include "tests/support/scenes.h"

namespace obliq::beam_sums_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kSpeedOfLight_m_s = 299792458.0;
constexpr double kHeight_m = 1000;

std::shared_ptr<const Scene> flat_scene() {
  static const auto scene =
      test::make_scene(load_world(test::synthetic_spec(SyntheticKind::flat, 24000, 100)));
  return scene;
}

/// 0.2 deg and 20 m a bin, by the exact sweep unless told.
RadarSettings settings(int sub_columns = 0) {
  RadarSettings s;
  s.frustum = FrustumKind::sweep;
  s.sub_columns = sub_columns;
  s.sector_deg = 16;
  s.azimuth_bins = s.pixel_columns = 80;
  s.range_bins = 200;
  s.r_min_m = 4000;
  s.r_max_m = 8000;
  return s;
}

RadarSettings with_beam(BeamPattern pattern, double width_deg, int sub_columns = 0) {
  RadarSettings s = settings(sub_columns);
  s.beam.pattern = pattern;
  s.beam.width_deg = width_deg;
  return s;
}

Frame rendered(const RadarSettings& s, const std::shared_ptr<const Scene>& scene = flat_scene(),
               const RenderOptions& options = {}) {
  return render(scene, test::snapshot(s), test::pose_over_origin(scene->world(), kHeight_m),
                {0, s.azimuth_bins}, options);
}

double power_of(const Frame& frame, int azimuth, int range) {
  return frame.bins.power_w[static_cast<std::size_t>(azimuth) * static_cast<std::size_t>(frame.bins.n_range) +
                            static_cast<std::size_t>(range)];
}

double range_constant() {
  const double lambda = kSpeedOfLight_m_s / 10e9;
  return lambda * lambda / std::pow(4 * kPi, 3);
}

/// Of level ground of gamma 1 in a range bin, a radian wide.
double level_ground_a_rad(const RadarSettings& s, int bin) {
  const double spacing = (s.r_max_m - s.r_min_m) / s.range_bins;
  const double r1 = s.r_min_m + bin * spacing;
  const double r2 = r1 + spacing;
  return range_constant() * kHeight_m * (1 / (r1 * r1 * r1) - 1 / (r2 * r2 * r2)) / 3;
}

TEST(BeamSums, LevelGroundHasThePowerOfTheEquivalentBeamwidth) {
  // theta_eq on the horizon; on the ground 1 / cos(e) wider, in each range bin, though one kernel serves 16.
  for (const auto& [pattern, in_widths] :
       {std::pair{BeamPattern::gaussian, std::sqrt(kPi / (8 * std::numbers::ln2))},
        {BeamPattern::uniform, 2.0 / 3 / 0.88589}}) {
    RadarSettings s = with_beam(pattern, 0.6);  // three bins
    s.beam.extent_deg = 6;
    const Frame frame = rendered(s);
    const double equivalent_rad = 0.6 * kPi / 180 * in_widths;
    for (const int tile : {0, 3, 11}) {
      for (int r = tile * 16; r < tile * 16 + 16; ++r) {
        const double cosine = std::sqrt(1 - std::pow(kHeight_m / (4000 + (r + 0.5) * 20), 2));
        for (const int a : {0, 40, 79})
          EXPECT_NEAR(power_of(frame, a, r) / (level_ground_a_rad(s, r) * equivalent_rad / cosine), 1, 1.5e-4)
              << "range bin " << r << " azimuth " << a;
      }
    }
  }
}

class CosecantOverLevelGround : public testing::TestWithParam<int> {};

TEST_P(CosecantOverLevelGround, ReturnsTheSamePowerFromEveryRangeBin) {
  RadarSettings s = settings(GetParam());
  s.r_min_m = 3000;
  s.r_max_m = 16000;
  s.range_bins = 650;
  s.beam.elevation = ElevationPattern::cosecant;
  s.beam.elevation_width_deg = 3;
  s.beam.cosecant_to_deg = 40;
  const Frame frame = rendered(s);
  // dOmega r^2 = w h delta; G = G1 (sin e1 / sin e)^2 below the shoulder, 1.5 deg down, where G1 is half.
  const double shoulder = 1.5 * kPi / 180;
  const double width = 0.2 * kPi / 180;
  const double spacing = 20;
  const double expected =
      range_constant() * width * spacing * 0.25 * std::pow(std::sin(shoulder), 4) / std::pow(kHeight_m, 3);
  double least = 1e9, most = 0;
  for (int r = 0; r < s.range_bins; ++r) {
    least = std::min(least, power_of(frame, 3, r) / expected);
    most = std::max(most, power_of(frame, 3, r) / expected);
  }
  // Floats keep an edge to 4 mm of 20 m: twice that. A gain at a bin's mean range adds delta^2 / 3 r^2.
  const double tolerance = GetParam() == 0 ? 1e-4 : 4e-4;
  EXPECT_NEAR(least, 1, tolerance);
  EXPECT_NEAR(most, 1, tolerance);
}
INSTANTIATE_TEST_SUITE_P(ExactAndFast, CosecantOverLevelGround, testing::Values(0, 64));

TEST(BeamSums, ElevationIsAboutTheAntennasOwnVertical) {
  // Effective earth of factor 4/3: 20 km off the origin the plumb line leans by 20 km / (4/3 R) = 0.135 deg.
  WorldSpec spec = test::synthetic_spec(SyntheticKind::flat, 60000, 200);
  spec.radius_factor = 4.0 / 3;
  const auto scene = test::make_scene(load_world(spec));
  RadarSettings s = settings(64);
  s.r_min_m = 8000;
  s.r_max_m = 12000;
  s.beam.elevation = ElevationPattern::gaussian;
  s.beam.elevation_width_deg = 3;
  const auto powers = [&](double north_deg, int sub_columns) {
    s.sub_columns = sub_columns;
    PoseSettings at = test::settings_over_origin(kHeight_m, 0);
    at.latitude_deg += north_deg;
    at.tilt_deg = -8;  // on its shoulder
    std::vector<FieldError> errors;
    return render(scene, test::snapshot(s), *place_antenna(scene->world(), at, errors), {0, 8});
  };
  for (const int sub_columns : {0, 64}) {
    const Frame here = powers(0, sub_columns);
    const Frame away = powers(0.18, sub_columns);
    for (const int r : {10, 100, 190})
      // About the world's vertical they would differ by 4 dB/deg x 0.135 deg, both ways: 1.1 dB, 0.28.
      EXPECT_NEAR(power_of(away, 4, r) / power_of(here, 4, r), 1, 5e-3) << r;
  }
}

/// A tower narrower than a bin in the middle of azimuth bin 40, alone.
Frame tower(const RadarSettings& s) {
  World world = load_world(test::synthetic_spec(SyntheticKind::flat, 24000, 100));
  const double bearing = 0.1 * kPi / 180;
  test::add_prism(world, test::rectangle(6000 * std::sin(bearing), 6000 * std::cos(bearing), 4, 4), 30);
  RenderOptions options;
  options.surfaces = Surfaces::buildings;
  return rendered(s, test::make_scene(std::move(world)), options);
}

TEST(BeamSums, ATowerBecomesAnArcOfTheBeamsShape) {
  RadarSettings s = with_beam(BeamPattern::taylor, 1.0);
  s.beam.extent_deg = 3;
  const Frame frame = tower(s);
  const AzimuthPattern pattern(s);
  int range = 0;
  for (int r = 1; r < s.range_bins; ++r)
    if (power_of(frame, 40, r) > power_of(frame, 40, range)) range = r;
  ASSERT_GT(power_of(frame, 40, range), 0);
  // As wide as at the elevation of the tower's middle, in steps of 2 %.
  const double cosine = cosine_steps::cosine(cosine_steps::nearest((15 - kHeight_m) / 6080));
  for (int a = 27; a <= 53; ++a) {
    const double on_ground = (a - 40) * 0.2 * kPi / 180;
    const double gain = pattern.power_gain(std::asin(cosine * std::sin(on_ground)));
    EXPECT_NEAR(power_of(frame, a, range) / power_of(frame, 40, range), gain * gain, 1e-6) << a;
  }
}

TEST(BeamSums, ATowerHasTheRangeSidelobesOfItsWindow) {
  RadarSettings s = settings();
  s.pulse.kind = PulseKind::compressed;
  s.pulse.window = PulseWindow::hamming;
  s.pulse.extent_bins = 150;
  s.pulse.bandwidth_mhz = kSpeedOfLight_m_s / 2 / (20 * 12) / 1e6;  // a resolution of twelve bins
  const Frame frame = tower(s);
  RadarSettings sharp = s;
  sharp.pulse.kind = PulseKind::off;
  const Frame truth = tower(sharp);
  const PointResponse response(s);
  double most = 0;
  for (int r = 0; r < s.range_bins; ++r) most = std::max(most, power_of(frame, 40, r));
  for (int r = 0; r < s.range_bins; ++r) {
    double expected = 0;
    for (int q = 0; q < s.range_bins; ++q)
      expected += power_of(truth, 40, q) * std::pow(response.at((r - q) * 20.0), 2);
    EXPECT_NEAR(power_of(frame, 40, r) / most, expected / most, 2e-6) << r;
  }
}

TEST(BeamSums, APulseKeepsLevelGroundsPowerTimesItsEquivalentLength) {
  for (const auto& [kind, window, sum] : {std::tuple{PulseKind::compressed, PulseWindow::hamming, 1.3628},
                                          {PulseKind::compressed, PulseWindow::hann, 1.5},
                                          {PulseKind::compressed, PulseWindow::taylor, 1.1719},
                                          {PulseKind::rectangular, PulseWindow::none, 2.0 / 3}}) {
    RadarSettings s = settings();
    s.pulse.kind = kind;
    s.pulse.window = window;
    s.pulse.bandwidth_mhz = kSpeedOfLight_m_s / 2 / 40 / 1e6;
    s.pulse.length_us = 40 / (kSpeedOfLight_m_s / 2) * 1e6;
    s.pulse.extent_bins = 64;
    const Frame frame = rendered(s);
    for (const int r : {100, 150, 199})
      // Power falls as r^-4: a response 40 m long sees 1e-4 more of it near than far.
      EXPECT_NEAR(power_of(frame, 7, r) / (level_ground_a_rad(s, r) * 0.2 * kPi / 180 * 2 * sum), 1, 1.2e-3)
          << r;
  }
}

TEST(BeamSums, AnEclipsedEchoIsCutInProportion) {
  RadarSettings s = settings();
  s.pulse.kind = PulseKind::compressed;
  s.pulse.bandwidth_mhz = kSpeedOfLight_m_s / 2 / 20 / 1e6;
  s.pulse.length_us = 6000 / (kSpeedOfLight_m_s / 2) * 1e6;  // blind to half of 6 km
  const Frame whole = rendered(s);
  s.pulse.eclipse = true;
  const Frame cut = rendered(s);
  for (const int r : {40, 70, 150}) {
    const double share = std::min(1.0, (4000 + (r + 0.5) * 20) / 6000);
    EXPECT_NEAR(power_of(cut, 7, r) / power_of(whole, 7, r), share * share, 2e-4) << r;
  }
}

TEST(BeamSums, ABeamNarrowerThanTwoBinsSeesWhatFinerBinsWouldSee) {
  RadarSettings coarse = with_beam(BeamPattern::gaussian, 0.14, 64);  // 0.7 bins: three parts
  coarse.beam.extent_deg = 0.4;
  coarse.pixel_columns = 3 * coarse.azimuth_bins;
  coarse.pulse.kind = PulseKind::compressed;
  coarse.pulse.bandwidth_mhz = kSpeedOfLight_m_s / 2 / 7 / 1e6;  // three as well
  RadarSettings fine = coarse;
  fine.azimuth_bins *= 3;
  fine.range_bins *= 3;
  fine.pulse.extent_bins = 3 * coarse.pulse.extent_bins + 1;
  const Frame a = rendered(coarse);
  const Frame b = rendered(fine);
  for (const int azimuth : {0, 33, 79})
    for (const int range : {0, 100, 199}) {
      const double expected = power_of(b, 3 * azimuth + 1, 3 * range + 1);
      // The two share their sharp bins, but not the tiles over which a beam has one width: half a tile of 110
      // m.
      EXPECT_NEAR(power_of(a, azimuth, range) / expected, 1, 3e-4) << azimuth << " " << range;
    }
}

TEST(BeamSums, ACircleHasNoSeam) {
  RadarSettings s = with_beam(BeamPattern::gaussian, 6);
  s.sector_deg = 360;
  s.azimuth_bins = s.pixel_columns = 180;
  const Frame frame = rendered(s);
  for (const int r : {0, 100})
    for (int a = 0; a < 180; ++a) EXPECT_NEAR(power_of(frame, a, r) / power_of(frame, 90, r), 1, 1e-6) << a;
}

TEST(BeamSums, ASectorThatTheBeamClosesIsPartOfTheCircle) {
  RadarSettings circle = with_beam(BeamPattern::gaussian, 20, 64);
  circle.speckle = SpeckleKind::none;
  circle.sector_deg = 360;
  circle.azimuth_bins = circle.pixel_columns = 360;
  RadarSettings sector = circle;
  sector.sector_deg = 331;  // odd: its bins stand half a bin off the circle's middle
  sector.azimuth_bins = sector.pixel_columns = 331;
  WorldSpec spec = test::synthetic_spec(SyntheticKind::hills, 12000, 100);
  const auto scene = test::make_scene(load_world(spec));
  const Frame whole =
      render(scene, test::snapshot(circle), test::pose_over_origin(scene->world(), 2000, 14.5), {0, 360});
  const Frame part =
      render(scene, test::snapshot(sector), test::pose_over_origin(scene->world(), 2000), {0, 331});
  // Bin a of the sector begins at a - 165.5 deg, bin b of the circle at b - 180 + 14.5 = b - 165.5 deg.
  for (const int a : {0, 1, 165, 330})
    for (const int r : {0, 60, 199})
      EXPECT_NEAR(power_of(part, a, r) / power_of(whole, a, r), 1, 1e-5) << a << " " << r;
}

/// The sharp bins that a frame is made from, of 1 W, as wide as the beam is on their ground.
BinBlock sharp_bins(const FramePlan& plan) {
  const ScenePlan& sharp = plan.looks_at();
  BinBlock all(0, sharp.bins().n_azimuth, sharp.bins().n_range);
  all.sin_elevation.resize(all.power_w.size());
  const FrameTables tables(sharp);
  WedgeWork work(plan, tables, Surfaces::all, true, LabelParts::none);
  for (int wedge = 0; wedge < wedge_count(all.n_azimuth); ++wedge) {
    render_wedge(work, wedge, {});
    const BinBlock& bins = work.wedge.bins;
    copy_azimuths(bins, all);
    std::ranges::copy(bins.sin_elevation, all.sin_elevation.begin() +
                                              static_cast<std::ptrdiff_t>(bins.first_azimuth) * all.n_range);
  }
  return all;
}

TEST(BeamSums, ACirclesPowerIsThatOfTheSharpBinsEachAsWideAsTheBeamOnItsGround) {
  // Whatever the ground: the beam spreads what the sharp bins hold, it adds and loses nothing.
  RadarSettings s = settings(64);
  s.sector_deg = 360;
  s.azimuth_bins = s.pixel_columns = 720;
  const auto scene = test::make_scene(load_world(test::synthetic_spec(SyntheticKind::hills, 12000, 100)));
  const Pose pose = test::pose_over_origin(scene->world(), 2000);
  const Frame sharp = render(scene, test::snapshot(s), pose, {0, s.azimuth_bins});
  s.beam.pattern = BeamPattern::gaussian;
  s.beam.width_deg = 2;
  s.beam.extent_deg = 12;
  const PlanResult planned = plan_frame(scene, test::snapshot(s), pose);
  ASSERT_TRUE(planned.plan);
  const BinBlock wide = sharp_bins(*planned.plan);
  const Frame blurred = render(scene, test::snapshot(s), pose, {0, s.azimuth_bins});
  const double bin_rad = kPi / 360;
  const double equivalent_rad = 2 * kPi / 180 * std::sqrt(kPi / (8 * std::numbers::ln2));
  int lit = 0;
  for (const int r : {0, 37, 100, 199}) {
    double before = 0, after = 0;
    for (int a = 0; a < s.azimuth_bins; ++a) {
      const auto bin = static_cast<std::size_t>(a * s.range_bins + r);
      before += wide.power_w[bin];
      after += power_of(blurred, a, r);
      if (!(power_of(sharp, a, r) > 0)) continue;
      // The bin's own spread of elevations is in the mean, not in the mean's cosine.
      const double sine = static_cast<double>(wide.sin_elevation[bin]);
      EXPECT_NEAR(wide.power_w[bin] / power_of(sharp, a, r) * std::sqrt(1 - sine * sine) / equivalent_rad, 1,
                  2e-3)
          << a << ", " << r;
      ++lit;
    }
    ASSERT_GT(before, 0);
    EXPECT_NEAR(after * bin_rad / before, 1, 1e-6) << r;
  }
  EXPECT_GT(lit, 1000);
}

TEST(BeamSums, CountAndStateAreThoseOfTheBinsOwnGround) {
  WorldSpec spec = test::synthetic_spec(SyntheticKind::hills, 12000, 100);
  spec.terrain.shape.height_m = 500;
  const auto scene = test::make_scene(load_world(spec));
  RadarSettings s = settings(64);
  const Pose pose = test::pose_over_origin(scene->world(), 700);
  const Frame sharp = render(scene, test::snapshot(s), pose, {0, s.azimuth_bins});
  s.beam.pattern = BeamPattern::gaussian;
  s.beam.width_deg = 1;
  const Frame blurred = render(scene, test::snapshot(s), pose, {0, s.azimuth_bins});
  EXPECT_EQ(sharp.bins.count, blurred.bins.count);
  EXPECT_EQ(sharp.bins.state, blurred.bins.state);
  EXPECT_EQ(sharp.stats.lit_bins, blurred.stats.lit_bins);
  EXPECT_DOUBLE_EQ(sharp.stats.covered_area_m2, blurred.stats.covered_area_m2);
}

TEST(BeamSums, RangeNormalisationComesLast) {
  RadarSettings s = with_beam(BeamPattern::gaussian, 1);
  s.pulse.kind = PulseKind::compressed;
  const Frame plain = rendered(s);
  s.range_normalisation = true;
  const Frame normalised = rendered(s);
  for (const int r : {0, 77, 199}) {
    const double range_m = 4000 + (r + 0.5) * 20;
    EXPECT_NEAR(power_of(normalised, 5, r) / power_of(plain, 5, r) / std::pow(range_m, 4), 1, 1e-9);
  }
}

TEST(BeamSums, PowerAndGainScaleTheBinsHoweverSmall) {
  RadarSettings s = with_beam(BeamPattern::gaussian, 1);
  const Frame one = rendered(s);
  s.power_w = 1e-9;
  s.gain_db = -100;
  const Frame tiny = rendered(s);
  EXPECT_NEAR(power_of(tiny, 5, 50) / power_of(one, 5, 50) / 1e-29, 1, 1e-9);
  s.power_w = 0;
  const Frame silent = rendered(s);
  EXPECT_EQ(power_of(silent, 5, 50), 0);
  EXPECT_EQ(silent.bins.iq[50], std::complex<float>(0));
}

}  // namespace
}  // namespace obliq::beam_sums_test
