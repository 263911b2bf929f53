// The same bits from 1, 2 and 5 threads and from any part of the azimuths. Over random scenes, for every
// source.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstring>

#include "tests/property/trial.h"
#include "tests/support/same_bits.h"

namespace obliq {
namespace {

class BitsOfEverySource : public testing::TestWithParam<test::NamedSource> {};

TEST_P(BitsOfEverySource, ComeFromAnyThreadsAndAnyAzimuths) {
  int frames = 0, several_wedges = 0;
  for (std::uint64_t seed = 10000; seed < 11000; ++seed) {
    const test::Trial trial(seed);
    SCOPED_TRACE(trial.text);
    RadarSettings s = trial.settings_of(GetParam().kind);
    const bool rays = GetParam().kind != FrustumKind::sweep;
    s.speckle = rays && seed % 3 == 0 ? SpeckleKind::geometric : SpeckleKind::ground;
    if (!trial.plan(s)) continue;
    ++frames;
    several_wedges += wedge_count(s.azimuth_bins) > 1 ? 1 : 0;
    const Frame one = trial.frame(s, 1);
    for (const int threads : {2, 5}) {
      const Frame many = trial.frame(s, threads);
      test::expect_same_bits(one.bins, many.bins);
      EXPECT_EQ(one.stats.samples, many.stats.samples);
      EXPECT_EQ(std::memcmp(&one.stats.covered_area_m2, &many.stats.covered_area_m2, sizeof(double)), 0);
    }
    test::Dice dice(seed);
    const int first = dice.integer(0, s.azimuth_bins - 1);
    const int count = dice.integer(1, s.azimuth_bins - first);
    BinBlock expected(first, count, s.range_bins);
    copy_azimuths(one.bins, expected);
    test::expect_same_bits(expected, trial.frame(s, 2, {first, count}).bins);
    if (HasFailure()) break;
  }
  std::printf("    %d frames, %d of them of several wedges\n", frames, several_wedges);
  EXPECT_GE(frames, 150);
  EXPECT_GE(several_wedges, 50);
}

INSTANTIATE_TEST_SUITE_P(Sources, BitsOfEverySource, testing::ValuesIn(test::kEverySource),
                         test::source_name<testing::TestParamInfo<test::NamedSource>>);

}  // namespace
}  // namespace obliq
