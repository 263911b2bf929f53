// Who renders next, and what is shed: the decisions alone, over radars with given rates and costs, in a time
// that is counted and not measured.
#include "server/rendering/fair_share.h"

#include <gtest/gtest.h>

#include <vector>

#include "server/rendering/scan_schedule.h"

namespace obliq::test::fair_share_test {
namespace {

using namespace rendering;

using Time = FrameDates::Time;
using Duration = FrameDates::Duration;

Duration seconds(double s) { return std::chrono::duration_cast<Duration>(std::chrono::duration<double>(s)); }
double to_seconds(Duration d) { return std::chrono::duration<double>(d).count(); }

struct Radar {
  Radar(double rate, double cost) : rate_hz(rate), cost_s(cost) {}

  double rate_hz;
  double cost_s;

  // What came of it:
  std::uint64_t begun = 0;
  std::uint64_t done = 0;
  std::uint64_t shed = 0;
  double spent_s = 0;
  double worst_latency_s = 0;  // date to end
  int interrupted = 0;
  double left_s = 0;  // of the current frame
  Time date;
  FrameDates dates;

  double share(double run_s) const { return spent_s / run_s; }
};

/// As RenderThread does it: the first goes on until it is done, until it has led for long enough, or until a
/// radar that would go before it has a frame due.
void run(std::vector<Radar>& radars, double run_s) {
  constexpr double kShortest_s = 0.005;
  FairShare turns;
  const Time start{};
  for (std::size_t k = 0; k < radars.size(); ++k) {
    turns.add();
    radars[k].dates.begin_at(start);
  }
  std::optional<std::size_t> before;
  for (Time now = start; to_seconds(now - start) < run_s;) {
    for (std::size_t k = 0; k < radars.size(); ++k)
      turns.set_wanting(k, radars[k].left_s > 0 || radars[k].dates.due() <= now);
    const auto first = turns.first();
    if (!first) {
      now = std::min_element(radars.begin(), radars.end(), [](const Radar& a, const Radar& b) {
              return a.dates.due() < b.dates.due();
            })->dates.due();
      continue;
    }
    if (before && *before != *first && radars[*before].left_s > 0) ++radars[*before].interrupted;
    before = first;
    Radar& radar = radars[*first];
    if (radar.left_s == 0) {
      const auto taken = radar.dates.take(now, seconds(1 / radar.rate_hz), false);
      radar.shed += taken.shed;
      radar.date = now - taken.late;
      radar.left_s = radar.cost_s;
      ++radar.begun;
    }
    double turn_s = radar.left_s;
    for (std::size_t k = 0; k < radars.size(); ++k) {
      if (k == *first) continue;
      const double due_s = radars[k].left_s > 0 ? 0 : to_seconds(radars[k].dates.due() - now);
      turn_s = std::min(turn_s, std::max({kShortest_s, due_s, turns.lead_s(*first, k)}));
    }
    now += seconds(turn_s);
    radar.left_s -= turn_s;
    radar.spent_s += turn_s;
    turns.charge(*first, turn_s);
    if (radar.left_s > 1e-9) continue;
    radar.left_s = 0;
    turns.done(*first);
    ++radar.done;
    if (radar.done > 1)  // of the first nobody knows what it costs
      radar.worst_latency_s = std::max(radar.worst_latency_s, to_seconds(now - radar.date));
  }
}

TEST(FairShare, WhoIsWithinTheCapacityGetsEveryFrameOfItsRate) {
  std::vector<Radar> radars{{10, 0.01}, {5, 0.04}, {1, 0.3}, {20, 0.005}};  // 0.7 of the time
  run(radars, 100);
  for (const Radar& radar : radars) {
    EXPECT_LE(radar.shed, 1u) << radar.rate_hz << " Hz; in the first moment nobody's cost is known";
    EXPECT_NEAR(static_cast<double>(radar.done), 100 * radar.rate_hz, 1.0) << radar.rate_hz;
  }
}

TEST(FairShare, UnderOverloadEqualRadarsHaveEqualSharesAndEveryFrameIsRenderedOrCounted) {
  std::vector<Radar> radars(16, Radar{10, 0.0125});  // twice the capacity
  run(radars, 100);
  for (const Radar& radar : radars) {
    EXPECT_NEAR(radar.share(100), 1.0 / 16, 0.01 / 16);
    EXPECT_NEAR(static_cast<double>(radar.done), 500, 2);
    EXPECT_NEAR(static_cast<double>(radar.begun + radar.shed), 1000, 2)
        << "whole frames, and no date is lost";
    EXPECT_EQ(radar.interrupted, 0) << "nothing is won by interrupting one's equal";
  }
}

TEST(FairShare, AFrameThatTakesLittleLongerThanTheLastOneIsNotInterruptedForItsEqualJustBeforeItsEnd) {
  FairShare turns;
  const std::size_t one = turns.add(), other = turns.add();
  for (const std::size_t flow : {one, other}) {
    turns.set_wanting(flow, true);
    turns.charge(flow, 0.1);
    turns.done(flow);
  }
  ASSERT_EQ(turns.first(), one);
  turns.charge(one, 0.13);
  EXPECT_EQ(turns.first(), one);
  turns.charge(one, 0.07);
  EXPECT_EQ(turns.first(), other) << "twice as long: it may take any time";
}

TEST(FairShare, NewcomersOfEqualCostAreServedOneAfterTheOtherWhenAllHaveHadATrial) {
  std::vector<Radar> radars(16, Radar{0.01, 0.3});
  run(radars, 16 * 0.05 + 6 * 0.25);
  for (std::size_t k = 0; k < radars.size(); ++k) EXPECT_EQ(radars[k].done, k < 6 ? 1u : 0u) << k;
}

TEST(FairShare, QuickNewcomersDoNotWaitForASlowOneThatNobodyKnows) {
  std::vector<Radar> radars(16, Radar{0.01, 0.03});
  radars[0].cost_s = 0.5;
  run(radars, 0.05 + 15 * 0.03);
  for (std::size_t k = 1; k < radars.size(); ++k) EXPECT_EQ(radars[k].done, 1u) << k;
}

TEST(FairShare, OneSlowRadarTakesNothingFromThoseWithinTheirShares) {
  // 16 radars, one of them 20 times as slow: it alone would need 1.25 of the time, the others half of it.
  std::vector<Radar> radars(16, Radar{5, 0.0125 / 1.9});
  radars[7].cost_s *= 20;
  radars[7].rate_hz = 10;
  run(radars, 200);
  double others = 0;
  for (std::size_t k = 0; k < radars.size(); ++k) {
    if (k == 7) continue;
    EXPECT_EQ(radars[k].shed, 0u) << k;
    EXPECT_NEAR(static_cast<double>(radars[k].done), 1000, 1) << k;
    // Its own cost, all others at the same moment, and the shortest turn of the slow one.
    EXPECT_LE(radars[k].worst_latency_s, 16 * 0.0125 / 1.9 + 0.005) << k;
    others += radars[k].spent_s;
  }
  EXPECT_NEAR(radars[7].spent_s, 200 - others, 0.5) << "it has all that the others leave";
  EXPECT_GT(radars[7].shed, 0u);
  EXPECT_GT(radars[7].interrupted, 0);
}

TEST(FairShare, UnderOverloadASlowRadarHasItsShareOfTimeAndNoMore) {
  std::vector<Radar> radars(16, Radar{10, 0.0125});
  radars[0].cost_s *= 20;
  run(radars, 200);
  for (const Radar& radar : radars) EXPECT_NEAR(radar.share(200), 1.0 / 16, 0.03 / 16);
  EXPECT_NEAR(static_cast<double>(radars[1].done) / static_cast<double>(radars[0].done), 20, 1.5);
}

TEST(FairShare, WhoAsksForMoreFramesThanItCanHaveTakesNothingFromOthers) {
  std::vector<Radar> radars(4, Radar{5, 0.04});  // 0.2 of the time each
  radars[2].rate_hz = 10000;
  run(radars, 100);
  for (const std::size_t k : {0u, 1u, 3u}) EXPECT_EQ(radars[k].shed, 0u) << k;
  EXPECT_NEAR(radars[2].share(100), 0.4, 0.01);
}

TEST(FairShare, RestingGivesNoClaimOnTheTimeThatOthersHadMeanwhile) {
  FairShare turns;
  const std::size_t busy = turns.add(), rested = turns.add();
  turns.set_wanting(busy, true);
  for (int n = 0; n < 1000; ++n) {
    turns.charge(busy, 0.01);
    turns.done(busy);
  }
  turns.set_wanting(rested, true);
  // Both have the same cost from now on: neither gets more than two turns in a row.
  turns.charge(rested, 0.01);
  turns.done(rested);
  int turns_of_rested = 0;
  for (int n = 0; n < 100; ++n) {
    const std::size_t first = *turns.first();
    turns_of_rested += first == rested ? 1 : 0;
    turns.charge(first, 0.01);
    turns.done(first);
  }
  EXPECT_NEAR(turns_of_rested, 50, 1);
}

TEST(FairShare, ALongFrameGivesWayInItsMiddleAndEndsAllTheSame) {
  std::vector<Radar> radars{{50, 0.002}, {1, 0.5}};
  run(radars, 20);
  EXPECT_GT(radars[1].interrupted, 5);
  EXPECT_NEAR(static_cast<double>(radars[1].done), 20, 1);
  EXPECT_LE(radars[0].worst_latency_s, 0.002 + 0.005 + 1e-6);
  EXPECT_EQ(radars[0].shed, 0u);
}

TEST(FrameDates, ALateFrameStandsForTheNewestDateAndTheDatesStayWhereTheyAre) {
  FrameDates dates;
  const Time start{};
  dates.begin_at(start);
  EXPECT_EQ(dates.take(start, seconds(0.1), false).shed, 0u);
  EXPECT_EQ(dates.due(), start + seconds(0.1));
  const auto late = dates.take(start + seconds(0.15), seconds(0.1), false);
  EXPECT_EQ(late.shed, 0u);
  EXPECT_EQ(late.late, seconds(0.05));
  EXPECT_EQ(dates.due(), start + seconds(0.2)) << "late by half a period: in time again with the next";
  const auto later = dates.take(start + seconds(0.55), seconds(0.1), false);
  EXPECT_EQ(later.shed, 3u) << "those of 0.2, 0.3 and 0.4";
  EXPECT_EQ(later.late, seconds(0.05)) << "it stands for that of 0.5";
  EXPECT_EQ(dates.due(), start + seconds(0.6));
}

TEST(FrameDates, WhereNoneMayBeShedTheyArePutOff) {
  FrameDates dates;
  const Time start{};
  dates.begin_at(start);
  EXPECT_EQ(dates.take(start + seconds(0.55), seconds(0.1), true).shed, 0u);
  EXPECT_EQ(dates.due(), start + seconds(0.55));
}

// 100 bins over 100 degrees at 50 deg/s: a pass takes 2 s, a bin 20 ms, a dwell of 16 bins 320 ms; the
// seventh dwell has the 4 bins that are left.
RadarSettings to_and_fro() {
  RadarSettings settings;
  settings.scan_mode = ScanMode::sector;
  settings.sector_deg = 100;
  settings.azimuth_bins = 100;
  settings.scan_rate_deg_s = 50;
  settings.scan_dwell_bins = 16;
  return settings;
}

Time start() { return Time(std::chrono::hours(100)); }
Time after_s(double s) {
  return start() + std::chrono::duration_cast<Time::duration>(std::chrono::duration<double>(s));
}
double since_s(Time time) { return std::chrono::duration<double>(time - start()).count(); }

TEST(ScanSchedule, APassGoesOverEveryBinOnceForwardAndTheNextOneBack) {
  const ScanSchedule schedule(to_and_fro(), start());
  ASSERT_EQ(schedule.dwells(), 7);
  std::vector<int> firsts;
  Dwell dwell;
  for (int i = 0; i < 14; ++i, dwell = schedule.after(dwell))
    firsts.push_back(schedule.azimuths(dwell).first);
  EXPECT_EQ(firsts, (std::vector<int>{0, 16, 32, 48, 64, 80, 96, 96, 80, 64, 48, 32, 16, 0}));
  EXPECT_EQ(schedule.azimuths({0, 6}).count, 4);
  EXPECT_TRUE(schedule.is_clockwise(0));
  EXPECT_FALSE(schedule.is_clockwise(1));
  EXPECT_EQ(dwell.pass, 2u);
}

TEST(ScanSchedule, ACircularAntennaAlwaysTurnsClockwise) {
  RadarSettings settings = to_and_fro();
  settings.scan_mode = ScanMode::circular;
  const ScanSchedule schedule(settings, start());
  EXPECT_TRUE(schedule.is_clockwise(1));
  EXPECT_EQ(schedule.azimuths({1, 0}).first, 0);
}

TEST(ScanSchedule, TheBeamIsWhereItsRateTakesIt) {
  const ScanSchedule schedule(to_and_fro(), start());
  EXPECT_NEAR(since_s(schedule.middle({0, 0})), 0.16, 1e-9);
  EXPECT_NEAR(since_s(schedule.middle({0, 6})), 1.96, 1e-9) << "bins 96 to 99: 1.92 to 2 s";
  EXPECT_NEAR(since_s(schedule.middle({1, 0})), 2.04, 1e-9) << "and back over the same bins";
  EXPECT_NEAR(since_s(schedule.end({1, 6})), 4, 1e-9);
  EXPECT_NEAR(since_s(schedule.pass_begin(3)), 6, 1e-9);
}

TEST(ScanSchedule, AtFindsTheDwellWhoseTimeItIs) {
  const ScanSchedule schedule(to_and_fro(), start());
  Dwell dwell;
  for (int i = 0; i < 30; ++i, dwell = schedule.after(dwell))
    EXPECT_EQ(schedule.at(schedule.middle(dwell)), dwell);
  EXPECT_EQ(schedule.at(after_s(-1)), (Dwell{0, 0}));
}

TEST(ScanSchedule, WhoIsLateByMoreThanAQuarterOfASecondGoesToTheBeam) {
  const ScanSchedule schedule(to_and_fro(), start());
  EXPECT_EQ(schedule.lag_s(), 0.25);
  const Dwell second{0, 1};  // left by the beam at 0.64 s
  EXPECT_EQ(schedule.next(second, after_s(0.5)), second);
  EXPECT_EQ(schedule.next(second, after_s(0.88)), second);
  EXPECT_EQ(schedule.next(second, after_s(0.90)), (Dwell{0, 2}));
  EXPECT_EQ(schedule.next(second, after_s(1.97)), (Dwell{0, 6}));
  EXPECT_EQ(schedule.next(second, after_s(6.2)), (Dwell{3, 1})) << "whole passes later: 0.2 s into it, back";
}

TEST(ScanSchedule, AFastAntennaMayLagAQuarterOfItsTurn) {
  RadarSettings settings = to_and_fro();
  settings.scan_rate_deg_s = 1000;
  EXPECT_NEAR(ScanSchedule(settings, start()).lag_s(), 0.025, 1e-12);
}

}  // namespace
}  // namespace obliq::test::fair_share_test
