// A rendering that pauses: the same bits, and no more at a time than it was allowed.
#include <gtest/gtest.h>

#include <atomic>

#include "server/radar/frame_plan.h"
#include "server/radar/rays/ray_batch.h"
#include "server/radar/rays/ray_samples.h"
#include "server/radar/render.h"
#include "server/radar/samples.h"
#include "server/radar/sweep/sweep_samples.h"
#include "tests/support/scenes.h"
#include "tests/support/small_frames.h"
#include "tests/support/sources.h"

namespace obliq::test {
namespace {

std::shared_ptr<const FramePlan> plan_of(const RadarSettings& settings, double height_m = 1400) {
  const auto scene = make_scene(load_world(synthetic_spec(SyntheticKind::hills, 7000, 100)));
  const PlanResult planned =
      plan_frame(scene, snapshot(settings), pose_over_origin(scene->world(), height_m));
  if (!planned.plan) throw std::runtime_error(planned.errors.front().text());
  return planned.plan;
}

class PausesOf : public testing::TestWithParam<NamedSource> {};

TEST_P(PausesOf, AFrameInPartsHasTheBitsOfOneInOnePiece) {
  for (const int azimuth_bins : {1, 20}) {
    RadarSettings settings = small_frame(GetParam().kind);
    settings.azimuth_bins = azimuth_bins;
    const auto plan = plan_of(settings);
    for (const int threads : {1, 3}) {
      BinBlock whole(0, azimuth_bins, settings.range_bins), parts = whole;
      FrameSum sum_of_whole(settings), sum_of_parts(settings);
      RenderOptions options;
      options.threads = threads;
      options.on_wedge = [&](Wedge&& wedge) {
        sum_of_whole.add(wedge);
        copy_azimuths(wedge.bins, whole);
      };
      ASSERT_TRUE(render_wedges(*plan, {0, azimuth_bins}, options));
      options.on_wedge = [&](Wedge&& wedge) {
        sum_of_parts.add(wedge);
        copy_azimuths(wedge.bins, parts);
      };
      RenderPause pause;
      pause.batches = 2 * threads;
      options.pause = &pause;
      int calls = 0;
      do {
        ASSERT_TRUE(render_wedges(*plan, {0, azimuth_bins}, options));
        ++calls;
      } while (pause.begun);
      const FrameStats stats = sum_of_parts.total();
      EXPECT_EQ(stats.rays, sum_of_whole.total().rays);
      EXPECT_EQ(stats.samples, sum_of_whole.total().samples);
      const int most_a_call =
          pause.batches * (settings.frustum == FrustumKind::sweep ? 1 : kBatch);  // rays or columns
      EXPECT_GE(calls, static_cast<int>(stats.rays) / most_a_call);
      EXPECT_TRUE(same_bits(whole.iq, parts.iq));
      EXPECT_TRUE(same_bits(whole.power_w, parts.power_w));
      EXPECT_TRUE(same_bits(whole.count, parts.count));
      EXPECT_TRUE(same_bits(whole.state, parts.state));
    }
  }
}

TEST_P(PausesOf, AFrameThatGivesWayWhenItIsToldHasTheSameBits) {
  RadarSettings settings = small_frame(GetParam().kind);
  settings.azimuth_bins = 20;
  const auto plan = plan_of(settings);
  for (const int threads : {1, 3}) {
    BinBlock whole(0, settings.azimuth_bins, settings.range_bins), parts = whole;
    RenderOptions options;
    options.threads = threads;
    options.on_wedge = [&](Wedge&& wedge) { copy_azimuths(wedge.bins, whole); };
    ASSERT_TRUE(render_wedges(*plan, {0, settings.azimuth_bins}, options));
    options.on_wedge = [&](Wedge&& wedge) { copy_azimuths(wedge.bins, parts); };
    std::atomic<int> asked = 0;
    RenderPause pause;
    pause.is_due = [&] { return ++asked % 3 == 0; };
    options.pause = &pause;
    int calls = 0;
    do {
      ASSERT_TRUE(render_wedges(*plan, {0, settings.azimuth_bins}, options));
      ++calls;
    } while (pause.begun);
    EXPECT_GT(calls, 3);
    EXPECT_TRUE(same_bits(whole.iq, parts.iq));
    EXPECT_TRUE(same_bits(whole.power_w, parts.power_w));
    EXPECT_TRUE(same_bits(whole.count, parts.count));
    EXPECT_TRUE(same_bits(whole.state, parts.state));
  }
}

INSTANTIATE_TEST_SUITE_P(EverySource, PausesOf, testing::ValuesIn(kEverySource),
                         source_name<testing::TestParamInfo<NamedSource>>);

/// Batches until nothing is left to look at.
int batches_of(const FramePlan& plan) {
  const auto source = make_sample_source(plan, {0, 1}, nullptr);
  const auto samples = std::make_unique<SampleBatch>();
  FrameStats stats;
  int batches = 0;
  while (source->fill(*samples, stats)) ++batches;
  return batches;
}

TEST(ABatch, LooksAtABoundedNumberOfPixelsThatNeedNoRay) {
  RadarSettings settings = small_frame(FrustumKind::oblique);
  settings.sector_deg = 360;
  settings.azimuth_bins = 1;
  settings.r_min_m = 5990;  // a thin ring: hardly any pixel lies in it
  settings.pixel_columns = settings.pixel_rows = 512;
  EXPECT_GE(batches_of(*plan_of(settings)), 512 * 512 / RaySource::kMostPixels);
}

TEST(ABatch, EndsThoughItsRaysMeetNothing) {
  RadarSettings settings = small_frame(FrustumKind::polar);
  settings.azimuth_bins = 1;
  settings.r_min_m = 2300;  // and the ground that is known ends soon after
  const auto scene = make_scene(load_world(synthetic_spec(SyntheticKind::hills, 2000, 100)));
  PlanResult planned = plan_frame(scene, snapshot(settings), pose_over_origin(scene->world(), 1400));
  ASSERT_TRUE(planned.plan) << planned.errors.front().text();
  RayBatch rays;
  int ray_batches = 0;
  for (const auto source = make_ray_source(*planned.plan, {0, 1}); source->generate(rays);) ++ray_batches;
  ASSERT_GE(ray_batches, 3) << "or the case is none";
  EXPECT_GE(batches_of(*planned.plan), ray_batches);
}

TEST(ABatch, IsAtMostAColumnOfTheSweep) {
  RadarSettings settings = small_frame(FrustumKind::sweep);
  settings.azimuth_bins = 1;
  settings.range_bins = 2;  // few samples a column
  EXPECT_GE(batches_of(*plan_of(settings)), sweep_columns_per_bin(settings));
}

}  // namespace
}  // namespace obliq::test
