// The render thread with a scanning antenna: a stand-in renderer and a clock that stands still until told.
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "proto/obliq.pb.h"
#include "server/rendering/render_thread.h"
#include "tests/integration/net_fixture.h"
#include "tests/integration/rendering/render_listener.h"

namespace obliq::test::render_scan_test {
namespace {

using Time = std::chrono::steady_clock::time_point;

constexpr std::int64_t kStart_ns = 1'000'000'000'000;

/// 64 bins over 64 degrees, 8 dwells of 8, 64 deg/s: a pass takes a second, a dwell 125 ms.
class ScanTest : public ::testing::Test {
 protected:
  void begin(ScanMode mode) {
    RadarSettings settings;
    settings.frustum = FrustumKind::sweep;
    settings.azimuth_bins = 64;
    settings.range_bins = 4;
    settings.sector_deg = mode == ScanMode::circular ? 360 : 64;
    settings.scan_rate_deg_s = settings.sector_deg;
    settings.scan_mode = mode;
    settings.scan_bars_deg = bars_deg_;
    settings_ = std::make_shared<const SettingsSnapshot>(SettingsSnapshot{settings, 7});
    thread_.add_radar("main", 1, {settings_, {}, 0, poses_, false, {.gimbal = gimbal_}});
    thread_.set_demand(0, {demand()});
    thread_.start();
    while (!renderer_.scan_has_begun) std::this_thread::yield();
  }
  static rendering::Demand demand() {
    rendering::Demand demand;
    demand.watch_id = 1;
    demand.rate_hz = 5;
    demand.choice.planes = wire::plane_bit(wire::Plane::power);
    return demand;
  }
  void advance_to(double s) {
    now_ns_ = kStart_ns + static_cast<std::int64_t>(s * 1e9);
    thread_.wake();
  }
  bool first_dwell_comes(ScanMode mode) {
    begin(mode);
    advance_to(0.07);
    return events_.wait([&] { return events_.wedges.size() == 1; });
  }
  rendering::RenderThreadOptions options() {
    rendering::RenderThreadOptions options;
    options.threads = 1;
    options.clock = [this] { return Time(std::chrono::nanoseconds(now_ns_.load())); };
    return options;
  }

  std::atomic<std::int64_t> now_ns_ = kStart_ns;
  std::shared_ptr<PoseTimeLine> poses_ = std::make_shared<PoseTimeLine>(PoseSettings{});
  std::vector<double> bars_deg_;
  GimbalLimits gimbal_;
  SettingsPtr settings_;
  ScanWatch<PatternRenderer> renderer_;
  Listener events_;
  rendering::RenderThread thread_{renderer_, events_, options()};
};

TEST_F(ScanTest, EachDwellComesWhenTheBeamIsThere) {
  begin(ScanMode::sector);
  for (int k = 0; k < 8; ++k) {
    // The middle of dwell k is at (k + 1/2) / 8 s.
    advance_to((k + 0.5) / 8 + 0.001);
    ASSERT_TRUE(events_.wait([&] { return events_.wedges.size() == static_cast<std::size_t>(k + 1); }));
    EXPECT_EQ(events_.wedges.back().first_azimuth(), static_cast<unsigned>(8 * k));
    EXPECT_NEAR(static_cast<double>(events_.wedges.back().beam_ns() - kStart_ns), (k + 0.5) / 8 * 1e9, 100);
  }
  ASSERT_TRUE(events_.wait([&] { return events_.ends.size() == 1; }));
  EXPECT_EQ(events_.ends[0].missed_size(), 0);
  ASSERT_EQ(events_.begins.size(), 1u);
  ASSERT_TRUE(events_.begins[0].has_scan());
  EXPECT_TRUE(events_.begins[0].scan().clockwise());
  EXPECT_EQ(events_.begins[0].scan().rate_deg_s(), 64);
  EXPECT_EQ(events_.begins[0].scan().begin_ns(), kStart_ns);

  advance_to(1.07);  // and back, beginning where it ended
  ASSERT_TRUE(events_.wait([&] { return events_.wedges.size() == 9; }));
  EXPECT_EQ(events_.wedges.back().first_azimuth(), 56u);
  EXPECT_FALSE(events_.begins.back().scan().clockwise());
}

TEST_F(ScanTest, EachDwellHasThePoseOfItsMoment) {
  // 64 degrees of bearing in a second, known long before.
  PoseSettings pose;
  for (int i = 0; i <= 4; ++i) {
    pose.bearing_deg = 16.0 * i;
    pose.sim_time_ns = i * 250'000'000LL;
    pose.pose_id = static_cast<std::uint64_t>(i);
    ASSERT_TRUE(poses_->add(pose, kStart_ns));
  }
  // All have arrived at once: the first is shown at the start, and so is the rest from a quarter of a second
  // on, as long as their clock's steps are.
  const auto expected = [&](std::int64_t ns) { return poses_->at(ns).pose; };
  begin(ScanMode::sector);
  for (int k = 0; k < 8; ++k) {
    advance_to((k + 0.5) / 8 + 0.01);
    ASSERT_TRUE(events_.wait([&] { return events_.wedges.size() == static_cast<std::size_t>(k + 1); }));
    const wire::WedgeBlock& wedge = events_.wedges.back();
    const PoseSettings there = expected(wedge.beam_ns());
    EXPECT_EQ(wedge.pose().bearing_deg(), there.bearing_deg) << k;
    EXPECT_NEAR(there.bearing_deg, std::max(0.0, 64 * ((k + 0.5) / 8 - 0.25)), 1e-5);
    EXPECT_EQ(wedge.pose().sim_time_ns(), there.sim_time_ns);
    EXPECT_EQ(wedge.pose().pose_id(), there.pose_id);
    EXPECT_EQ(wedge.settings_version(), 7u);
  }
}

TEST_F(ScanTest, WhatTheBeamHasPassedLongAgoIsSaidToBeMissed) {
  ASSERT_TRUE(first_dwell_comes(ScanMode::sector));
  // The beam is in dwell 5; dwell 1 ended at 0.25 s, more than a quarter of a second ago, and so did 2.
  advance_to(0.70);
  ASSERT_TRUE(events_.wait([&] { return events_.wedges.size() == 2; }));
  EXPECT_EQ(events_.wedges.back().first_azimuth(), 40u);
  advance_to(0.99);
  ASSERT_TRUE(events_.wait([&] { return events_.ends.size() == 1; }));
  const wire::FrameEnd& end = events_.ends[0];
  ASSERT_EQ(end.missed_size(), 1);
  EXPECT_EQ(end.missed(0).first_azimuth(), 8u);
  EXPECT_EQ(end.missed(0).n_azimuth(), 32u);
  EXPECT_EQ(events_.wedges.size(), 4u);
  EXPECT_TRUE(events_.wait([&] { return events_.missed == 4; }));

  // Late by more than a pass: what was begun has ended, the next pass begins where the beam is.
  advance_to(3.57);
  ASSERT_TRUE(events_.wait([&] { return events_.wedges.size() == 5; }));
  EXPECT_EQ(events_.begins.size(), 2u);
  EXPECT_EQ(events_.begins.back().frames_skipped(), 2u) << "passes 1 and 2";
  EXPECT_EQ(events_.wedges.back().first_azimuth(), 24u) << "the fourth has gone back: dwell 4 of 8";
}

TEST_F(ScanTest, AHeldBeamStandsAndGoesOnWhereItWas) {
  ASSERT_TRUE(first_dwell_comes(ScanMode::sector));
  advance_to(0.08);
  thread_.hold(true);
  advance_to(5.0);
  thread_.hold(false);  // 4.92 s that do not count
  for (int k = 1; k < 8; ++k) {
    advance_to(4.92 + (k + 0.5) / 8 + 0.001);
    ASSERT_TRUE(events_.wait([&] { return events_.wedges.size() == static_cast<std::size_t>(k + 1); }));
    EXPECT_EQ(events_.wedges.back().first_azimuth(), static_cast<unsigned>(8 * k));
  }
  ASSERT_TRUE(events_.wait([&] { return events_.ends.size() == 1; }));
  EXPECT_EQ(events_.ends[0].missed_size(), 0);
  EXPECT_EQ(events_.begins.size(), 1u) << "the same pass";
}

TEST_F(ScanTest, WhoComesWhileTheBeamIsHeldGetsOneStillAndThePassGoesOnAsItWas) {
  ASSERT_TRUE(first_dwell_comes(ScanMode::sector));
  advance_to(0.08);
  thread_.hold(true);
  rendering::Demand late = demand();
  late.watch_id = 2;
  thread_.set_demand(0, {demand(), late});
  ASSERT_TRUE(events_.wait([&] { return events_.ends.size() == 1; }));
  EXPECT_FALSE(events_.begins.back().has_scan()) << "all of the sector at once";
  EXPECT_EQ(events_.wedges.size(), 1u + 8u);
  EXPECT_TRUE(events_.aborts.empty());
  EXPECT_NE(events_.ends[0].frame_id(), events_.begins[0].frame_id());
  advance_to(5.0);
  late.watch_id = 3;
  thread_.set_demand(0, {demand(), late});
  ASSERT_TRUE(events_.wait([&] { return events_.ends.size() == 2; }));
  thread_.hold(false);
  for (int k = 1; k < 8; ++k) {
    advance_to(4.92 + (k + 0.5) / 8 + 0.001);
    ASSERT_TRUE(events_.wait([&] { return events_.wedges.size() == static_cast<std::size_t>(17 + k); }));
    EXPECT_EQ(events_.wedges.back().first_azimuth(), static_cast<unsigned>(8 * k));
  }
  ASSERT_TRUE(events_.wait([&] { return events_.ends.size() == 3; }));
  EXPECT_EQ(events_.ends[2].frame_id(), events_.begins[0].frame_id()) << "the pass of before";
  EXPECT_EQ(events_.ends[2].missed_size(), 0);
}

TEST_F(ScanTest, ACircularAntennaBeginsEachTurnAtItsLeftEdge) {
  ASSERT_TRUE(first_dwell_comes(ScanMode::circular));
  advance_to(1.07);
  ASSERT_TRUE(events_.wait([&] { return events_.ends.size() == 1 && events_.wedges.size() == 2; }));
  EXPECT_EQ(events_.wedges.back().first_azimuth(), 0u);
  EXPECT_EQ(events_.begins.back().scan().mode(), wire::CIRCULAR_SCAN);
}

TEST_F(ScanTest, ChangedSettingsEndThePassAndBeginAnother) {
  ASSERT_TRUE(first_dwell_comes(ScanMode::sector));
  RadarSettings settings = settings_->settings;
  settings.scan_mode = ScanMode::frame;
  const auto whole = std::make_shared<const SettingsSnapshot>(SettingsSnapshot{settings, 8});
  thread_.set_view(0, {whole, {}, 0, poses_});
  ASSERT_TRUE(events_.wait([&] { return events_.aborts.size() == 1 && events_.ends.size() == 1; }));
  EXPECT_FALSE(events_.begins.back().has_scan());
  EXPECT_EQ(events_.aborts[0].frame_id(), events_.begins[0].frame_id());
}

TEST_F(ScanTest, BarsTakeTurnsPassByPassAndTheGimbalHoldsThem) {
  bars_deg_ = {-2, -40};
  gimbal_.elevation_min_deg = -25;
  begin(ScanMode::sector);
  for (std::size_t k = 0; k < 32; ++k) {
    advance_to((static_cast<double>(k) + 0.5) / 8 + 0.001);
    ASSERT_TRUE(events_.wait([&] { return events_.wedges.size() == k + 1; }));
    EXPECT_EQ(events_.wedges.back().pose().tilt_deg(), k / 8 % 2 == 0 ? -2 : -25) << k;
  }
}

TEST_F(ScanTest, APassThatTheServersEndCutsSaysSo) {
  ASSERT_TRUE(first_dwell_comes(ScanMode::sector));
  thread_.finish();
  ASSERT_TRUE(events_.wait([&] { return events_.aborts.size() == 1; }));
  EXPECT_EQ(events_.aborts[0].reason(), "the server is stopping");
}

TEST_F(ScanTest, ADwellThatCannotBeRenderedEndsThePassAndIsTriedAgainWhenThePoseChanges) {
  ASSERT_TRUE(first_dwell_comes(ScanMode::sector));
  RadarSettings settings = settings_->settings;
  settings.frustum = FrustumKind::oblique;  // which the stand-in refuses below 10 m
  PoseSettings low;
  low.height_m = 5;
  poses_->set(low, kStart_ns);
  const auto oblique = std::make_shared<const SettingsSnapshot>(SettingsSnapshot{settings, 8});
  thread_.set_view(0, {oblique, {}, 0, poses_});
  double s = 0.1;
  ASSERT_TRUE(events_.wait([&] {
    advance_to(s += 0.01);
    return !events_.faults.empty();
  }));
  EXPECT_EQ(events_.faults[0], "frustum.kind");
  poses_->set(PoseSettings{}, kStart_ns);  // no word to the render thread: it looks by itself
  ASSERT_TRUE(events_.wait([&] {
    advance_to(s += 0.01);
    return events_.wedges.size() >= 2;
  }));
}

}  // namespace
}  // namespace obliq::test::render_scan_test
