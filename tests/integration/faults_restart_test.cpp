// kill -9 of obliqd, and another one on the same port: clients resume what they had asked for.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <csignal>
#include <future>
#include <optional>
#include <sstream>
#include <thread>

#include "client/frame_assembler.h"
#include "client/resuming_client.h"
#include "proto/obliq.pb.h"
#include "tests/integration/daemon.h"

namespace obliq::test {
namespace {

using client::FrameAssembler;

constexpr client::Timeout kLong{20000};  // reached only when something is broken

const std::string kScene = text_of(SmallScene{.pixels = 512, .azimuth_bins = 360, .range_bins = 256});

class Restart : public testing::Test {
 protected:
  /// In the place of the one that was killed.
  void start_again() {
    const std::string address = daemon->address();
    daemon.reset();
    daemon.emplace(std::vector<std::string>{"--config", scene, "--port", port_of(address)}, folder.path());
    ASSERT_EQ(daemon->address(), address) << daemon->log();
  }
  void kill_nine() {
    daemon->send_signal(SIGKILL);
    siginfo_t info{};
    waitid(P_PID, static_cast<id_t>(daemon->pid()), &info, WEXITED | WNOWAIT);
  }
  static std::string port_of(const std::string& address) { return address.substr(address.find(':') + 1); }

  TestFolder folder;
  std::string scene = folder.write("scene.toml", kScene);
  std::optional<Daemon> daemon{std::in_place, std::vector<std::string>{"--config", scene}, folder.path()};
};

client::ResumingClient connect(const std::string& address, client::ResumeOptions options) {
  client::Client client;
  EXPECT_TRUE(client.connect(*client::parse_endpoint(address)).ok());
  return {std::move(client), std::move(options)};
}

// Fails when the frame in hand is kept (a frame begins before the one before it ended), when the
// subscription or the claim is not repeated, and when the port may not be bound at once.
TEST_F(Restart, AClientResumesItsFramesAndItsControl) {
  int lost = 0;
  int resumed = 0;
  client::ResumeOptions options;
  options.on_lost = [&](const client::Status&) { ++lost; };
  options.on_resumed = [&](std::chrono::duration<double>) { ++resumed; };
  auto watching = connect(daemon->address(), options);
  FrameAssembler frames;
  watching.client().set_handler(&frames);
  ASSERT_TRUE(watching.claim_control("main").ok());
  ASSERT_TRUE(watching.subscribe("main", 50).ok());
  const auto next_frame = [&] {
    while (frames.state() != FrameAssembler::State::complete) {
      const client::Status status = watching.receive(kLong);
      if (!status.ok()) {
        ADD_FAILURE() << status.sentence() << "\n" << daemon->log();
        break;
      }
    }
    return frames.take();
  };
  const auto before = next_frame();
  for (int restart = 1; restart <= 3; ++restart) {
    while (frames.state() != FrameAssembler::State::receiving) ASSERT_TRUE(watching.receive(kLong).ok());
    kill_nine();
    start_again();
    const auto after = next_frame();
    EXPECT_EQ(resumed, restart);
    EXPECT_TRUE(after.iq == before.iq) << "the same scene and settings, the same bits";
    wire::Pose pose;
    wire::Ack ack;
    pose.set_bearing_deg(12);
    EXPECT_TRUE(watching.client().set_pose("main", pose, ack).ok()) << "control is held again";
  }
  EXPECT_EQ(lost, 3);
}

TEST_F(Restart, WatchGoesOnAndSaysSo) {
  std::filesystem::create_directories(folder / "watch");
  auto watch = std::async(std::launch::async, [&, server = daemon->address()] {
    return run_program(OBLIQ_PROGRAM, {"watch", "--server", server, "--rate", "20", "--frames", "30"},
                       folder / "watch");
  });
  const auto lines = [&] {
    const std::string text = text_of(folder / "watch/out");
    return std::count(text.begin(), text.end(), '\n');
  };
  while (lines() < 3 && watch.wait_for(std::chrono::milliseconds(10)) != std::future_status::ready) {
  }
  kill_nine();
  start_again();
  const Outcome outcome = watch.get();
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(std::count(outcome.out.begin(), outcome.out.end(), '\n'), 30) << outcome.out;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 3) << outcome.err;
  EXPECT_NE(outcome.err.find("hold no sample"), std::string::npos) << outcome.err;  // once, of this scene
  EXPECT_NE(outcome.err.find("connection lost: "), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("connected again, "), std::string::npos) << outcome.err;
}

TEST_F(Restart, WatchGoesOnAfterAStopInGoodOrder) {
  std::filesystem::create_directories(folder / "watch");
  auto watch = std::async(std::launch::async, [&, server = daemon->address()] {
    return run_program(OBLIQ_PROGRAM, {"watch", "--server", server, "--rate", "20", "--frames", "12"},
                       folder / "watch");
  });
  while (text_of(folder / "watch/out").empty() &&
         watch.wait_for(std::chrono::milliseconds(10)) != std::future_status::ready) {
  }
  daemon->send_signal(SIGTERM);
  siginfo_t info{};
  waitid(P_PID, static_cast<id_t>(daemon->pid()), &info, WEXITED | WNOWAIT);
  start_again();
  const Outcome outcome = watch.get();
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("connected again, "), std::string::npos) << outcome.err;
}

// The frame that the kill cuts is incomplete in the file, every other one is whole and the same.
TEST_F(Restart, ARecordingGoesOnInTheSameFile) {
  std::filesystem::create_directories(folder / "record");
  const std::string file = folder / "main.obliq";
  auto record = std::async(std::launch::async, [&, server = daemon->address()] {
    return run_program(OBLIQ_PROGRAM,
                       {"record", "--server", server, "--rate", "50", "--frames", "40", "--out", file},
                       folder / "record");
  });
  const auto recorded = [&] {
    std::error_code none;
    const auto bytes = std::filesystem::file_size(file, none);
    return none ? 0 : bytes;
  };
  while (recorded() < 5'000'000 &&
         record.wait_for(std::chrono::milliseconds(5)) != std::future_status::ready) {
  }
  kill_nine();
  start_again();
  const Outcome outcome = record.get();
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("connected again, "), std::string::npos) << outcome.err;
  const Outcome replayed = run_program(OBLIQ_PROGRAM, {"replay", file, "--speed", "max"}, folder.path());
  // Unless the kill fell between two frames.
  const bool cut = replayed.err.find("the connection was lost there") != std::string::npos;
  EXPECT_EQ(replayed.code, cut ? 2 : 0) << replayed.err;
  int frames = 0;
  std::istringstream lines(replayed.out);
  for (std::string line; std::getline(lines, line);) frames += line.rfind("frame ", 0) == 0;
  EXPECT_EQ(frames, 40) << replayed.out << replayed.err;
}

TEST_F(Restart, PatienceEndsWithHowItWasLost) {
  client::ResumeOptions options;
  options.patience = std::chrono::seconds(1);
  auto watching = connect(daemon->address(), options);
  ASSERT_TRUE(watching.subscribe("main", 1).ok());
  kill_nine();
  client::Status status;
  while (status.ok()) status = watching.receive(kLong);
  EXPECT_EQ(status.outcome, client::Outcome::cannot_connect) << status.sentence();
  EXPECT_NE(status.text.find("(tried again for "), std::string::npos) << status.text;
}

TEST_F(Restart, ARadarThatIsNoLongerThereIsNotWaitedFor) {
  auto watching = connect(daemon->address(), {});
  ASSERT_TRUE(watching.subscribe("main", 1).ok());
  kill_nine();
  std::string text = kScene;
  text.replace(text.find("[radar]"), 7, "[[radar]]\nname = \"nose\"");
  folder.write("scene.toml", text);
  start_again();
  client::Status status;
  while (status.ok()) status = watching.receive(kLong);
  EXPECT_EQ(status.outcome, client::Outcome::refused);
  EXPECT_NE(status.sentence().find("main"), std::string::npos) << status.sentence();
}

}  // namespace
}  // namespace obliq::test
