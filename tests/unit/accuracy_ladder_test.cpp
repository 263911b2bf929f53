#include <gtest/gtest.h>

#include "server/accuracy/sampling_case.h"
#include "terrain/base/errors.h"

namespace obliq {
namespace {

RadarSettings settings(FrustumKind kind) {
  RadarSettings s;
  s.frustum = kind;
  s.azimuth_bins = 1000;
  s.range_bins = 500;
  return s;
}

BinErrors errors(double median_db, std::uint64_t gaps) {
  BinErrors e;
  e.lit = 100;
  e.gaps = gaps;
  e.median_db = median_db;
  return e;
}

TEST(SamplingLadder, RisesToTheLimitOfPixelsAndKeepsTheUsersKind) {
  for (const FrustumKind kind : {FrustumKind::symmetric, FrustumKind::oblique, FrustumKind::sweep}) {
    const auto ladder = sampling_ladder(settings(kind), 30);
    ASSERT_GT(ladder.size(), 3u);
    for (std::size_t k = 0; k < ladder.size(); ++k) {
      EXPECT_EQ(ladder[k].kind, kind);
      EXPECT_EQ(ladder[k].cell_m, 30);
      EXPECT_LE(ladder[k].columns, 16384);
      if (k > 0) {
        EXPECT_EQ(ladder[k].columns, 2 * ladder[k - 1].columns);
      }
    }
  }
  EXPECT_EQ(sampling_ladder(settings(FrustumKind::oblique), 30).back().columns, 16384);
  EXPECT_EQ(sampling_ladder(settings(FrustumKind::sweep), 30).back().columns, 16000);
}

TEST(SamplingLadder, ClimbsToTheFirstThatIsGoodEnoughInBothMeasures) {
  const auto ladder = sampling_ladder(settings(FrustumKind::sweep), 30);
  const AccuracyLimit limit{0.1, 0.02};
  // dB is good from the second on, gaps from the third.
  const auto tried = climb(ladder, limit, [&](const SamplingCase& s) {
    return errors(s.columns > 1000 ? 0.05 : 0.5, s.columns > 2000 ? 2 : 3);
  });
  ASSERT_EQ(tried.size(), 3u);
  EXPECT_EQ(tried.back().sampling.columns, 4000);
}

TEST(SamplingLadder, EndsWithoutOneThatIsGoodEnough) {
  const auto ladder = sampling_ladder(settings(FrustumKind::symmetric), 30);
  const AccuracyLimit limit{0.1, 1};
  const auto tried = climb(ladder, limit, [](const SamplingCase&) { return errors(0.2, 0); });
  EXPECT_EQ(tried.size(), ladder.size());
  EXPECT_FALSE(limit.met_by(tried.back().errors));
  EXPECT_THROW(climb(ladder, limit, [](const SamplingCase&) -> BinErrors { throw InputError("no"); }),
               InputError);
}

// An empty frame has no decibels, and 0 of them would be within any limit.
TEST(SamplingLadder, NothingComparedMeetsNoLimit) {
  const AccuracyLimit any{100, 1};
  EXPECT_FALSE(any.met_by(errors(0, 100)));
  EXPECT_TRUE(any.met_by(errors(0, 99)));
  EXPECT_FALSE(any.met_by(BinErrors{}));
}

}  // namespace
}  // namespace obliq
