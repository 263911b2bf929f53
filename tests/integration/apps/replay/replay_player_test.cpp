// A replay's places, sought faster than they can be shown.
#include "server/apps/replay/replay_player.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "client/recording/recording_reader.h"
#include "proto/obliq.pb.h"
#include "tests/integration/daemon.h"
#include "tests/support/made_recording.h"

namespace obliq::test::replay_player_test {
namespace {

constexpr int kFrames = 100;
constexpr std::int64_t kStep_ns = 100'000'000;
constexpr int kShown = 20;
constexpr int kPlans = 400;  // far more than it takes, and few where each is given up for the next place

class SteadySteering : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::string path = folder_.write("timed.obliq", timed_recording(kFrames, kStep_ns).bytes);
    std::unique_ptr<client::RecordingReader> reader;
    ASSERT_TRUE(client::RecordingReader::open(path, reader).ok());
    client::RecordingStart start;
    ASSERT_TRUE(client::read_start(*reader, "main", start).ok());
    player_ = std::make_unique<ReplayPlayer>(
        path, std::move(start), ReplayOptions{.loop = true}, [](const std::string&) {}, [] {});
    wire::SetReplay pause;
    pause.set_paused(true);
    ASSERT_TRUE(player_->set(pause).empty());
  }

  /// Frames that are shown whole while another thread steers without a pause.
  int shown_beside(const std::function<void(int)>& steer) {
    std::atomic<bool> over = false;
    std::atomic<int> steered = 0;
    std::thread hand([&] {
      while (!over) steer(++steered);
    });
    while (steered < 100) std::this_thread::yield();
    const auto settings = std::make_shared<const SettingsSnapshot>();
    RenderOptions options;
    options.on_wedge = [](Wedge&&) {};
    int shown = 0;
    for (int n = 0; n < kPlans && shown < kShown; ++n) {
      const auto plan = player_->plan(settings);
      if (plan.frame && plan.frame->render({0, kMadeAzimuths / 2}, options)) ++shown;
    }
    over = true;
    hand.join();
    return shown;
  }

  TestFolder folder_;
  std::unique_ptr<ReplayPlayer> player_;
};

TEST_F(SteadySteering, SeeksWithoutAPauseDoNotKeepPlacesFromBeingShown) {
  EXPECT_EQ(shown_beside([&](int n) {
              wire::SetReplay seek;
              seek.set_seek_s(0.1 + n % 90 / 10.0);
              EXPECT_TRUE(player_->set(seek).empty());
            }),
            kShown);
}

TEST_F(SteadySteering, StationsThatJoinWithoutAPauseDoNotKeepThePlaceFromBeingShown) {
  wire::SetReplay seek;
  seek.set_seek_s(5.05);
  ASSERT_TRUE(player_->set(seek).empty());
  EXPECT_EQ(shown_beside([&](int) { player_->watched(true, true); }), kShown);
}

}  // namespace
}  // namespace obliq::test::replay_player_test
