// The shipped X-band radars over level ground: a cosecant squared shows near, middle and far alike.
#include <gtest/gtest.h>

#include <cmath>

#include "server/control/scene_file.h"
#include "server/radar/receiver/receiver.h"
#include "tests/support/scenes.h"

namespace obliq {
namespace {

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
}  // namespace obliq
