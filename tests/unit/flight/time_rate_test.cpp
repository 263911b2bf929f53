// How late a radar is shown when the clock of the exercise pauses, is reset, runs faster or slower.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/flight/pose_time_line.h"

namespace obliq::test::time_rate_test {
namespace {

constexpr std::int64_t kMs = 1'000'000;

PoseSettings timed_pose(std::int64_t sim_time_ns, double rate) {
  PoseSettings pose;
  pose.sim_time_ns = sim_time_ns;
  pose.time_rate = rate;
  return pose;
}

/// The server's clock, which has nothing to do with the controller's.
std::int64_t server(double ms) { return 7'000'000'000'000 + static_cast<std::int64_t>(ms * 1e6); }

/// A controller at 60 Hz whose clock runs `rate` times as fast.
class Exercise {
 public:
  explicit Exercise(bool says_rate) : says_rate_(says_rate) {}
  /// Sends poses for so long; the greatest lag of what is shown behind the sent clock, in seconds of real
  /// time, from `settled_s` on, looked at between the poses.
  double run(double rate, double for_s, double settled_s = 0) {
    double lag_s = 0;
    for (double t = 0; t < for_s; t += 1 / 60.0) {
      sim_s_ += rate / 60;
      real_s_ += 1 / 60.0;
      // Arrivals are up to 8 ms late, in a fixed disorder.
      const double late_s = 0.002 * static_cast<double>(count_++ * 7 % 5);
      const PoseSettings p = timed_pose(std::llround(sim_s_ * 1e9), says_rate_ ? rate : 1);
      if (std::exchange(reset_, false)) line_.restart();
      line_.add(p, server(1000 * (real_s_ + late_s)));
      if (t < settled_s) continue;
      const double shown_s =
          static_cast<double>(line_.at(server(1000 * (real_s_ + 0.0165))).pose.sim_time_ns) * 1e-9;
      lag_s = std::max(lag_s, std::abs(sim_s_ - shown_s) / rate);
    }
    return lag_s;
  }
  void wait(double for_s) { real_s_ += for_s; }
  void set_clock(double sim_s, bool says_so) {
    sim_s_ = sim_s;
    reset_ = says_so;
  }
  std::uint64_t late() const { return line_.late(); }

 private:
  const bool says_rate_;
  PoseTimeLine line_{PoseSettings{}};
  double sim_s_ = 1000;
  double real_s_ = 0;
  int count_ = 0;
  bool reset_ = false;
};

// Allowed is 0.2 s of real time in each row; 60 Hz and delays of 8 ms need 0.03 s.
TEST(PoseTimeLine, LagsLittleThroughPauseResetTenTimesAndSlowMotionOfAnExerciseThatSaysSo) {
  constexpr double kMost_s = 0.05;
  Exercise exercise(true);
  EXPECT_LT(exercise.run(1, 4), kMost_s);
  exercise.wait(2);
  EXPECT_LT(exercise.run(1, 4), kMost_s) << "after a pause";
  exercise.set_clock(0, true);
  EXPECT_LT(exercise.run(1, 4), kMost_s) << "after a reset";
  EXPECT_EQ(exercise.late(), 0u);
  EXPECT_LT(exercise.run(10, 4), kMost_s) << "ten times";
  EXPECT_LT(exercise.run(1, 4), kMost_s) << "and back";
  EXPECT_LT(exercise.run(0.25, 4), kMost_s) << "slow motion";
  EXPECT_LT(exercise.run(100, 4), kMost_s) << "a hundred times";
  exercise.set_clock(1e6, true);
  EXPECT_LT(exercise.run(1, 4), kMost_s);
}

TEST(PoseTimeLine, AnExerciseThatSaysNothingIsFollowedAsBefore) {
  Exercise exercise(false);
  EXPECT_LT(exercise.run(1, 4), 0.05);
  exercise.set_clock(0, false);
  exercise.run(1, 3);
  EXPECT_EQ(exercise.late(), static_cast<std::uint64_t>(PoseTimeLine::kMostLate));
  EXPECT_GT(exercise.run(10, 4), 0.2) << "the same clock without its rate";
}

TEST(PoseTimeLine, WhatIsShownNeverRunsBackwardsWhenTheRateChanges) {
  PoseTimeLine line(PoseSettings{});
  double sim_ms = 0;
  std::int64_t shown_ns = -1;
  for (int i = 0; i < 600; ++i) {
    const double rate = i / 100 % 2 == 0 ? 1 : 20;
    sim_ms += 20 * rate;
    line.add(timed_pose(static_cast<std::int64_t>(sim_ms) * kMs, rate), server(20 * i));
    for (const double after_ms : {0.0, 7.0, 19.0}) {
      const std::int64_t now_ns = line.at(server(20 * i + after_ms)).pose.sim_time_ns;
      ASSERT_GE(now_ns, shown_ns) << i << " " << after_ms;
      shown_ns = now_ns;
    }
  }
}

}  // namespace
}  // namespace obliq::test::time_rate_test
