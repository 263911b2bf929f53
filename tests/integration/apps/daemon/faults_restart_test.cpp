// kill -9 of obliqd, and another one on the same port: clients resume what they had asked for.
// Half-open connections: a network that swallows packets without a word. In a network namespace of its own,
// with a firewall that drops what comes from or goes to one address of the loopback; skipped where neither is
// allowed.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <future>
#include <memory>
#include <optional>
#include <sstream>
#include <thread>

#include "client/frame_assembler.h"
#include "client/resuming_client.h"
#include "proto/message_codec.h"
#include "proto/obliq.pb.h"
#include "tests/integration/clients.h"
#include "tests/integration/daemon.h"

namespace obliq::test::faults_restart_test {
namespace {

using client::FrameAssembler;

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
  client::Client client = connected(address);
  return {std::move(client), std::move(options)};
}

// Fails when the flight ends with the server, when the pose is not claimed again, and when the sector's
// centre is not sent again to the new server.
TEST_F(Restart, AFlightGoesOnWhenTheServerIsBack) {
  const std::string track = folder.write("track.csv", "0,33,-99.5,1500,40\n3600,33.1,-99.5,1500,40\n");
  Running flight({"fly", track, "--server", daemon->address()}, folder / "fly.log");
  const auto fly_on = [&] {
    client::Client looking = connected(daemon->address());
    wire::RadarInfo info;
    do {
      EXPECT_TRUE(is_ok(looking.get_radar("main", info)));
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    } while (info.pose().pose_id() < 3 && !flight.has_ended());
    EXPECT_NE(info.controller().find("obliq fly"), std::string::npos) << flight.log();
    EXPECT_EQ(info.pose().bearing_deg(), 40);
    return info.pose().pose_id();
  };
  const std::uint64_t before = fly_on();
  kill_nine();
  start_again();
  EXPECT_GT(fly_on(), before) << "the flight's own clock";
  EXPECT_EQ(flight.end(SIGINT), 0) << flight.log();
  EXPECT_NE(flight.log().find("connected again"), std::string::npos) << flight.log();
}

// Fails when the current frame is kept (a frame begins before the one before it ended), when the
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

using wire::MessageType;

// As short as the configuration allows: 4 s without a sign of life.
const std::string kPlain =
    text_of(SmallScene{.pixels = 256, .azimuth_bins = 180, .range_bins = 128, .server = R"(address = "0.0.0.0"
unprotected = true
dead_after_s = 4.0
heartbeat_s = 1.0
stall_timeout_s = 600.0
idle_timeout_s = 0.0
)"});

bool run(const std::string& command) { return std::system((command + " >/dev/null 2>&1").c_str()) == 0; }

class HalfOpen : public testing::Test {
 protected:
  void SetUp() override {
    if (unshare(CLONE_NEWNET) != 0) GTEST_SKIP() << "no right to make a network namespace (root has it)";
    if (!run("ip link set lo up")) GTEST_SKIP() << "no ip command";
    if (!run("iptables -L -n")) GTEST_SKIP() << "no iptables here";
    daemon = std::make_unique<Daemon>(std::vector<std::string>{"--config", scene}, folder.path());
    ASSERT_NE(daemon->address(), "") << daemon->log();
    port = daemon->address().substr(daemon->address().rfind(':') + 1);
  }
  /// Packets of that address vanish from now on, or are let through again.
  static void swallow(const std::string& address, bool swallowed) {
    for (const char* end : {"-s ", "-d "}) {
      ASSERT_TRUE(
          run(std::string("iptables ") + (swallowed ? "-A" : "-D") + " INPUT " + end + address + " -j DROP"));
    }
  }
  client::Endpoint endpoint(const std::string& host) const {
    return *client::parse_endpoint(host + ":" + port);
  }

  TestFolder folder;
  std::string scene = folder.write("scene.toml", kPlain);
  std::unique_ptr<Daemon> daemon;
  std::string port;
};

/// A client that connects from 127.0.0.2 and says Hello, and what more it is told.
class Guest {
 public:
  explicit Guest(const std::string& port) : fd_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in own{};
    own.sin_family = AF_INET;
    inet_pton(AF_INET, "127.0.0.2", &own.sin_addr);
    EXPECT_EQ(bind(fd_, reinterpret_cast<sockaddr*>(&own), sizeof own), 0);
    sockaddr_in server = own;
    inet_pton(AF_INET, "127.0.0.1", &server.sin_addr);
    server.sin_port = htons(static_cast<std::uint16_t>(std::stoi(port)));
    EXPECT_EQ(::connect(fd_, reinterpret_cast<sockaddr*>(&server), sizeof server), 0);
    wire::Hello hello;
    hello.set_request_id(1);
    hello.set_major(1);
    send(MessageType::hello, hello);
  }
  ~Guest() { close(fd_); }
  void send(MessageType type, const google::protobuf::MessageLite& message) {
    const wire::Bytes bytes = wire::encode_message(type, {0, ++sequence_, 0}, message);
    EXPECT_EQ(::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL), static_cast<ssize_t>(bytes.size()));
  }

 private:
  int fd_;
  std::uint64_t sequence_ = 0;
};

void next_frame(client::Client& client, FrameAssembler& frames, const Daemon& daemon) {
  while (frames.state() != FrameAssembler::State::complete) {
    const client::Status status = client.receive(kLong);
    ASSERT_TRUE(status.ok()) << status.sentence() << "\n" << daemon.log();
  }
  (void)frames.take();
}

// Fails without TCP_USER_TIMEOUT: frames that wait unacknowledged keep the watcher for a quarter of an hour.
// And without heartbeats and keepalive: a guest that asks for nothing stays for ever.
TEST_F(HalfOpen, PeersThatVanishWithoutAWordAreGoneAndOthersLoseNothing) {
  client::Client watching;
  ASSERT_TRUE(watching.connect(endpoint("127.0.0.1")).ok());
  FrameAssembler frames;
  watching.set_handler(&frames);
  ASSERT_TRUE(watching.subscribe("main", 50).ok());
  {
    Guest silent(port);
    Guest watcher(port);
    wire::Subscribe subscribe;
    subscribe.set_request_id(2);
    subscribe.set_radar("main");
    subscribe.set_rate_hz(50);
    watcher.send(MessageType::subscribe, subscribe);
    const auto are_here = [&] {
      wire::Status status;
      EXPECT_TRUE(watching.get_status(status).ok());
      return status.clients();
    };
    while (are_here() < 3) next_frame(watching, frames, *daemon);
    swallow("127.0.0.2", true);
  }  // closed, unnoticed
  const auto since = std::chrono::steady_clock::now();
  const auto gone = [&] {
    int lines = 0;
    std::istringstream log(daemon->log());
    for (std::string line; std::getline(log, line);) {
      lines += line.find("127.0.0.2") != std::string::npos && line.find("disconnected") != std::string::npos;
    }
    return lines;
  };
  while (gone() < 2) ASSERT_NO_FATAL_FAILURE(next_frame(watching, frames, *daemon));
  const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - since).count();
  RecordProperty("gone_after_s", std::to_string(took_s));
  std::printf("both were gone %.1f s after the last packet; dead_after_s is 4\n", took_s);
}

// Fails when a client trusts a connection on which nothing comes.
TEST_F(HalfOpen, AClientNoticesANetworkThatSwallowsEverythingAndResumes) {
  int lost = 0;
  client::ResumeOptions options;
  options.on_lost = [&](const client::Status&) {
    ++lost;
    swallow("127.0.0.3", false);  // the network comes back once the client has given the connection up
  };
  client::Client plain;
  ASSERT_TRUE(plain.connect(endpoint("127.0.0.3")).ok());
  client::ResumingClient watching(std::move(plain), options);
  FrameAssembler frames;
  watching.client().set_handler(&frames);
  ASSERT_TRUE(watching.claim_control("main").ok());
  ASSERT_TRUE(watching.subscribe("main", 50).ok());
  const auto receive_frame = [&] {
    while (frames.state() != FrameAssembler::State::complete) {
      // Less than a heartbeat at a time, so that silence is looked at often.
      const client::Status status = watching.receive(client::Timeout(500));
      ASSERT_TRUE(status.ok() || status.outcome == client::Outcome::timed_out) << status.sentence();
    }
    (void)frames.take();
  };
  ASSERT_NO_FATAL_FAILURE(receive_frame());
  swallow("127.0.0.3", true);
  while (lost == 0) {
    const client::Status status = watching.receive(client::Timeout(500));
    ASSERT_TRUE(status.ok() || status.outcome == client::Outcome::timed_out) << status.sentence();
    if (frames.state() == FrameAssembler::State::complete) (void)frames.take();
  }
  // Control as well, which the old connection held for as long as the server believed in it.
  ASSERT_NO_FATAL_FAILURE(receive_frame());
  EXPECT_EQ(lost, 1);
}

}  // namespace
}  // namespace obliq::test::faults_restart_test
