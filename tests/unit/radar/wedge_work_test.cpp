// A wedge of any size takes bounded memory, and ends in its middle when it is told to.
// What a frame asks while it is planned and rendered: never after more work than kMostWork, whatever its
// settings, and for all of its work. No clock: work is counted by what is asked for (in milliseconds:
// tests/bench/asks.cpp).
// A frame's time by stage: measuring it changes no bit, and what each source does has its stage.
#include <gtest/gtest.h>
#include <malloc.h>

#include <algorithm>
#include <cstdio>
#include <set>

#include "server/radar/beam/echo_plan.h"
#include "server/radar/frame_plan.h"
#include "server/radar/render.h"
#include "server/radar/wedge_memory.h"
#include "terrain/base/stage_clock.h"
#include "tests/support/hard_frames.h"
#include "tests/support/heard_work.h"
#include "tests/support/made_worlds.h"
#include "tests/support/process_memory.h"
#include "tests/support/same_bits.h"
#include "tests/support/scenes.h"
#include "tests/support/sources.h"

namespace obliq::test::wedge_work_test {
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
    malloc_trim(0);  // of the tests before
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
  for (const auto& [s, labels] :
       {std::pair{settings, false}, {behind_a_pulse, false}, {settings, true}, {behind_a_pulse, true}}) {
    const std::int64_t said = rendering_size(s, 64, labels ? 2 : 0).bytes;
    EXPECT_LT(said, 200'000'000);
    const auto plan = plan_of(s);
    RenderOptions options;
    options.threads = 64;
    options.labels = labels;
    malloc_trim(0);
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

constexpr int kFrames = 200;
/// A frame that is not done after so much is stopped: what it has shown counts.
constexpr std::int64_t kMostOfAFrame = 15'000'000;

TEST(AFrame, AsksAfterAMillionUnitsOfWorkAtMostWhateverItsSettings) {
  std::int64_t most = 0;
  int frames = 0, whole = 0, one_bin = 0, beams = 0, pulses = 0;
  for (std::uint64_t seed = 0; frames < kFrames && seed < 10 * kFrames; ++seed) {
    const auto frame = hard_frame(seed);
    if (!frame) continue;
    SCOPED_TRACE(frame->text);
    HeardWork heard;
    heard.most_total = kMostOfAFrame;
    const HardWork work = render_heard(*frame, heard);
    ++frames;
    EXPECT_LE(heard.most(), kMostWork);
    most = std::max(most, heard.most());
    one_bin += frame->settings.azimuth_bins == 1 ? 1 : 0;
    beams += frame->settings.beam.pattern != BeamPattern::off ? 1 : 0;
    pulses += frame->settings.pulse.kind != PulseKind::off ? 1 : 0;
    if (!work.whole) continue;
    ++whole;
    // What it says it has done, counted another way: a ray or a sample is a unit at least, and so are 32
    // products of a sum.
    EXPECT_GE(heard.total(), static_cast<std::int64_t>(work.stats.samples));
    EXPECT_GE(heard.total(), static_cast<std::int64_t>(work.stats.rays));
    EXPECT_GE(heard.total(), work.products / 32);
  }
  std::printf(
      "    %d of %d frames whole, %d of one azimuth bin, %d with a beam, %d with a pulse: at most %lld "
      "units\n",
      whole, frames, one_bin, beams, pulses, static_cast<long long>(most));
  EXPECT_EQ(frames, kFrames);
  EXPECT_GE(std::min({whole, one_bin, beams, pulses}), 20) << "or the test says nothing";
}

/// 16,384 columns of 8 degrees are 737,280 all the way round, and pixels have numbers of 32 bits.
TEST(AFrame, WhoseBeamWidensItToMorePixelsThanHaveNumbersIsRefused) {
  RadarSettings settings;
  settings.frustum = FrustumKind::oblique;
  settings.sector_deg = 8;
  settings.azimuth_bins = 1;
  settings.pixel_columns = 16384;
  settings.pixel_rows = 7438;
  settings.beam.pattern = BeamPattern::uniform;
  settings.beam.width_deg = 16;
  settings.beam.extent_deg = 180;
  std::vector<FieldError> errors;
  EXPECT_FALSE(plan_echo(settings, {1000, 0}, errors));
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_EQ(errors[0].field, "frustum.pixel_columns");
  settings.pixel_rows = 5000;
  EXPECT_TRUE(plan_echo(settings, {1000, 0}, errors));
}

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
}  // namespace obliq::test::wedge_work_test
