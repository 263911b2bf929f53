// A frame's time by stage: measuring it changes no bit, and what each source does has its stage.
#include <gtest/gtest.h>

#include <set>

#include "server/radar/frame_plan.h"
#include "server/radar/render.h"
#include "terrain/base/stage_clock.h"
#include "tests/support/made_worlds.h"
#include "tests/support/scenes.h"
#include "tests/support/small_frames.h"
#include "tests/support/sources.h"

namespace obliq::test {
namespace {

Frame frame_of(const RadarSettings& settings, StageTimes* times) {
  World world = load_world(synthetic_spec(SyntheticKind::hills, 7000, 100));
  for (const double x_m : {-900.0, 0.0, 900.0}) add_prism(world, rectangle(x_m, 3000, 60, 40), 30);
  const auto scene = make_scene(std::move(world));
  RenderOptions options;
  options.threads = 2;
  options.times = times;
  return render(scene, snapshot(settings), pose_over_origin(scene->world(), 1400), {0, settings.azimuth_bins},
                options);
}

std::set<std::string> stages_of(const StageTimes& times) {
  std::set<std::string> names;
  for (int k = 0; k < kStages; ++k)
    if (times.seconds(static_cast<Stage>(k)) > 0) names.insert(stage_name(static_cast<Stage>(k)));
  return names;
}

class StagesOf : public testing::TestWithParam<NamedSource> {};

TEST_P(StagesOf, MeasuringThemChangesNoBit) {
  for (const PlateKind plates : {PlateKind::spread, PlateKind::nearest}) {
    RadarSettings settings = small_frame(GetParam().kind);
    settings.sub_columns = 0;  // samples too
    settings.plates = plates;
    StageTimes times;
    const Frame with = frame_of(settings, &times);
    const Frame without = frame_of(settings, nullptr);
    EXPECT_TRUE(same_bits(with.bins.iq, without.bins.iq));
    EXPECT_TRUE(same_bits(with.bins.power_w, without.bins.power_w));
    EXPECT_TRUE(same_bits(with.bins.count, without.bins.count));
    EXPECT_TRUE(same_bits(with.bins.state, without.bins.state));
    EXPECT_EQ(with.stats.hits, without.stats.hits);

    EXPECT_EQ(times.threads(), 2);
    std::set<std::string> expected{"scatter", "bin", "states", "wait", "other"};
    if (settings.frustum == FrustumKind::sweep) {
      expected.insert({"ground", "buildings"});
    } else {
      expected.insert({"rays", "trace", "refine"});
      if (plates == PlateKind::spread) expected.insert("plates");
    }
    EXPECT_EQ(stages_of(times), expected);
  }
}

INSTANTIATE_TEST_SUITE_P(Sources, StagesOf, testing::ValuesIn(kEverySource),
                         source_name<testing::TestParamInfo<NamedSource>>);

}  // namespace
}  // namespace obliq::test
