// obliq record and obliq replay against a real obliqd.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <map>
#include <regex>
#include <thread>

#include "client/client.h"
#include "client/recorded_frames.h"
#include "proto/error_number.h"
#include "proto/obliq.pb.h"
#include "tests/integration/daemon.h"

namespace obliq::test {
namespace {

using client::RecordedFrames;

constexpr client::Timeout kLong{60000};  // reached only when something is broken

constexpr const char* kScene = R"(
[terrain]
synthetic = "ridge"
shape = { distance_m = 5000.0 }
cell_m = 64.0
[antenna]
latitude_deg = 33.0
longitude_deg = -99.5
height_m = 1500.0
bearing_deg = 20.0
[frustum]
pixels = 64
[bins]
azimuth = 36
range = 32
[server]
port = 0
[[radar]]
name = "main"
sector_deg = 60.0
r_min_m = 2000.0
r_max_m = 9000.0
[[radar]]
name = "nose"
sector_deg = 90.0
r_min_m = 2000.0
r_max_m = 9000.0
)";

/// `obliq` in the background, killed by the destructor if it still runs.
class Running {
 public:
  Running(std::vector<std::string> arguments, const std::filesystem::path& log) : log_(log) {
    arguments.insert(arguments.begin(), OBLIQ_PROGRAM);
    std::vector<char*> argv;
    for (std::string& word : arguments) argv.push_back(word.data());
    argv.push_back(nullptr);
    pid_ = fork();
    if (pid_ != 0) return;
    const int fd = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    dup2(fd, STDOUT_FILENO);
    dup2(fd, STDERR_FILENO);
    execv(OBLIQ_PROGRAM, argv.data());
    _exit(127);
  }
  ~Running() {
    if (pid_ > 0) (void)end(SIGKILL);
  }
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;

  int end(int signal) {
    kill(pid_, signal);
    return wait();
  }
  int wait() {
    int status = 0;
    waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }
  bool has_ended() const {
    siginfo_t info{};
    return waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT) == 0 &&
           info.si_pid != 0;
  }
  std::string log() const { return text_of(log_); }
  /// What follows `before` in its output, as soon as there is a line with it.
  std::string await(const std::string& before) const {
    for (;;) {
      const std::string text = log();
      const std::size_t at = text.find(before);
      const std::size_t end = at == std::string::npos ? at : text.find('\n', at);
      if (end != std::string::npos) return text.substr(at + before.size(), end - at - before.size());
      if (has_ended()) return {};
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }

 private:
  std::filesystem::path log_;
  pid_t pid_ = -1;
};

class RecordTest : public testing::Test {
 protected:
  Outcome obliq(const std::vector<std::string>& arguments) const {
    return run_program(OBLIQ_PROGRAM, arguments, folder.path());
  }
  std::vector<std::string> record(const std::string& address, std::vector<std::string> more) const {
    std::vector<std::string> all = {"record", "--server", address, "--radar", "main", "--rate", "50"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  /// Waits until the file has so many bytes, or the recorder has ended.
  static void await_size(const std::filesystem::path& file, std::uintmax_t bytes, const Running& recorder) {
    std::error_code none;
    while (!recorder.has_ended()) {
      const auto size = std::filesystem::file_size(file, none);
      if (!none && size >= bytes) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }

  TestFolder folder;
  std::string scene = folder.write("scene.toml", kScene);
  std::string file = folder / "main.obliq";
};

/// All frames of a recording by number.
std::map<std::uint64_t, client::AssembledFrame> frames_of(const std::string& file) {
  std::map<std::uint64_t, client::AssembledFrame> all;
  std::unique_ptr<client::RecordingReader> reader;
  EXPECT_TRUE(client::RecordingReader::open(file, reader).ok());
  RecordedFrames frames(std::move(reader), "main", wire::kAllPlanes);
  client::RecordedFrame recorded;
  for (auto found = frames.next(recorded); found != RecordedFrames::Found::end;
       found = frames.next(recorded)) {
    if (found != RecordedFrames::Found::frame) continue;
    all[recorded.frame.descriptor->frame_id()] = std::move(recorded.frame);
  }
  return all;
}

TEST_F(RecordTest, ReplayWritesTheFilesOfTheRadarThatWasRecordedBitForBit) {
  const Daemon daemon({"--config", scene}, folder.path());
  ASSERT_NE(daemon.address(), "") << daemon.log();
  const Outcome recorded = obliq(record(daemon.address(), {"--out", file, "--frames", "3"}));
  ASSERT_EQ(recorded.code, 0) << recorded.err;
  EXPECT_NE(recorded.out.find("radar main, 3 frames"), std::string::npos) << recorded.out;

  const Outcome replayed = obliq({"replay", file, "--speed", "max", "--out", folder / "replayed"});
  ASSERT_EQ(replayed.code, 0) << replayed.err;
  EXPECT_EQ(replayed.err, "");
  EXPECT_NE(replayed.out.find("3 frames, "), std::string::npos) << replayed.out;
  EXPECT_NE(replayed.out.find(std::to_string(std::filesystem::file_size(file)) + " bytes, nothing left over"),
            std::string::npos)
      << replayed.out;
  ASSERT_EQ(obliq({"render", scene, "--radar", "main", "--out", folder / "rendered"}).code, 0);
  for (const char* name :
       {"bins.npy", "power.npy", "count.npy", "state.npy", "ground_map.png", "ground_map.tif"}) {
    EXPECT_TRUE(text_of(folder / "rendered" / name) == text_of(folder / "replayed" / name)) << name;
  }
}

TEST_F(RecordTest, ReplayServesTheFramesToAClientBitForBitAndRefusesWhatOnlyARadarCan) {
  {
    const Daemon daemon({"--config", scene}, folder.path());
    ASSERT_EQ(obliq(record(daemon.address(), {"--out", file, "--frames", "4"})).code, 0);
  }
  auto expected = frames_of(file);
  ASSERT_EQ(expected.size(), 4u);

  Running replay({"replay", file, "--serve", "--port", "0"}, folder / "replay.log");
  const std::string address = replay.await(" on ");
  ASSERT_NE(address, "") << replay.log();
  client::Client client;
  ASSERT_TRUE(client.connect(*client::parse_endpoint(address)).ok());
  ASSERT_EQ(client.welcome().radars_size(), 1);
  EXPECT_EQ(client.welcome().radars(0), "main");
  wire::RadarInfo info;
  ASSERT_TRUE(client.get_radar("main", info).ok());
  EXPECT_EQ(info.settings().azimuth_bins(), 36);
  EXPECT_EQ(info.pose().bearing_deg(), 20);

  const auto only = static_cast<std::uint32_t>(wire::ErrorNumber::replay_only);
  wire::Ack ack;
  wire::RenderOnce once;
  once.mutable_pose()->set_latitude_deg(33);
  EXPECT_EQ(client.claim_control("main").number, only);
  EXPECT_EQ(client.set_settings("main", {}, ack).number, only);
  EXPECT_EQ(client.set_pose("main", {}, ack).number, only);
  const client::Status refused = client.render_once(once);
  EXPECT_EQ(refused.number, only);
  EXPECT_NE(refused.text.find("replays a recording"), std::string::npos) << refused.text;

  client::FrameAssembler frames;
  client.set_handler(&frames);
  ASSERT_TRUE(client.subscribe("main", 100).ok());
  std::size_t seen = 0;
  client::Status status;
  while ((status = client.receive(kLong)).ok()) {
    if (frames.state() == client::FrameAssembler::State::aborted) (void)frames.take();
    if (frames.state() != client::FrameAssembler::State::complete) continue;
    const client::AssembledFrame got = frames.take();
    ++seen;
    // A machine that is busy may leave frames out, as with a radar; those that come are the recorded ones.
    const auto at = std::find_if(expected.begin(), expected.end(), [&](const auto& one) {
      return one.second.power_w == got.power_w && one.second.iq == got.iq;
    });
    ASSERT_NE(at, expected.end());
    EXPECT_EQ(got.count, at->second.count);
    EXPECT_EQ(got.state, at->second.state);
    EXPECT_EQ(got.descriptor->pose().SerializeAsString(), at->second.descriptor->pose().SerializeAsString());
  }
  EXPECT_GE(seen, 1u);
  // The recording's end is the server's.
  EXPECT_EQ(status.number, static_cast<std::uint32_t>(wire::ErrorNumber::server_stopping)) << status.text;
  EXPECT_EQ(replay.wait(), 0) << replay.log();
}

TEST_F(RecordTest, PlanesThatWereNotRecordedAreNotServed) {
  const Daemon daemon({"--config", scene}, folder.path());
  ASSERT_EQ(obliq(record(daemon.address(), {"--out", file, "--frames", "1", "--planes", "iq,state"})).code,
            0);
  Running replay({"replay", file, "--serve", "--port", "0", "--loop"}, folder / "replay.log");
  const std::string address = replay.await(" on ");
  client::Client client;
  ASSERT_TRUE(client.connect(*client::parse_endpoint(address)).ok()) << replay.log();
  const client::Status refused = client.subscribe("main", 10);
  ASSERT_EQ(refused.fields.size(), 1u) << refused.text;
  EXPECT_EQ(refused.fields[0].allowed, "iq, state");
  const auto planes =
      static_cast<wire::PlaneSet>(wire::plane_bit(wire::Plane::iq) | wire::plane_bit(wire::Plane::state));
  client::FrameAssembler frames(planes);
  client.set_handler(&frames);
  ASSERT_TRUE(client.subscribe("main", 10, planes).ok());
  while (frames.state() != client::FrameAssembler::State::complete) ASSERT_TRUE(client.receive(kLong).ok());
  EXPECT_EQ(replay.end(SIGTERM), 0) << replay.log();
}

TEST_F(RecordTest, AnInterruptEndsTheRecordingBetweenTwoFrames) {
  const Daemon daemon({"--config", scene}, folder.path());
  for (const int signal : {SIGINT, SIGTERM}) {
    std::filesystem::remove(file);
    Running recorder(record(daemon.address(), {"--out", file}), folder / "record.log");
    await_size(file, 100'000, recorder);
    EXPECT_EQ(recorder.end(signal), 0) << recorder.log();
    const Outcome replayed = obliq({"replay", file, "--speed", "max"});
    EXPECT_EQ(replayed.code, 0) << replayed.err;
    EXPECT_NE(replayed.out.find("nothing left over"), std::string::npos) << replayed.out << replayed.err;
  }
}

TEST_F(RecordTest, ARecorderThatIsKilledLosesAtMostTheMessageInHand) {
  const Daemon daemon({"--config", scene}, folder.path());
  Running recorder(record(daemon.address(), {"--out", file}), folder / "record.log");
  await_size(file, 200'000, recorder);
  EXPECT_EQ(recorder.end(SIGKILL), -SIGKILL) << recorder.log();
  std::unique_ptr<client::RecordingReader> reader;
  ASSERT_TRUE(client::RecordingReader::open(file, reader).ok());
  while (reader->next() == client::RecordingReader::Found::message) {
  }
  // Less than one block of the scene's frames is left over.
  EXPECT_LT(reader->fault().bytes, 8 * 32 * 8 + 1000u);
  EXPECT_GE(reader->offset() + reader->fault().bytes, 200'000u);
  const Outcome replayed = obliq({"replay", file, "--speed", "max"});
  EXPECT_EQ(replayed.code, 0) << replayed.err;
}

TEST_F(RecordTest, ADiskThatIsFullEndsTheRecordingWithItsLastWholeMessage) {
  const std::string disk = folder / "disk";
  std::filesystem::create_directory(disk);
  if (mount("none", disk.c_str(), "tmpfs", 0, "size=128k") != 0) {
    GTEST_SKIP() << "a small file system can be mounted by root only; RecordingFile has the file size limit";
  }
  const std::string full = disk + "/main.obliq";
  const Daemon daemon({"--config", scene}, folder.path());
  const Outcome recorded = obliq(record(daemon.address(), {"--out", full}));
  EXPECT_EQ(recorded.code, 1) << recorded.out;
  EXPECT_NE(recorded.err.find("No space left"), std::string::npos) << recorded.err;
  std::unique_ptr<client::RecordingReader> reader;
  ASSERT_TRUE(client::RecordingReader::open(full, reader).ok());
  while (reader->next() == client::RecordingReader::Found::message) {
  }
  EXPECT_EQ(reader->fault().bytes, 0u);
  EXPECT_GT(reader->messages(), 10u);
  reader.reset();
  EXPECT_EQ(obliq({"replay", full, "--speed", "max"}).code, 0);
  EXPECT_EQ(umount(disk.c_str()), 0);
}

TEST_F(RecordTest, WhatIsWrongWithARecordingIsSaidInALine) {
  const Daemon daemon({"--config", scene}, folder.path());
  ASSERT_EQ(obliq(record(daemon.address(), {"--out", file, "--frames", "2"})).code, 0);
  const std::string whole = text_of(file);

  Outcome outcome = obliq(record(daemon.address(), {"--out", file, "--frames", "1"}));
  EXPECT_EQ(outcome.code, 1);
  EXPECT_EQ(outcome.err, "obliq: --out: " + file + ": exists already; --force overwrites it\n");
  EXPECT_TRUE(text_of(file) == whole);
  EXPECT_EQ(obliq(record(daemon.address(), {"--out", file, "--frames", "1", "--force"})).code, 0);

  const std::string cut = folder.write("cut.obliq", whole.substr(0, whole.size() - 5));
  outcome = obliq({"replay", cut, "--speed", "max"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_TRUE(std::regex_search(
      outcome.err,
      std::regex("warning: cut at offset " + std::to_string(whole.size() - 5) +
                 ": the last [0-9]+ bytes, from offset [0-9]+, are no whole message; frame [0-9]+ is "
                 "incomplete, 100 % of it arrived\n")))
      << outcome.err;

  std::string wrong = whole;
  wrong[wrong.size() / 4] = static_cast<char>(wrong[wrong.size() / 4] ^ 1);
  outcome = obliq({"replay", folder.write("wrong.obliq", wrong), "--speed", "max"});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_TRUE(std::regex_search(
      outcome.err,
      std::regex("warning: damaged at offset [0-9]+: CRC mismatch; [0-9]+ bytes skipped; frame [0-9]+ is "
                 "incomplete")))
      << outcome.err;
  EXPECT_NE(outcome.err.find("is damaged; what could be read has been replayed"), std::string::npos);
  EXPECT_NE(outcome.out.find("frame "), std::string::npos) << "the other frame is shown";

  outcome = obliq({"replay", scene});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.err.find("no frame begins in it; it has 0 whole messages"), std::string::npos)
      << outcome.err;
  outcome = obliq({"replay", folder / "missing.obliq"});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.err.find("missing.obliq: cannot be read: No such file"), std::string::npos)
      << outcome.err;
  outcome = obliq({"replay", file, "--speed", "0"});
  EXPECT_NE(outcome.err.find("--speed: found \"0\"; allowed: 0.01 to 1000000, or max"), std::string::npos)
      << outcome.err;
  outcome = obliq({"replay", file, "--serve", "--address", "0.0.0.0"});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.err.find("allowed: a loopback address"), std::string::npos) << outcome.err;
  outcome = obliq(record(daemon.address(), {"--out", folder / "other.obliq", "--planes", "iq,colour"}));
  EXPECT_NE(
      outcome.err.find("--planes: found \"iq,colour\"; allowed: one or more of iq, power, count, state"),
      std::string::npos)
      << outcome.err;
}

}  // namespace
}  // namespace obliq::test
