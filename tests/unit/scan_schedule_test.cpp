#include "server/rendering/scan_schedule.h"

#include <gtest/gtest.h>

#include <vector>

namespace obliq::test {
namespace {

using net::Dwell;
using net::ScanSchedule;
using Time = ScanSchedule::Time;

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
}  // namespace obliq::test
