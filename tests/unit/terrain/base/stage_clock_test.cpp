// Where time goes: by construction nothing is counted twice and nothing is left out.
#include "terrain/base/stage_clock.h"

#include <gtest/gtest.h>

#include <cmath>
#include <thread>

namespace obliq::test::stage_clock_test {
namespace {

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

/// Until the clock has moved by so much, at least.
void pass(double seconds) {
  for (const auto start = Clock::now(); Seconds(Clock::now() - start).count() < seconds;) {
  }
}

double sum_of_stages_s(const StageTimes& times) {
  double sum = 0;
  for (int k = 0; k < kStages; ++k) sum += times.seconds(static_cast<Stage>(k));
  return sum;
}

TEST(StageClock, StagesAddUpToTheTimeOfTheirThread) {
  StageTimes times;
  const auto start = Clock::now();
  {
    const StageClock clock(&times);
    pass(0.001);
    const StageProbe outer(Stage::scatter);
    pass(0.001);
    const StageProbe inner(Stage::bin);
    pass(0.001);
  }
  const double around_s = Seconds(Clock::now() - start).count();
  EXPECT_NEAR(sum_of_stages_s(times), times.total_s(), 1e-12);
  EXPECT_LE(times.total_s(), around_s);
  EXPECT_GE(times.total_s(), 0.003);
  EXPECT_EQ(times.threads(), 1);
}

TEST(StageClock, TimeWithinAProbeWithinAProbeIsTheInnerOnesAlone) {
  StageTimes times;
  {
    const StageClock clock(&times);
    const StageProbe outer(Stage::trace);
    {
      const StageProbe inner(Stage::refine);
      pass(0.003);
    }
    pass(0.001);
  }
  EXPECT_GE(times.seconds(Stage::refine), 0.003);
  EXPECT_GE(times.seconds(Stage::trace), 0.001) << "the outer stage goes on after the inner one";
  EXPECT_NEAR(times.total_s() - times.seconds(Stage::other),
              times.seconds(Stage::trace) + times.seconds(Stage::refine), 1e-12);
}

TEST(StageClock, EachThreadHasItsOwnAndAllAreAddedUp) {
  StageTimes times;
  const auto work = [&] {
    const StageClock clock(&times);
    const StageProbe probe(Stage::ground);
    pass(0.002);
  };
  { std::jthread one(work), two(work); }
  EXPECT_EQ(times.threads(), 2);
  EXPECT_GE(times.seconds(Stage::ground), 0.004);
}

TEST(StageClock, WithoutATableNothingIsMeasured) {
  StageTimes times;
  {
    const StageClock none(nullptr);
    const StageProbe probe(Stage::trace);
  }
  { const StageProbe of_no_clock(Stage::trace); }
  EXPECT_EQ(times.total_s(), 0);
  EXPECT_EQ(times.threads(), 0);
}

}  // namespace
}  // namespace obliq::test::stage_clock_test
