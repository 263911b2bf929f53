// An antenna that is not stabilised: over level ground against a direct sum in closed form, over mountains
// against the reference renderer with the whole pattern as its gain. Both work an attitude out by turning a
// vector three times, which shares nothing with AntennaAxes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <numbers>
#include <optional>
#include <ostream>

#include "server/accuracy/truth_bins.h"
#include "server/radar/render.h"
#include "server/truth/reference.h"
#include "tests/support/same_bits.h"
#include "tests/support/scenes.h"
#include "tests/unit/terrain_files.h"

namespace obliq::attitude_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kHeight_m = 1000;
constexpr int kEvery = 16;  // scan angle of level ground that is compared

struct Attitude {
  double roll_deg, pitch_deg, nose_deg;  // nose_deg: the sector's centre from the nose
};
void PrintTo(const Attitude& a, std::ostream* out) {
  *out << "roll " << a.roll_deg << ", pitch " << a.pitch_deg << ", centre " << a.nose_deg << " from the nose";
}

struct Angles {
  double azimuth_rad, elevation_rad;
};

/// Where a platform of that attitude sees a direction, from its nose; both clockwise and upwards.
Angles seen_from(const Attitude& at, double from_nose_rad, double sine) {
  const double cosine = std::sqrt(1 - sine * sine);
  double ahead = cosine * std::cos(from_nose_rad);
  double right = cosine * std::sin(from_nose_rad);
  double up = sine;
  const double p = at.pitch_deg * kPi / 180;
  const double r = at.roll_deg * kPi / 180;
  // The nose goes up: what was level is now below it.
  const double ahead_pitched = ahead * std::cos(p) + up * std::sin(p);
  const double up_pitched = up * std::cos(p) - ahead * std::sin(p);
  // The right side goes down: what was level on the right is now above it.
  const double right_rolled = right * std::cos(r) - up_pitched * std::sin(r);
  const double up_rolled = up_pitched * std::cos(r) + right * std::sin(r);
  ahead = ahead_pitched;
  right = right_rolled;
  up = up_rolled;
  return {std::atan2(right, ahead), std::asin(std::clamp(up, -1.0, 1.0))};
}

RadarSettings radar(double r_min_m, double r_max_m) {
  RadarSettings s;
  s.frustum = FrustumKind::sweep;
  s.sub_columns = 0;
  s.sector_deg = 60;
  s.azimuth_bins = 240;
  s.pixel_columns = 480;
  s.range_bins = 600;
  s.r_min_m = r_min_m;
  s.r_max_m = r_max_m;
  s.beam.pattern = BeamPattern::gaussian;
  s.beam.width_deg = 3;
  s.beam.extent_deg = 9;
  s.beam.elevation = ElevationPattern::gaussian;
  s.beam.elevation_width_deg = 6;
  s.beam.stabilised = false;
  return s;
}

/// Two-way power gain of radar()'s antenna towards a direction, with its scan angle so far from the sector's
/// centre.
double two_way_gain(const RadarSettings& s, const Attitude& at, double tilt_deg, double scan_rad,
                    double azimuth_rad, double sine) {
  const Angles seen = seen_from(at, azimuth_rad + at.nose_deg * kPi / 180, sine);
  const double off = std::remainder(seen.azimuth_rad - scan_rad - at.nose_deg * kPi / 180, 2 * kPi);
  if (std::abs(off) > kPi / 2) return 0;
  const double u = std::asin(std::cos(seen.elevation_rad) * std::sin(off));
  if (std::abs(u) > s.beam.extent_deg * kPi / 180) return 0;
  const auto gaussian = [](double angle_rad, double width_deg) {
    const double widths = angle_rad * 180 / kPi / width_deg;
    return std::exp(-4 * std::numbers::ln2 * widths * widths);
  };
  const double gain = gaussian(u, s.beam.width_deg) *
                      gaussian(seen.elevation_rad - tilt_deg * kPi / 180, s.beam.elevation_width_deg);
  return gain * gain;
}

Pose turned(Pose pose, const Attitude& at, double tilt_deg) {
  pose.settings.roll_deg = at.roll_deg;
  pose.settings.pitch_deg = at.pitch_deg;
  pose.settings.heading_deg = pose.settings.bearing_deg - at.nose_deg;
  pose.settings.tilt_deg = tilt_deg;
  return pose;
}

const Attitude kAttitudes[] = {{0, 8, 0},    {25, 0, 0},   {-40, 10, 30},
                               {15, -12, 0}, {60, 5, -60}, {-20, -30, 120}};

class LevelGround : public testing::TestWithParam<Attitude> {};

// Bins within 20 dB of the peak, and the footprint's middle by a twentieth of a beamwidth. What is left is
// the beam's width on the ground, in steps of 2 % (cosine_steps): it shows where the pattern in elevation
// falls off along the scan angles.
TEST_P(LevelGround, BinsAreThoseOfADirectSum) {
  const Attitude at = GetParam();
  const RadarSettings s = radar(3000, 9000);
  // Towards ground 5 km ahead of the sector's centre.
  const double tilt_deg = seen_from(at, at.nose_deg * kPi / 180, -kHeight_m / 5000).elevation_rad * 180 / kPi;
  static const auto scene =
      test::make_scene(load_world(test::synthetic_spec(SyntheticKind::flat, 24000, 100)));
  const Pose pose = turned(test::pose_over_origin(scene->world(), kHeight_m), at, tilt_deg);
  const Frame frame = render(scene, test::snapshot(s), pose, {0, s.azimuth_bins});

  const double lambda = 299792458.0 / 10e9;
  const double k = lambda * lambda / std::pow(4 * kPi, 3);
  const double width_rad = s.sector_deg * kPi / 180 / s.azimuth_bins;
  const double spacing_m = (s.r_max_m - s.r_min_m) / s.range_bins;
  constexpr int kSteps = 3600;
  std::vector<double> expected(frame.bins.power_w.size());
  for (int r = 0; r < s.range_bins; ++r) {
    const double r1 = s.r_min_m + r * spacing_m;
    const double r2 = r1 + spacing_m;
    const double a_rad = k * kHeight_m * (1 / (r1 * r1 * r1) - 1 / (r2 * r2 * r2)) / 3;
    const double sine = -kHeight_m / ((r1 + r2) / 2);
    std::vector<Angles> seen;
    for (int step = 0; step < kSteps; ++step)
      seen.push_back(seen_from(at, (step + 0.5) * 2 * kPi / kSteps, sine));
    for (int a = 0; a < s.azimuth_bins; a += kEvery) {
      const double scan_rad = (a + 0.5 - s.azimuth_bins / 2.0) * width_rad;
      double sum = 0;
      for (int step = 0; step < kSteps; ++step) {
        const double off = std::remainder(
            seen[static_cast<std::size_t>(step)].azimuth_rad - scan_rad - at.nose_deg * kPi / 180, 2 * kPi);
        if (std::abs(off) > kPi / 3) continue;
        sum += two_way_gain(s, at, tilt_deg, scan_rad,
                            (step + 0.5) * 2 * kPi / kSteps - at.nose_deg * kPi / 180, sine);
      }
      expected[static_cast<std::size_t>(a * s.range_bins + r)] = a_rad * sum * 2 * kPi / kSteps;
    }
  }
  const double peak = *std::max_element(expected.begin(), expected.end());
  ASSERT_GT(peak, 0);
  double worst_db = 0, squares_db = 0, worst_place_deg = 0;
  int bins = 0;
  for (int r = 0; r < s.range_bins; ++r) {
    double got_w = 0, got_deg_w = 0, wanted_w = 0, wanted_deg_w = 0;
    for (int a = 0; a < s.azimuth_bins; a += kEvery) {
      const auto bin = static_cast<std::size_t>(a * s.range_bins + r);
      const double scan_deg = a * s.sector_deg / s.azimuth_bins;
      got_w += frame.bins.power_w[bin];
      got_deg_w += frame.bins.power_w[bin] * scan_deg;
      wanted_w += expected[bin];
      wanted_deg_w += expected[bin] * scan_deg;
      if (expected[bin] < peak / 100) continue;
      ++bins;
      const double off_db = 10 * std::log10(frame.bins.power_w[bin] / expected[bin]);
      squares_db += off_db * off_db;
      worst_db = std::max(worst_db, std::abs(off_db));
    }
    if (wanted_w > peak / 100)
      worst_place_deg = std::max(worst_place_deg, std::abs(got_deg_w / got_w - wanted_deg_w / wanted_w));
  }
  const double rms_db = std::sqrt(squares_db / bins);
  std::printf("    tilt %.1f deg: %d bins, %.4f dB rms, worst %.4f dB; footprint off by at most %.4f deg\n",
              tilt_deg, bins, rms_db, worst_db, worst_place_deg);
  EXPECT_GT(bins, 100);
  EXPECT_LT(rms_db, 0.015);
  EXPECT_LT(worst_db, 0.12);
  EXPECT_LT(worst_place_deg, s.beam.width_deg / 20);
}

INSTANTIATE_TEST_SUITE_P(SixAttitudes, LevelGround, testing::ValuesIn(kAttitudes));

struct Mountains {
  const char* name;
  const char* dem;
  double longitude_deg, latitude_deg, height_m;
};
void PrintTo(const Mountains& value, std::ostream* out) { *out << value.name; }

class OverMountains : public testing::TestWithParam<Mountains> {};

// Five scan angles, each with the power of everything that its pattern sees, facet by facet.
TEST_P(OverMountains, BinsAreThoseOfADirectSum) {
  const Mountains& m = GetParam();
  const std::string dem = test::shared_file(m.dem);
  if (dem.empty()) GTEST_SKIP() << test::no_shared_file(m.dem);
  RadarSettings s = radar(5000, 15'000);
  s.pixel_columns = 8 * s.azimuth_bins;
  WorldSpec spec = test::scene(m.longitude_deg, m.latitude_deg, s.r_max_m + 1000, {dem});
  spec.radius_factor = 4.0 / 3;
  spec.terrain.cell_m = 60;
  const auto scene = test::make_scene(load_world(spec));
  PoseSettings place;
  place.longitude_deg = m.longitude_deg;
  place.latitude_deg = m.latitude_deg;
  place.height_m = m.height_m;
  std::vector<FieldError> errors;
  const auto level = place_antenna(scene->world(), place, errors);
  ASSERT_TRUE(level) << all_text(errors);
  const Attitude at{20, -6, 0};
  const double tilt_deg = -8;
  const Pose pose = turned(*level, at, tilt_deg);
  const Frame frame = render(scene, test::snapshot(s), pose, {0, s.azimuth_bins});

  // Sharp azimuths of the ground for the reference, three beamwidths beyond what the sector's edges see.
  RadarSettings around = s;
  around.beam = {};
  around.beam.elevation = ElevationPattern::gaussian;
  around.sector_deg = 120;
  around.azimuth_bins = 480;
  around.pixel_columns = 960;
  const PlanResult planned = plan_frame(scene, test::snapshot(around), *level);
  ASSERT_TRUE(planned.plan) << all_text(planned.errors);
  const double width_rad = s.sector_deg * kPi / 180 / s.azimuth_bins;
  double seen_w = 0, expected_w = 0, off_w = 0;
  for (const int a : {10, 70, 120, 170, 230}) {
    const double scan_rad = (a + 0.5 - s.azimuth_bins / 2.0) * width_rad;
    ReferenceView view = reference_view(*planned.plan);
    view.two_way_gain = [&](double sine, double bearing_rad) {
      return two_way_gain(s, at, tilt_deg, scan_rad, bearing_rad - level->bearing_world_rad, sine);
    };
    const ReferenceBins truth =
        integrate_reference(scene->world(), scene->materials(), view, {4, 4, 2}, 0, 480);
    std::vector<double> row(static_cast<std::size_t>(s.range_bins));
    for (std::size_t bin = 0; bin < truth.ground_w.size(); ++bin)
      row[bin % row.size()] += truth.ground_w[bin];
    double of_row_w = 0, of_frame_w = 0;
    for (int r = 0; r < s.range_bins; ++r) {
      const double got = frame.bins.power_w[static_cast<std::size_t>(a * s.range_bins + r)];
      of_row_w += row[static_cast<std::size_t>(r)];
      of_frame_w += got;
      off_w += std::abs(got - row[static_cast<std::size_t>(r)]);
    }
    std::printf("    scan angle %+.2f deg: %+.4f dB\n", scan_rad * 180 / kPi,
                10 * std::log10(of_frame_w / of_row_w));
    EXPECT_NEAR(10 * std::log10(of_frame_w / of_row_w), 0, 0.02);
    seen_w += of_frame_w;
    expected_w += of_row_w;
  }
  std::printf("    %s: total %+.3f %%, bins off by %.3f %% of it\n", m.name, 100 * (seen_w / expected_w - 1),
              100 * off_w / expected_w);
  EXPECT_NEAR(seen_w / expected_w, 1, 0.003);
  EXPECT_LT(off_w / expected_w, 0.02);
}

INSTANTIATE_TEST_SUITE_P(
    RealGround, OverMountains,
    testing::Values(Mountains{"Lost River Range", "windninja_usfs/mackay.tif", -113.60, 43.80, 5000},
                    Mountains{"Rocky Mountain Park", "small/rmnp-dem.tif", -105.70, 40.19, 6000}));

// The steepest attitudes, straight below, round the whole circle, among houses, by every frustum: all finite,
// and the same bits from any number of threads.
TEST(Attitude, HardCasesAreFiniteAndTheSameFromAnyNumberOfThreads) {
  WorldSpec spec = test::synthetic_spec(SyntheticKind::hills, 12'000, 50);
  spec.terrain.shape.height_m = 600;
  const auto scene = test::make_scene(load_world(spec));
  for (const double sector_deg : {120.0, 360.0}) {
    for (const FrustumKind kind : {FrustumKind::sweep, FrustumKind::oblique, FrustumKind::symmetric}) {
      if (kind == FrustumKind::symmetric && sector_deg > 180) continue;
      for (const Attitude& at : {Attitude{60, 60, 45}, {-60, 60, 180}, {1e-300, 0, 0}, {0, -60, -90}}) {
        RadarSettings s = test::radar_settings(kind, {2000, 10000, sector_deg}, {120, 70}, {360, 140});
        if (kind == FrustumKind::sweep) s.r_min_m = 0;
        s.beam.pattern = BeamPattern::taylor;
        s.beam.width_deg = 8;
        s.beam.elevation = ElevationPattern::gaussian;
        s.beam.elevation_width_deg = 20;
        s.beam.stabilised = false;
        const Pose pose = turned(test::pose_over_origin(scene->world(), 1500, 40), at, -20);
        std::optional<Frame> one;
        for (const int threads : {1, 2, 8}) {
          RenderOptions options;
          options.threads = threads;
          options.labels = true;
          Frame frame = render(scene, test::snapshot(s), pose, {0, s.azimuth_bins}, options);
          EXPECT_TRUE(std::ranges::all_of(frame.bins.power_w, [](double w) { return w >= 0 && w < 1; }));
          EXPECT_TRUE(std::ranges::all_of(frame.bins.iq,
                                          [](std::complex<float> v) { return std::isfinite(std::abs(v)); }));
          EXPECT_TRUE(std::ranges::all_of(frame.bins.state, [](std::uint8_t state) { return state < 5; }));
          if (one) test::expect_same_bits(one->bins, frame.bins);
          if (!one) one = std::move(frame);
        }
      }
    }
  }
}

// I&Q have the power that the power plane says: an echo that two scan angles share loses next to none.
TEST(Attitude, VoltagesHaveTheMeanPower) {
  RadarSettings s = radar(3000, 9000);
  const auto scene = test::make_scene(load_world(test::synthetic_spec(SyntheticKind::hills, 24000, 100)));
  const Pose pose = turned(test::pose_over_origin(scene->world(), 2500), {20, -10, 0}, -15);
  double sum = 0;
  std::size_t bins = 0;
  for (int seed = 1; seed <= 12; ++seed) {
    s.speckle_seed = seed;
    const Frame frame = render(scene, test::snapshot(s), pose, {0, s.azimuth_bins});
    for (std::size_t bin = 0; bin < frame.bins.power_w.size(); ++bin)
      if (frame.bins.power_w[bin] > 0) {
        sum += std::norm(std::complex<double>(frame.bins.iq[bin])) / frame.bins.power_w[bin];
        ++bins;
      }
  }
  // Neighbouring rows share their speckle: some 12 rows a beamwidth count as one.
  std::printf("    mean |V|^2 / P %.4f of %zu bins\n", sum / static_cast<double>(bins), bins);
  EXPECT_NEAR(sum / static_cast<double>(bins), 1, 0.01);
}

TEST(Attitude, StabilisedMovesNoBit) {
  RadarSettings s = radar(3000, 9000);
  s.beam.stabilised = true;
  const auto scene = test::make_scene(load_world(test::synthetic_spec(SyntheticKind::hills, 24000, 100)));
  const Pose level = test::pose_over_origin(scene->world(), 2500);
  const Pose rolled = turned(level, {30, -20, 10}, 0);
  const Frame a = render(scene, test::snapshot(s), level, {0, s.azimuth_bins});
  const Frame b = render(scene, test::snapshot(s), rolled, {0, s.azimuth_bins});
  EXPECT_EQ(a.bins.power_w, b.bins.power_w);
  EXPECT_EQ(a.bins.iq, b.bins.iq);
}

TEST(Attitude, ALevelPlatformIsAStabilisedOne) {
  RadarSettings s = radar(3000, 9000);
  const auto scene = test::make_scene(load_world(test::synthetic_spec(SyntheticKind::hills, 24000, 100)));
  const Pose pose = test::pose_over_origin(scene->world(), 2500);
  const Frame a = render(scene, test::snapshot(s), pose, {0, s.azimuth_bins});
  const Frame hardly = render(scene, test::snapshot(s), turned(pose, {1e-7, 0, 0}, 0), {0, s.azimuth_bins});
  double sum = 0, difference = 0;
  for (std::size_t bin = 0; bin < a.bins.power_w.size(); ++bin) {
    sum += a.bins.power_w[bin];
    difference += std::abs(a.bins.power_w[bin] - hardly.bins.power_w[bin]);
  }
  EXPECT_LT(difference / sum, 1e-3);
}

}  // namespace
}  // namespace obliq::attitude_test
