// What a frame asks while it is planned and rendered: never after more work than kMostWork, whatever its
// settings, and for all of its work. No clock: work is counted by what is asked for (in milliseconds:
// tests/bench/asks.cpp).
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "server/radar/beam/echo_plan.h"
#include "tests/support/hard_frames.h"

namespace obliq::test {
namespace {

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

}  // namespace
}  // namespace obliq::test
