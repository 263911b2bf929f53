// How live radars and RenderOnce jobs take turns: the real renderer, and a clock by which a live radar is
// always due.
#include <gtest/gtest.h>

#include <atomic>
#include <condition_variable>
#include <mutex>

#include "server/net/render_thread.h"
#include "server/net/scene_renderer.h"
#include "server/radar/batches.h"
#include "tests/support/scenes.h"

namespace obliq::test {
namespace {

using Time = std::chrono::steady_clock::time_point;

/// Counts what a live radar sends between the begin of a RenderOnce frame and its first wedge.
class TurnCounter : public net::RenderEvents {
 public:
  void on_live_blocks(std::size_t, const net::LiveFramePtr&, std::vector<net::BlockPtr>) override {
    const std::lock_guard lock(mutex_);
    if (begun_ && !wedge_) ++live_blocks_;
  }
  void on_live_rendered(std::size_t, const net::RenderedFrame&) override {}
  void on_live_held_up(std::size_t, double) override {}
  void on_finished() override {}
  void on_live_fault(std::size_t, const std::shared_ptr<const net::LiveView>&,
                     const std::vector<FieldError>& errors) override {
    ADD_FAILURE() << errors.front().text();
  }
  void on_once_block(const net::OnceJobPtr&, const net::BlockPtr& block) override {
    const std::lock_guard lock(mutex_);
    begun_ = true;
    wedge_ = wedge_ || block->type == wire::MessageType::wedge_block;
    ended_ = block->type == wire::MessageType::frame_end;
    changed_.notify_all();
  }
  void on_once_rendered(const net::RenderedOnce&) override {}
  void on_once_fault(const net::OnceJobPtr&, const std::vector<FieldError>& errors) override {
    ADD_FAILURE() << errors.front().text();
  }

  /// Once the frame has ended.
  int live_blocks() {
    std::unique_lock lock(mutex_);
    EXPECT_TRUE(changed_.wait_for(lock, std::chrono::minutes(1), [this] { return ended_; }));
    return live_blocks_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool begun_ = false;
  bool wedge_ = false;
  bool ended_ = false;
  int live_blocks_ = 0;
};

constexpr int kSide = 256;  // pixels of the RenderOnce frame, all in one azimuth bin
constexpr int kBatchesATurn = 4;
constexpr int kTurns = kSide * kSide / kBatch / kBatchesATurn;

int live_blocks_within_a_wedge(const RadarSettings& live, net::RenderThreadOptions options) {
  const net::SceneRenderer renderer(make_scene(load_world(synthetic_spec(SyntheticKind::hills, 7000, 100))),
                                    "hills");
  PoseSettings pose;
  pose.latitude_deg = 33.0;
  pose.longitude_deg = -99.5;
  pose.height_m = 1400;
  std::atomic<std::int64_t> now_ms = 0;
  options.threads = 1;
  options.clock = [&] { return Time(std::chrono::milliseconds(now_ms += 50)); };
  TurnCounter events;
  net::RenderThread thread(renderer, events, options);
  thread.add_radar("main", 1, {snapshot(live), pose, 0, std::make_shared<PoseTimeLine>(pose)});
  net::Demand demand;
  demand.watch_id = 1;
  demand.rate_hz = 100;
  demand.choice.planes = wire::plane_bit(wire::Plane::power);
  thread.set_demand(0, {demand});

  RadarSettings settings = live;
  settings.scan_mode = ScanMode::frame;
  settings.azimuth_bins = 1;
  settings.pixel_columns = settings.pixel_rows = kSide;
  const auto job = std::make_shared<net::OnceJob>();
  job->stream_id = 2;
  job->view = {snapshot(settings), pose, 0, nullptr};
  job->choice = demand.choice;
  thread.enqueue(job);
  thread.start();
  const int blocks = events.live_blocks();
  thread.end();
  return blocks;
}

RadarSettings small_radar() {
  RadarSettings settings;
  settings.frustum = FrustumKind::polar;
  settings.sector_deg = 80;
  settings.azimuth_bins = 64;
  settings.range_bins = 8;
  settings.pixel_columns = 64;
  settings.pixel_rows = 16;
  settings.r_min_m = 1500;
  settings.r_max_m = 6000;
  return settings;
}

TEST(Turns, ALiveRadarHasItsFramesWhileARenderOnceIsInTheMiddleOfAWedge) {
  net::RenderThreadOptions options;
  options.slice_batches = kBatchesATurn;
  // A frame is its begin, 8 wedges and its end.
  EXPECT_GE(live_blocks_within_a_wedge(small_radar(), options), 10 * (kTurns - 1));
}

TEST(Turns, AScanningAntennaWaitsForShorterParts) {
  net::RenderThreadOptions options;
  options.slice_batches_while_scanning = kBatchesATurn;
  RadarSettings live = small_radar();
  live.scan_mode = ScanMode::sector;
  live.scan_rate_deg_s = 100;  // a dwell of 8 bins in 0.1 s: two looks at the clock
  EXPECT_GE(live_blocks_within_a_wedge(live, options), kTurns / 2);
}

}  // namespace
}  // namespace obliq::test
