// A wedge of any size takes bounded memory, and ends in its middle when it is told to.
#include <gtest/gtest.h>

#include <cstdio>

#include "server/radar/frame_plan.h"
#include "server/radar/render.h"
#include "server/radar/wedge_memory.h"
#include "tests/support/heard_work.h"
#include "tests/support/process_memory.h"
#include "tests/support/scenes.h"
#include "tests/support/small_frames.h"
#include "tests/support/sources.h"

namespace obliq::test {
namespace {

/// All pixels in one bin.
RadarSettings one_bin(FrustumKind kind, int pixels) {
  RadarSettings settings = small_frame(kind);
  settings.azimuth_bins = settings.range_bins = 1;
  settings.pixel_columns = settings.pixel_rows = pixels;
  return settings;
}

std::shared_ptr<const FramePlan> plan_of(const RadarSettings& settings) {
  static const auto scene = make_scene(load_world(synthetic_spec(SyntheticKind::hills, 7000, 100)));
  const PlanResult planned = plan_frame(scene, snapshot(settings), pose_over_origin(scene->world(), 1400));
  if (!planned.plan) throw std::runtime_error(planned.errors.front().text());
  return planned.plan;
}

class AWedge : public testing::TestWithParam<NamedSource> {};

TEST_P(AWedge, TakesNoMoreMemoryThanIsSaidWhateverItsPixels) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer keeps memory that was given back";
#endif
  for (const PlateKind plates : {PlateKind::nearest, PlateKind::spread}) {
    RadarSettings settings = one_bin(GetParam().kind, 2048);
    settings.plates = plates;
    const auto plan = plan_of(settings);
    RenderOptions options;
    options.threads = 1;
    const std::uint64_t before = memory_of(getpid()).resident_bytes;
    if (!restart_peak_memory()) GTEST_SKIP() << "/proc/self/clear_refs cannot be written";
    ASSERT_TRUE(render_wedges(*plan, {0, 1}, options));
    const std::uint64_t peak = peak_memory_bytes();
    const std::uint64_t taken = peak > before ? peak - before : 0;
    std::printf("    %.1f MB taken, %.1f MB said\n", static_cast<double>(taken) / 1e6,
                static_cast<double>(wedge_bytes(settings)) / 1e6);
    EXPECT_LE(taken, static_cast<std::uint64_t>(wedge_bytes(settings)) + 2'000'000);
    // Four million answers of 12 bytes and samples of 80 would be 50 and 330 MB.
    EXPECT_LE(taken, 30'000'000u);
  }
}

TEST_P(AWedge, EndsInItsMiddleWhenItIsToldToStop) {
  const auto plan = plan_of(one_bin(GetParam().kind, 512));
  HeardWork heard;
  heard.most_asks = 3;
  int wedges = 0;
  RenderOptions options;
  options.threads = 1;
  options.on_wedge = [&](Wedge&&) { ++wedges; };
  EXPECT_TRUE(hear(heard, [&] { EXPECT_FALSE(render_wedges(*plan, {0, 1}, options)); }));
  EXPECT_EQ(heard.asks(), 3);
  EXPECT_EQ(wedges, 0);
}

/// All azimuths and 8,192 ranges: 720 narrow bins, one wedge of them after the other.
TEST(WedgeMemory, OfABinOfAWholeCircleIsSmall) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer keeps memory that was given back";
#endif
  RadarSettings settings = one_bin(FrustumKind::sweep, 1);
  settings.sector_deg = 360;
  settings.range_bins = 8192;
  settings.r_min_m = 0;
  settings.r_max_m = 12000;
  RadarSettings behind_a_pulse = settings;
  behind_a_pulse.pulse.kind = PulseKind::rectangular;
  behind_a_pulse.pulse.length_us = 0.1;
  for (const RadarSettings& s : {settings, behind_a_pulse}) {
    const std::int64_t said = rendering_size(s, 64).bytes;
    EXPECT_LT(said, 200'000'000);
    const auto plan = plan_of(s);
    RenderOptions options;
    options.threads = 64;
    const std::uint64_t before = memory_of(getpid()).resident_bytes;
    if (!restart_peak_memory()) GTEST_SKIP() << "/proc/self/clear_refs cannot be written";
    ASSERT_TRUE(render_wedges(*plan, {0, 1}, options));
    const std::uint64_t peak = peak_memory_bytes();
    const auto taken = static_cast<std::int64_t>(peak > before ? peak - before : 0);
    std::printf("    %.1f MB taken, %.1f MB said\n", static_cast<double>(taken) / 1e6,
                static_cast<double>(said) / 1e6);
    EXPECT_LE(taken, said);
  }
}

INSTANTIATE_TEST_SUITE_P(EverySource, AWedge, testing::ValuesIn(kEverySource),
                         source_name<testing::TestParamInfo<NamedSource>>);

TEST(WedgeMemory, OfHostileFramesIsSmallAndGrowsWithWhatABinNeeds) {
  // 16384 x 16384 pixels in one bin took 7 GB.
  RadarSettings settings = one_bin(FrustumKind::oblique, 16384);
  EXPECT_LT(wedge_bytes(settings), 100'000'000);
  // Millions of scatterers in each of few azimuth bins cannot be had for less.
  settings.azimuth_bins = 8;
  settings.range_bins = 8192;
  EXPECT_GT(wedge_bytes(settings), 1'000'000'000);
  EXPECT_LT(wedge_bytes(RadarSettings{}), 50'000'000) << "the defaults";
}

}  // namespace
}  // namespace obliq::test
