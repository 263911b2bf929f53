// Work that parks between its turns, wherever its threads are.
#include "server/rendering/parked_work.h"

#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <stdexcept>
#include <thread>
#include <vector>

namespace obliq::net {
namespace {

const ParkedWork::IsOver kAtOnce = [](std::int64_t) { return true; };
const ParkedWork::IsOver kNever = [](std::int64_t) { return false; };

/// A thread of the work beside the one that has it, as the rendering's are.
std::jthread thread_of(const std::function<void()>& work) {
  return std::jthread([work, gate = gate_of_this_thread()] {
    try {
      const BehindGate behind(gate);
      work();
    } catch (const Stopped&) {
    }
  });
}

TEST(ParkedWork, EndsInOneTurnWhereNobodyWantsAnother) {
  int done = 0;
  ParkedWork work(
      [&] {
        for (; done < 10; ++done) ask(WorkGate::kLook);
      },
      {});
  EXPECT_TRUE(work.turn(kNever));
  EXPECT_EQ(done, 10);
}

TEST(ParkedWork, GoesOnWhereItWas) {
  int done = 0;
  ParkedWork work(
      [&] {
        for (; done < 10; ++done) ask(1);
      },
      {}, 0);
  for (int turn = 0; turn < 10; ++turn) {
    EXPECT_FALSE(work.turn(kAtOnce));
    EXPECT_EQ(done, turn);
  }
  EXPECT_TRUE(work.turn(kAtOnce));
}

TEST(ParkedWork, LooksAfterSoMuchWorkAndSaysHowMuchThereWasInTheTurn) {
  std::vector<std::int64_t> said;
  ParkedWork work(
      [&] {
        for (int k = 0; k < 12; ++k) ask(10);
      },
      {}, 25);
  const auto note = [&](std::int64_t work_done) {
    said.push_back(work_done);
    return said.size() == 2;
  };
  EXPECT_FALSE(work.turn(note));
  EXPECT_TRUE(work.turn(note));
  EXPECT_EQ(said, (std::vector<std::int64_t>{30, 60, 30, 60}));
}

TEST(ParkedWork, ATurnIsOverWhenAllThreadsArePartOfItNoLonger) {
  std::atomic<int> working = 0;
  std::atomic<int> rounds = 0;
  const auto some_rounds = [&] {
    for (int k = 0; k < 20; ++k) {
      ++working;
      std::this_thread::yield();
      ++rounds;
      --working;
      ask(1);
    }
  };
  ParkedWork work(
      [&] {
        std::vector<std::jthread> threads;
        for (int k = 0; k < 3; ++k) threads.push_back(thread_of(some_rounds));
        some_rounds();
        const OutsideGate outside;
        threads.clear();
      },
      {}, 0);
  while (!work.turn(kAtOnce)) {
    EXPECT_EQ(working, 0);
    const int before = rounds;
    std::this_thread::yield();
    EXPECT_EQ(rounds, before);
  }
  EXPECT_EQ(rounds, 80);
}

TEST(ParkedWork, AThreadThatWaitsForOthersHoldsNoTurnUp) {
  int turns = 0;
  int done = 0;
  ParkedWork work(
      [&] {
        auto thread = thread_of([&] {
          for (; done < 5; ++done) ask(1);
        });
        const OutsideGate outside;
        thread.join();
      },
      {}, 0);
  while (!work.turn(kAtOnce)) ++turns;
  EXPECT_EQ(turns, 5);
  EXPECT_EQ(done, 5);
}

TEST(ParkedWork, ThrowsFromTheTurnInWhichItFails) {
  ParkedWork work(
      [] {
        ask(1);
        throw std::runtime_error("no memory");
      },
      {}, 0);
  EXPECT_FALSE(work.turn(kAtOnce));
  EXPECT_THROW(work.turn(kAtOnce), std::runtime_error);
}

/// What a thread that unwinds leaves behind.
struct Trace {
  std::atomic<int>& left;
  ~Trace() { ++left; }
};

std::function<void()> work_for_ever(std::atomic<int>& left) {
  return [&left] {
    const auto thread = thread_of([&left] {
      const Trace trace{left};
      for (;;) ask(1);
    });
    const Trace trace{left};
    for (;;) ask(1);
  };
}

TEST(ParkedWork, UnwindsInTheTurnAfterARequestToStop) {
  std::stop_source stop;
  std::atomic<int> left = 0;
  ParkedWork work(work_for_ever(left), stop.get_token(), 0);
  EXPECT_FALSE(work.turn(kAtOnce));
  stop.request_stop();
  while (!work.turn(kNever)) {
  }
  EXPECT_EQ(left, 2);
}

TEST(ParkedWork, UnwindsWhenItIsDestroyed) {
  std::atomic<int> left = 0;
  {
    ParkedWork work(work_for_ever(left), {}, 0);
    EXPECT_FALSE(work.turn(kAtOnce));
    EXPECT_EQ(left, 0);
  }
  EXPECT_EQ(left, 2);
}

TEST(ParkedWork, NeverBegunIsDestroyedWithoutAThread) {
  bool begun = false;
  {
    const ParkedWork work([&] { begun = true; }, {});
  }
  EXPECT_FALSE(begun);
}

TEST(Ask, IsHeardBehindAGateAlone) {
  for (int k = 0; k < 3; ++k) ask(std::numeric_limits<std::int64_t>::max() / 2 + 1);  // no gate: nothing
  int heard = 0;
  ParkedWork work(
      [&] {
        const BehindGate unheard(nullptr);
        for (int k = 0; k < 10; ++k) ask(1);
        ++heard;
      },
      {}, 0);
  EXPECT_TRUE(work.turn(kAtOnce));
  EXPECT_EQ(heard, 1);
}

}  // namespace
}  // namespace obliq::net
