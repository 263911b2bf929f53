// The times of a recording, and how they flow while clients pause, seek and change the speed.
#include "server/apps/replay/playback_clock.h"

#include <gtest/gtest.h>

#include <atomic>
#include <limits>
#include <thread>

#include "server/apps/replay/recorded_time.h"

namespace obliq::playback_clock_test {
namespace {

using namespace std::chrono_literals;
using Outcome = PlaybackClock::Outcome;

constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr auto kLong = 60s;  // reached only when something is broken
constexpr double kNoWait = std::numeric_limits<double>::infinity();

TEST(RecordedTime, CountsFromTheFirstTime) {
  RecordedTime time;
  EXPECT_EQ(time.at(1'000 * kSecond_ns), 0);
  EXPECT_EQ(time.at(1'001 * kSecond_ns), kSecond_ns);
  EXPECT_EQ(time.at(1'001 * kSecond_ns), kSecond_ns);
}

TEST(RecordedTime, AStepBackCountsAsNoneAndALongPauseAsFiveMinutes) {
  RecordedTime time;
  (void)time.at(1'000 * kSecond_ns);
  EXPECT_EQ(time.at(900 * kSecond_ns), 0) << "the clock was set";
  EXPECT_EQ(time.at(901 * kSecond_ns), kSecond_ns);
  EXPECT_EQ(time.at(5'000 * kSecond_ns), 301 * kSecond_ns);
  EXPECT_EQ(time.at(5'000 * kSecond_ns - 1'000'000), 301 * kSecond_ns)
      << "another thread's, a millisecond earlier";
  EXPECT_EQ(time.at(5'001 * kSecond_ns), 302 * kSecond_ns);
  EXPECT_EQ(time.at(std::numeric_limits<std::int64_t>::max()), 602 * kSecond_ns);
  EXPECT_EQ(time.at(std::numeric_limits<std::int64_t>::min()), 602 * kSecond_ns);
}

TEST(RecordedTime, ALoopGoesOnAfterTheGapBeforeItsLastTime) {
  RecordedTime time;
  (void)time.at(0);
  (void)time.at(2 * kSecond_ns);
  time.begin_again();
  EXPECT_EQ(time.at(0), 4 * kSecond_ns);
  time.restart(100 * kSecond_ns);
  EXPECT_EQ(time.at(7), 100 * kSecond_ns);
}

TEST(PlaybackClock, StandsUntilSomebodyWatchesAndWhileItIsPaused) {
  PlaybackClock clock(1e6);
  EXPECT_EQ(clock.now_ns(), 0);
  clock.set_paused(true);
  clock.set_watched(true);
  EXPECT_FALSE(clock.runs());
  const std::int64_t paused_ns = clock.now_ns();
  EXPECT_EQ(clock.wait_until(paused_ns + 1, 0, {}, 1ms), Outcome::not_yet);
  EXPECT_EQ(clock.now_ns(), paused_ns);
  clock.set_paused(false);
  EXPECT_EQ(clock.wait_until(paused_ns + kSecond_ns, 0, {}, kLong), Outcome::reached);
  EXPECT_GE(clock.now_ns(), paused_ns + kSecond_ns);
}

TEST(PlaybackClock, AChangeOfSpeedLosesNoTimeAndNeverGoesBack) {
  PlaybackClock clock(1000);
  clock.set_watched(true);
  std::int64_t last_ns = 0;
  for (int turn = 0; turn < 200; ++turn) {
    clock.set_speed(turn % 2 == 0 ? 0.01 : 1000);
    const std::int64_t now_ns = clock.now_ns();
    EXPECT_GE(now_ns, last_ns);
    last_ns = now_ns;
  }
}

TEST(PlaybackClock, AtInfiniteSpeedEverythingIsDueAndItIsWhereItWasWaitedFor) {
  PlaybackClock clock(kNoWait);
  clock.set_watched(true);
  EXPECT_EQ(clock.wait_until(5 * kSecond_ns, 0, {}, kLong), Outcome::reached);
  EXPECT_EQ(clock.now_ns(), 5 * kSecond_ns);
  clock.set_paused(true);
  EXPECT_EQ(clock.now_ns(), 5 * kSecond_ns);
  EXPECT_EQ(clock.wait_until(6 * kSecond_ns, 0, {}, 1ms), Outcome::not_yet);
}

TEST(PlaybackClock, AJumpEndsTheWaitsOfBefore) {
  PlaybackClock clock(1);
  clock.set_watched(true);
  std::atomic<bool> waits = false;
  Outcome outcome{};
  std::jthread waiter([&] {
    waits = true;
    outcome = clock.wait_until(3600 * kSecond_ns, 0, {}, kLong);
  });
  while (!waits) std::this_thread::yield();
  clock.jump(1800 * kSecond_ns);
  waiter.join();
  EXPECT_EQ(outcome, Outcome::jumped);
  EXPECT_EQ(clock.jumps(), 1u);
  EXPECT_GE(clock.now_ns(), 1800 * kSecond_ns);
  EXPECT_EQ(clock.wait_until(0, 0, {}, kLong), Outcome::jumped) << "also of a time that has passed";
  EXPECT_EQ(clock.wait_until(1800 * kSecond_ns, 1, {}, kLong), Outcome::reached);
}

TEST(PlaybackClock, AStopEndsAWait) {
  PlaybackClock clock(1);
  std::stop_source stop;
  Outcome outcome{};
  std::jthread waiter([&] { outcome = clock.wait_until(1, 0, stop.get_token(), kLong); });
  stop.request_stop();
  waiter.join();
  EXPECT_EQ(outcome, Outcome::stopped);
}

TEST(PlaybackClock, ClientsAndTheRenderThreadMayUseItAtOnce) {
  PlaybackClock clock(1e5);
  clock.set_watched(true);
  std::jthread client([&] {
    for (int turn = 0; turn < 300; ++turn) {
      clock.set_paused(turn % 3 == 0);
      clock.set_speed(1e5 + turn);
      if (turn % 10 == 0) clock.jump(turn * kSecond_ns);
    }
    clock.set_paused(false);
  });
  for (int turn = 0; turn < 300; ++turn) {
    const std::uint64_t jumps = clock.jumps();
    const std::int64_t to_ns = clock.now_ns() + kSecond_ns;
    const Outcome outcome = clock.wait_until(to_ns, jumps, {}, kLong);
    EXPECT_TRUE(outcome == Outcome::reached || outcome == Outcome::jumped);
  }
}

}  // namespace
}  // namespace obliq::playback_clock_test
