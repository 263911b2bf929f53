// How live radars and RenderOnce jobs take turns: the real renderer, and a clock by which a live radar is
// always due and which moves on by one step whenever it is looked at: time is counted in looks. Who is given
// how much of it: fair_share_test.
#include <gtest/gtest.h>

#include <atomic>
#include <condition_variable>
#include <mutex>

#include "server/radar/samples.h"
#include "server/rendering/render_thread.h"
#include "server/rendering/scene_renderer.h"
#include "tests/support/scenes.h"

namespace obliq::test::render_turns_test {
namespace {

using Time = std::chrono::steady_clock::time_point;

/// Counts what a live radar sends between the begin of a RenderOnce frame and its first wedge.
class TurnCounter : public rendering::RenderEvents {
 public:
  void on_live_blocks(std::size_t radar, const stream::LiveFramePtr&,
                      std::vector<stream::BlockPtr> blocks) override {
    const std::lock_guard lock(mutex_);
    if (begun_ && !wedge_) ++live_blocks_;
    const wire::MessageType type = blocks.front()->type;
    if (begun_ && !ended_ && type == wire::MessageType::frame_end) ++live_ends_;
    if (radar == 0 && type == wire::MessageType::frame_begin) long_frame_ = true;
    if (radar == 0 && type == wire::MessageType::frame_end) ++long_ends_;
    if (radar == 0 && (type == wire::MessageType::frame_end || type == wire::MessageType::frame_abort))
      long_frame_ = false;
    if (radar == 1 && type == wire::MessageType::frame_end && long_frame_) ++short_ends_within_long_;
    changed_.notify_all();
  }
  void on_live_rendered(std::size_t, const rendering::RenderedFrame&) override {}
  void on_live_held_up(std::size_t, double) override {}
  void on_finished() override {}
  void on_live_fault(std::size_t, const std::shared_ptr<const rendering::LiveView>&,
                     const std::vector<FieldError>& errors) override {
    ADD_FAILURE() << errors.front().text();
  }
  void on_request_block(const rendering::FrameRequestPtr&, const stream::BlockPtr& block) override {
    const std::lock_guard lock(mutex_);
    begun_ = true;
    wedge_ = wedge_ || block->type == wire::MessageType::wedge_block;
    ended_ = block->type == wire::MessageType::frame_end;
    changed_.notify_all();
  }
  void on_request_rendered(const rendering::RenderedRequest&) override {}
  void on_appraised(const rendering::AppraisalPtr&, const std::vector<FieldError>&) override {}
  void on_request_fault(const rendering::FrameRequestPtr&, const std::vector<FieldError>& errors) override {
    ADD_FAILURE() << errors.front().text();
  }

  /// Once the frame has ended.
  int live_blocks() {
    std::unique_lock lock(mutex_);
    EXPECT_TRUE(changed_.wait_for(lock, std::chrono::minutes(1), [this] { return ended_; }));
    return live_blocks_;
  }

  /// Frames of live radars between begin and end of the RenderOnce frame, once it has ended.
  int live_ends() {
    (void)live_blocks();
    const std::lock_guard lock(mutex_);
    return live_ends_;
  }

  /// Until a frame of radar 0 waits in its middle.
  void wait_for_short_within_long() {
    std::unique_lock lock(mutex_);
    const int before = short_ends_within_long_;
    EXPECT_TRUE(changed_.wait_for(lock, std::chrono::minutes(1),
                                  [&] { return short_ends_within_long_ > before && long_frame_; }));
  }
  bool long_frame() {
    const std::lock_guard lock(mutex_);
    return long_frame_;
  }

  /// Frames of radar 1 that ended between begin and end of frames of radar 0, of which there were at least so
  /// many.
  int short_ends_within(int long_frames) {
    std::unique_lock lock(mutex_);
    EXPECT_TRUE(changed_.wait_for(lock, std::chrono::minutes(1), [&] { return long_ends_ >= long_frames; }));
    return short_ends_within_long_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool begun_ = false;
  bool wedge_ = false;
  bool ended_ = false;
  int live_blocks_ = 0;
  int live_ends_ = 0;
  bool long_frame_ = false;
  int long_ends_ = 0;
  int short_ends_within_long_ = 0;
};

constexpr int kSide = 256;  // pixels of the RenderOnce frame, all in one azimuth bin
/// A ray asks for more than one unit: at least so many turns.
constexpr int kRaysATurn = 4 * kBatch;
constexpr int kTurns = kSide * kSide / kRaysATurn;

RadarSettings small_radar() {
  return radar_settings(FrustumKind::symmetric, {1500, 6000, 80}, {64, 8}, {64, 16});
}

class Turns : public ::testing::Test {
 protected:
  Turns() {
    options_.threads = 1;
    options_.look = 1000;
    options_.clock = [this] { return Time(std::chrono::milliseconds(now_ms_ += 50)); };
  }
  rendering::LiveView view(const RadarSettings& settings, bool live) const {
    return {snapshot(settings), pose_, 0, live ? std::make_shared<PoseTimeLine>(pose_) : nullptr};
  }
  static rendering::Demand demand(std::uint64_t watch_id) {
    rendering::Demand demand;
    demand.watch_id = watch_id;
    demand.rate_hz = 100;
    demand.choice.planes = wire::plane_bit(wire::Plane::power);
    return demand;
  }
  int live_blocks_within_a_wedge(const RadarSettings& live) {
    RadarSettings settings = live;
    settings.scan_mode = ScanMode::frame;
    settings.azimuth_bins = 1;
    settings.pixel_columns = settings.pixel_rows = kSide;
    render_beside(live, settings);
    return events_.live_blocks();
  }
  /// One frame of `settings` while a live radar is always due.
  void render_beside(const RadarSettings& live, const RadarSettings& settings) {
    rendering::RenderThread thread(renderer_, events_, options_);
    thread.add_radar("main", 1, view(live, true));
    thread.set_demand(0, {demand(1)});
    const auto job = std::make_shared<rendering::FrameRequest>();
    job->stream_id = 2;
    job->view = view(settings, false);
    job->choice = demand(1).choice;
    thread.enqueue(job);
    thread.start();
    (void)events_.live_blocks();
    thread.end();
  }

  const rendering::SceneRenderer renderer_{
      make_scene(load_world(synthetic_spec(SyntheticKind::hills, 7000, 100))), "hills"};
  PoseSettings pose_ = test::settings_over_origin(1400);
  std::atomic<std::int64_t> now_ms_ = 0;
  rendering::RenderThreadOptions options_;
  TurnCounter events_;
};

TEST_F(Turns, ALiveRadarHasItsFramesWhileARenderOnceIsInTheMiddleOfAWedge) {
  options_.once_work = kRaysATurn;
  // A frame is its begin, 8 wedges and its end.
  EXPECT_GE(live_blocks_within_a_wedge(small_radar()), 2 * 10);
}

TEST_F(Turns, AScanningAntennaWaitsForShorterParts) {
  options_.once_work_while_scanning = kRaysATurn;
  RadarSettings live = small_radar();
  live.scan_mode = ScanMode::sector;
  live.scan_rate_deg_s = 100;  // a dwell of 8 bins in 0.1 s: two looks at the clock
  EXPECT_GE(live_blocks_within_a_wedge(live), kTurns / 2);
}

/// Plan, sharp wedges and sums of a beam that goes all the way round, beside a small radar.
TEST_F(Turns, ALiveRadarHasItsFramesWhileAWideBeamIsPlannedAndSummed) {
  RadarSettings settings = small_radar();
  settings.frustum = FrustumKind::sweep;
  settings.sector_deg = 60;
  settings.azimuth_bins = 240;
  settings.range_bins = 1024;
  settings.pixel_columns = 240;
  settings.beam.pattern = BeamPattern::uniform;
  settings.beam.extent_deg = 180;
  render_beside(small_radar(), settings);
  // Its 1440 taps of 1024 bins of 240 azimuths are 354 million products: half of 11,000 looks are the live
  // radar's, a frame of which takes some hundred.
  EXPECT_GE(events_.live_ends(), 20);
}

TEST_F(Turns, ALiveRadarHasItsFramesWhileOneAzimuthBinHasManyPlanes) {
  RadarSettings settings = small_radar();
  settings.frustum = FrustumKind::sweep;
  settings.sub_columns = 0;
  settings.sector_deg = 0.4;
  settings.azimuth_bins = 1;
  settings.pixel_columns = 16384;
  render_beside(small_radar(), settings);
  EXPECT_GE(events_.live_ends(), 10);
}

TEST_F(Turns, AFrameThatIsStoppedInItsMiddleIsAbortedThoughItWaitsForItsTurn) {
  rendering::RenderThread thread(renderer_, events_, options_);
  RadarSettings settings = small_radar();
  settings.azimuth_bins = 1;
  settings.pixel_columns = settings.pixel_rows = kSide;
  thread.add_radar("long", 1, view(settings, true));
  settings.pixel_columns = settings.pixel_rows = 16;
  thread.add_radar("short", 2, view(settings, true));
  for (const std::size_t radar : {0u, 1u}) thread.set_demand(radar, {demand(radar + 1)});
  thread.start();
  events_.wait_for_short_within_long();
  thread.end();
  EXPECT_FALSE(events_.long_frame()) << "neither ended nor aborted";
}

/// A pass that is one dwell.
TEST_F(Turns, ALongDwellGivesWayToShortFramesOfAnotherRadar) {
  rendering::RenderThread thread(renderer_, events_, options_);
  RadarSettings settings = small_radar();
  settings.azimuth_bins = 8;
  settings.pixel_columns = settings.pixel_rows = kSide;
  settings.scan_mode = ScanMode::sector;
  settings.scan_rate_deg_s = 1;
  thread.add_radar("long", 1, view(settings, true));
  settings = small_radar();
  settings.azimuth_bins = 1;
  settings.pixel_columns = settings.pixel_rows = 16;
  thread.add_radar("short", 2, view(settings, true));
  for (const std::size_t radar : {0u, 1u}) thread.set_demand(radar, {demand(radar + 1)});
  thread.start();
  EXPECT_GE(events_.short_ends_within(3), 3);
  thread.end();
}

TEST_F(Turns, ALongFrameOfOneRadarGivesWayInItsMiddleToShortOnesOfAnother) {
  rendering::RenderThread thread(renderer_, events_, options_);
  RadarSettings settings = small_radar();
  settings.azimuth_bins = 1;
  settings.pixel_columns = settings.pixel_rows = kSide;  // 64 batches, all of one wedge
  thread.add_radar("long", 1, view(settings, true));
  settings.pixel_columns = settings.pixel_rows = 16;
  thread.add_radar("short", 2, view(settings, true));
  for (const std::size_t radar : {0u, 1u}) thread.set_demand(radar, {demand(radar + 1)});
  thread.start();
  EXPECT_GE(events_.short_ends_within(3), 3);
  thread.end();
  EXPECT_GT(thread.load(0).frames_shed, 0u);
}

}  // namespace
}  // namespace obliq::test::render_turns_test
