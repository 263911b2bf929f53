// Video of several looks against one look of the same speckle: its grain, its contrast and its law, behind a
// beam and a pulse and without them.
// The shipped X-band radars over level ground: a cosecant squared shows near, middle and far alike.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "server/control/scene_file.h"
#include "server/radar/frame_plan.h"
#include "server/radar/receiver/noise.h"
#include "server/radar/receiver/receiver.h"
#include "tests/support/scenes.h"

namespace obliq::video_looks_test {
namespace {

constexpr double kFloor_db = -260;
constexpr double kSpan_db = 200;
constexpr int kSeeds = 8;

std::shared_ptr<const Scene> hills_with_houses() { return test::hills_with_houses(150); }

/// Six azimuth bins a beamwidth and one and a half range bins a pulse, 0.1 deg and 15 m each.
RadarSettings radar(int looks) {
  RadarSettings s = test::radar_settings(FrustumKind::sweep, {3000, 6000, 12}, {120, 200}, {120});
  s.speckle = SpeckleKind::ground;
  s.beam.pattern = BeamPattern::gaussian;
  s.beam.width_deg = 0.6;
  s.pulse.kind = PulseKind::rectangular;
  s.pulse.length_us = 0.15;
  s.video.looks = looks;
  s.video.floor_auto = false;
  s.video.floor_db = kFloor_db;
  s.video.span_db = kSpan_db;
  return s;
}

/// 200 dB in 65,534 steps: 0.07 % of the power each.
double video_power(std::uint16_t level) {
  return level == 0 ? 0 : std::pow(10, (kFloor_db + (level - 1) * kSpan_db / 65534) / 10);
}

BinBlock frame_of(const std::shared_ptr<const Scene>& scene, const RadarSettings& s, AzimuthRange azimuths,
                  int threads = 0, bool iq = true) {
  RenderOptions options;
  options.threads = threads;
  options.iq = iq;
  options.states = false;
  options.video16 = true;
  options.draw = 11;
  return render(scene, test::snapshot(s), test::pose_over_origin(scene->world(), 1000), azimuths, options)
      .bins;
}
BinBlock frame_of(const std::shared_ptr<const Scene>& scene, const RadarSettings& s) {
  return frame_of(scene, s, {0, s.azimuth_bins});
}

/// Video over the mean of its bins, frames of several seeds.
using Planes = std::vector<std::vector<double>>;
Planes planes_of(const std::shared_ptr<const Scene>& scene, RadarSettings s) {
  Planes planes;
  const double noise_w = noise_power_w(s);
  for (int seed = 1; seed <= kSeeds; ++seed) {
    s.speckle_seed = s.receiver.noise_seed = seed;
    const BinBlock bins = frame_of(scene, s);
    std::vector<double>& plane = planes.emplace_back();
    for (std::size_t k = 0; k < bins.power_w.size(); ++k) {
      const double mean = bins.power_w[k] + noise_w;
      plane.push_back(mean > 0 ? video_power(bins.video16[k]) / mean : std::nan(""));
    }
  }
  return planes;
}

double correlation(const Planes& planes, const RadarSettings& s, int azimuths, int ranges) {
  double sum = 0, squares = 0;
  for (const auto& plane : planes)
    for (int a = 0; a + azimuths < s.azimuth_bins; ++a)
      for (int r = 0; r + ranges < s.range_bins; ++r) {
        const double x = plane[static_cast<std::size_t>(a * s.range_bins + r)] - 1;
        const double y = plane[static_cast<std::size_t>((a + azimuths) * s.range_bins + r + ranges)] - 1;
        if (std::isnan(x) || std::isnan(y)) continue;
        sum += x * y;
        squares += (x * x + y * y) / 2;
      }
  return sum / squares;
}

struct Statistics {
  double mean;
  double contrast;
};
Statistics statistics(const Planes& planes) {
  double n = 0, sum = 0, squares = 0;
  for (const auto& plane : planes)
    for (const double x : plane)
      if (!std::isnan(x)) n += 1, sum += x, squares += x * x;
  return {sum / n, std::sqrt(squares / n - sum * sum / (n * n)) / (sum / n)};
}

/// With which level ground is as loud as the noise.
double power_of_noise_w() {
  RadarSettings s = radar(1);
  const BinBlock bins = frame_of(test::level_ground(), s);
  double sum = 0;
  for (const double p : bins.power_w) sum += p;
  const double mean_w = sum / static_cast<double>(bins.power_w.size());
  s.receiver.noise = true;
  return s.power_w * noise_power_w(s) / mean_w;
}

struct Case {
  std::string name;
  std::function<std::shared_ptr<const Scene>()> scene;
  std::function<void(RadarSettings&)> change;
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

class VideoLooksOf : public testing::TestWithParam<Case> {};

// 20 beamwidths, 130 pulses and 8 seeds: a correlation scatters by 0.01 at most.
TEST_P(VideoLooksOf, HaveTheGrainOfOneLook) {
  RadarSettings s = radar(1);
  GetParam().change(s);
  const Planes one = planes_of(GetParam().scene(), s);
  for (const int looks : {2, 4, 16, 64}) {
    s.video.looks = looks;
    const Planes several = planes_of(GetParam().scene(), s);
    double worst = 0;
    for (const auto& [azimuths, ranges] :
         {std::pair{1, 0}, {2, 0}, {3, 0}, {4, 0}, {6, 0}, {0, 1}, {0, 2}, {0, 3}, {1, 1}, {3, 1}}) {
      const double expected = correlation(one, s, azimuths, ranges);
      const double found = correlation(several, s, azimuths, ranges);
      worst = std::max(worst, std::abs(found - expected));
      EXPECT_NEAR(found, expected, 0.05) << looks << " looks, lag " << azimuths << ", " << ranges;
    }
    RecordProperty("worst_" + std::to_string(looks), std::to_string(worst));
  }
}
INSTANTIATE_TEST_SUITE_P(Each, VideoLooksOf,
                         testing::Values(Case{"level_ground", test::level_ground, [](RadarSettings&) {}},
                                         Case{"hills_with_houses", hills_with_houses, [](RadarSettings&) {}},
                                         Case{"independent", test::level_ground,
                                              [](RadarSettings& s) { s.speckle = SpeckleKind::independent; }},
                                         Case{"sharp", test::level_ground,
                                              [](RadarSettings& s) {
                                                s.beam.pattern = BeamPattern::off;
                                                s.pulse.kind = PulseKind::off;
                                              }},
                                         Case{"noise_beside_echoes", test::level_ground,
                                              [](RadarSettings& s) {
                                                s.receiver.noise = true;
                                                s.power_w = power_of_noise_w();
                                              }},
                                         Case{"noise_alone", test::level_ground,
                                              [](RadarSettings& s) {
                                                s.receiver.noise = true;
                                                s.power_w = 0;
                                              }}),
                         [](const auto& test) { return test.param.name; });

TEST(VideoLooks, HaveTheirContrastAndTheMeanPower) {
  for (const auto& scene : {test::level_ground(), hills_with_houses()})
    for (const int looks : {2, 4, 16, 64}) {
      const Statistics found = statistics(planes_of(scene, radar(looks)));
      EXPECT_NEAR(found.contrast, 1 / std::sqrt(looks), 0.01) << looks;
      // Some 20,000 bins that are independent of each other.
      EXPECT_NEAR(found.mean, 1, 4 / std::sqrt(20000.0 * looks)) << looks;
    }
}

TEST(VideoLooks, AreGammaDistributedBehindABeam) {
  RadarSettings s = radar(4);
  std::vector<double> x;
  for (s.speckle_seed = 1; s.speckle_seed <= 40; ++s.speckle_seed) {
    const BinBlock bins = frame_of(test::level_ground(), s);
    for (int a = 0; a < s.azimuth_bins; a += 24)  // four beamwidths apart
      for (int r = 0; r < s.range_bins; r += 6) {
        const auto k = static_cast<std::size_t>(a * s.range_bins + r);
        x.push_back(video_power(bins.video16[k]) / bins.power_w[k]);
      }
  }
  std::ranges::sort(x);
  const auto n = static_cast<double>(x.size());
  double greatest = 0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    const double t = 4 * x[k];
    const double law = 1 - std::exp(-t) * (1 + t + t * t / 2 + t * t * t / 6);
    greatest = std::max(greatest, std::abs(law - (static_cast<double>(k) + 0.5) / n));
  }
  EXPECT_LT(greatest, 1.95 / std::sqrt(n));
}

TEST(VideoLooks, AreTheSameFromDwellsAndThreadsAndWithoutIq) {
  for (const SpeckleKind speckle : {SpeckleKind::ground, SpeckleKind::independent, SpeckleKind::none}) {
    RadarSettings s = radar(8);
    s.speckle = speckle;
    s.receiver.noise = true;
    const BinBlock whole = frame_of(hills_with_houses(), s);
    EXPECT_EQ(frame_of(hills_with_houses(), s, {0, s.azimuth_bins}, 1, false).video16, whole.video16);
    BinBlock parts(0, s.azimuth_bins, s.range_bins);
    for (int first = 0; first < s.azimuth_bins; first += 40)
      copy_azimuths(frame_of(hills_with_houses(), s, {first, 40}, 2), parts);
    EXPECT_EQ(parts.video16, whole.video16);
  }
}

TEST(VideoLooks, StayWhileTheAntennaDoesAndAreNewElsewhere) {
  const RadarSettings s = radar(8);
  const auto video = [&](double bearing_deg, std::uint64_t draw) {
    RenderOptions options;
    options.video16 = true;
    options.draw = draw;
    const Pose pose = test::pose_over_origin(test::level_ground()->world(), 1000, bearing_deg);
    return render(test::level_ground(), test::snapshot(s), pose, {0, 40}, options).bins.video16;
  };
  EXPECT_EQ(video(0, 1), video(0, 2));
  const auto here = video(0, 1), there = video(0.1, 1);
  std::size_t same = 0;
  for (std::size_t k = 0; k < here.size(); ++k) same += here[k] == there[k];
  EXPECT_LT(same, here.size() / 100);
}

struct Shipped {
  std::string scene;
  double height_m;  ///< above the ground that the scene has under its antenna
};

class XBand : public testing::TestWithParam<Shipped> {};

TEST_P(XBand, ShowsLevelGroundAlikeNearAndFar) {
  const auto path =
      std::filesystem::path(OBLIQ_SOURCE_DIR) / "deploy" / "scenes" / (GetParam().scene + ".toml");
  const SceneConfig config = load_scene_file(path);
  RadarSettings s = config.radars.at(0).settings;
  s.sector_deg = s.sector_deg / s.azimuth_bins * 96;  // a part of it, of bins as wide
  s.pixel_columns = s.pixel_columns * 96 / s.azimuth_bins;
  s.azimuth_bins = 96;
  s.video.looks = 1024;
  const auto scene =
      test::make_scene(load_world(test::synthetic_spec(SyntheticKind::flat, 1.1 * s.r_max_m, 100)));
  Pose pose = test::pose_over_origin(scene->world(), GetParam().height_m);
  pose.settings.tilt_deg = config.radars.at(0).pose.tilt_deg;
  RenderOptions options;
  options.video16 = true;
  const BinBlock bins = render(scene, test::snapshot(s), pose, {0, s.azimuth_bins}, options).bins;
  const VideoScale scale = Receiver(s, "", 0).video_scale();
  const auto mean_db = [&](int third) {
    double sum = 0;
    int n = 0;
    for (int a = 0; a < bins.n_azimuth; ++a)
      for (int r = bins.n_range * third / 3; r < bins.n_range * (third + 1) / 3; ++r, ++n) {
        const int level = bins.video16[static_cast<std::size_t>(a * bins.n_range + r)];
        EXPECT_GT(level, 1) << "at or below the floor";
        sum += scale.floor_db + (level - 1) * scale.span_db / 65534;
      }
    return sum / n;
  };
  const double near = mean_db(0), middle = mean_db(1), far = mean_db(2);
  RecordProperty("near_middle_far_db",
                 std::to_string(near) + " " + std::to_string(middle) + " " + std::to_string(far));
  EXPECT_NEAR(near, middle, 1);
  EXPECT_NEAR(far, middle, 1);
  EXPECT_NEAR(far, near, 1);
}
INSTANTIATE_TEST_SUITE_P(Scenes, XBand,
                         testing::Values(Shipped{"x_band_sector", 2000}, Shipped{"x_band_circular", 2000}),
                         [](const auto& test) { return test.param.scene; });

}  // namespace
}  // namespace obliq::video_looks_test
