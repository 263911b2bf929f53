// Work that parks between its turns, wherever its threads are.
// A rendering that pauses: the same bits.
#include "server/rendering/parked_work.h"

#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <stdexcept>
#include <thread>
#include <vector>

#include "server/radar/frame_plan.h"
#include "server/radar/rays/ray_batch.h"
#include "server/radar/rays/ray_samples.h"
#include "server/radar/render.h"
#include "server/radar/samples.h"
#include "server/radar/sweep/sweep_samples.h"
#include "tests/support/same_bits.h"
#include "tests/support/scenes.h"
#include "tests/support/sources.h"

namespace obliq::test::parked_work_test {
namespace {

using namespace rendering;

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

std::shared_ptr<const FramePlan> plan_of(const RadarSettings& settings, double height_m = 1400) {
  const auto scene = make_scene(load_world(synthetic_spec(SyntheticKind::hills, 7000, 100)));
  const PlanResult planned =
      plan_frame(scene, snapshot(settings), pose_over_origin(scene->world(), height_m));
  if (!planned.plan) throw std::runtime_error(planned.errors.front().text());
  return planned.plan;
}

/// Bits and counts of a frame, plan included.
struct Rendered {
  BinBlock bins;
  FrameStats stats;
};

Rendered render_with(const RadarSettings& settings, int threads) {
  Rendered frame{BinBlock(0, settings.azimuth_bins, settings.range_bins), {}};
  FrameSum sum(settings);
  RenderOptions options;
  options.threads = threads;
  options.on_wedge = [&](Wedge&& wedge) {
    sum.add(wedge);
    copy_azimuths(wedge.bins, frame.bins);
  };
  EXPECT_TRUE(render_wedges(*plan_of(settings), {0, settings.azimuth_bins}, options));
  frame.stats = sum.total();
  return frame;
}

void expect_the_same(const Rendered& a, const Rendered& b) {
  EXPECT_EQ(a.stats.rays, b.stats.rays);
  EXPECT_EQ(a.stats.samples, b.stats.samples);
  expect_same_bits(a.bins, b.bins);
}

/// The turns that a frame takes whose threads park after so much work; 0: whenever they ask.
int turns_of(const RadarSettings& settings, int threads, std::int64_t look, Rendered& frame) {
  rendering::ParkedWork work([&] { frame = render_with(settings, threads); }, {}, look);
  int turns = 1;
  while (!work.turn([](std::int64_t) { return true; })) ++turns;
  return turns;
}

class PausesOf : public testing::TestWithParam<NamedSource> {};

TEST_P(PausesOf, AFrameThatGivesWayAllTheTimeHasTheBitsOfOneInOnePiece) {
  for (const int azimuth_bins : {1, 20}) {
    RadarSettings settings = small_frame(GetParam().kind);
    settings.azimuth_bins = azimuth_bins;
    const Rendered whole = render_with(settings, 1);
    for (const int threads : {1, 3}) {
      Rendered parts;
      // Columns of the sweep go eight by eight; of rays there is at least a batch between two turns.
      const int turns = turns_of(settings, threads, 2000, parts);
      const int at_once = settings.frustum == FrustumKind::sweep ? 8 : kBatch;
      EXPECT_GE(turns, static_cast<int>(whole.stats.rays) / at_once / threads);
      expect_the_same(parts, whole);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(EverySource, PausesOf, testing::ValuesIn(kEverySource),
                         source_name<testing::TestParamInfo<NamedSource>>);

TEST(PausesOfABeam, LeaveItsBitsAsTheyAre) {
  RadarSettings settings = small_frame(FrustumKind::sweep);
  settings.beam.pattern = BeamPattern::gaussian;
  settings.beam.width_deg = 6;
  settings.pulse.kind = PulseKind::compressed;
  for (const SpeckleKind speckle :
       {SpeckleKind::ground, SpeckleKind::independent, SpeckleKind::none, SpeckleKind::geometric}) {
    settings.speckle = speckle;
    settings.frustum = speckle == SpeckleKind::geometric ? FrustumKind::oblique : FrustumKind::sweep;
    const Rendered whole = render_with(settings, 1);
    for (const int threads : {1, 3}) {
      Rendered parts;
      EXPECT_GT(turns_of(settings, threads, 0, parts), 1000);
      expect_the_same(parts, whole);
    }
  }
}

/// Batches until nothing is left to look at.
int batches_of(const FramePlan& plan) {
  const auto source = make_sample_source(plan.looks_at(), {0, 1}, nullptr);
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
  EXPECT_GE(batches_of(*plan_of(settings)), 512 * 512 / PerspectiveRays::kMostPixels);
}

TEST(ABatch, EndsThoughItsRaysMeetNothing) {
  RadarSettings settings = small_frame(FrustumKind::oblique);
  settings.azimuth_bins = 1;
  settings.r_min_m = 2300;  // and the ground that is known ends soon after
  const auto scene = make_scene(load_world(synthetic_spec(SyntheticKind::hills, 2000, 100)));
  PlanResult planned = plan_frame(scene, snapshot(settings), pose_over_origin(scene->world(), 1400));
  ASSERT_TRUE(planned.plan) << planned.errors.front().text();
  RayBatch rays;
  int ray_batches = 0;
  for (const auto source = make_ray_source(planned.plan->looks_at(), {0, 1}); source->generate(rays);)
    ++ray_batches;
  ASSERT_GE(ray_batches, 3) << "or the case is none";
  EXPECT_GE(batches_of(*planned.plan), ray_batches);
}

TEST(ABatch, IsAtMostAColumnOfTheSweep) {
  RadarSettings settings = small_frame(FrustumKind::sweep);
  settings.azimuth_bins = 1;
  settings.range_bins = 2;  // few samples a column
  settings.sub_columns = 0;
  EXPECT_GE(batches_of(*plan_of(settings)), sweep_columns_per_bin(settings));
}

}  // namespace
}  // namespace obliq::test::parked_work_test
