// obliq record: what it leaves behind, whatever ends it.
// What obliq replay makes of a recording: video of I&Q, a track of poses.
#include <gtest/gtest.h>
#include <sys/mount.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <regex>
#include <sstream>

#include "tests/integration/record_fixture.h"

namespace obliq::test::record_test {
namespace {

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
  EXPECT_EQ(outcome.code, 2);
  EXPECT_TRUE(std::regex_search(
      outcome.err,
      std::regex("warning: damaged at offset [0-9]+: CRC mismatch; [0-9]+ bytes skipped; frame [0-9]+ is "
                 "incomplete")))
      << outcome.err;
  EXPECT_NE(outcome.err.find(": 1 frame lost, damaged in 1 place; what is whole has been replayed"),
            std::string::npos)
      << outcome.err;
  EXPECT_EQ(outcome.out.find("nothing left over"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("frame "), std::string::npos) << "the other frame is shown";

  const std::string begun = folder.write("begun.obliq", whole.substr(0, whole.size() / 4));
  outcome = obliq({"replay", begun, "--speed", "max"});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.err.find(begun + ": no frame of radar main is whole, so nothing was replayed"),
            std::string::npos)
      << outcome.err;
  const std::string noise = folder.write("noise.obliq", std::string(100'000, 'x'));
  for (const std::string& path : {scene, noise}) {
    outcome = obliq({"replay", path});
    EXPECT_EQ(outcome.code, 1);
    EXPECT_NE(outcome.err.find("it is not what `obliq record` writes: no frame begins in it; it has 0 whole "
                               "messages"),
              std::string::npos)
        << outcome.err;
  }
  outcome = obliq({"replay", folder / "missing.obliq"});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.err.find("missing.obliq: cannot be read: No such file"), std::string::npos)
      << outcome.err;
  outcome = obliq({"replay", file, "--speed", "0"});
  EXPECT_NE(
      outcome.err.find("--speed: found \"0\"; allowed: 0.01 to 1000000 recorded seconds in a second, or max"),
      std::string::npos)
      << outcome.err;
  outcome = obliq({"replay", file, "--serve", "--address", "0.0.0.0"});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.err.find("server.address: found 0.0.0.0"), std::string::npos) << outcome.err;
  outcome = obliq(record(daemon.address(), {"--out", folder / "other.obliq", "--planes", "iq,colour"}));
  EXPECT_NE(
      outcome.err.find("--planes: found \"iq,colour\"; allowed: one or more of iq, power, count, state"),
      std::string::npos)
      << outcome.err;
}

TEST_F(RecordTest, ASubscriptionThatIsRefusedLeavesNoFileAndAnOlderOneAsItWas) {
  const Daemon daemon({"--config", scene}, folder.path());
  Outcome outcome = obliq(record(daemon.address(), {"--out", file, "--azimuths", "36:"}));
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.err.find("window.first_azimuth"), std::string::npos) << outcome.err;
  EXPECT_FALSE(std::filesystem::exists(file));
  outcome = obliq(record(daemon.address(), {"--out", file, "--frames", "1"}));
  EXPECT_EQ(outcome.code, 0) << "the retry: " << outcome.err;
  const std::string whole = text_of(file);
  EXPECT_EQ(obliq(record(daemon.address(), {"--out", file, "--force", "--azimuths", "36:"})).code, 1);
  EXPECT_TRUE(text_of(file) == whole);
}

TEST_F(RecordTest, VideoAloneIsRecordedReplayedServedAndDrawn) {
  const Daemon daemon({"--config", scene, "--set", "receiver.noise=true", "--set", "radar.power_w=50e3",
                       "--set", "video.looks=4"},
                      folder.path());
  ASSERT_NE(daemon.address(), "") << daemon.log();
  const Outcome recorded =
      obliq(record(daemon.address(), {"--planes", "video", "--out", file, "--frames", "2"}));
  ASSERT_EQ(recorded.code, 0) << recorded.err;
  const auto frames = frames_of(file, wire::plane_bit(wire::Plane::video));
  ASSERT_EQ(frames.size(), 2u);
  // Each frame has noise of its own; the recorder was sent both.
  EXPECT_NE(frames.begin()->second.video, frames.rbegin()->second.video);
  const Outcome shown = obliq({"replay", file, "--out", folder / "shown", "--speed", "max"});
  ASSERT_EQ(shown.code, 0) << shown.err;
  EXPECT_GT(text_of(folder / "shown" / "ground_map.png").size(), 5000u);
  const std::string newest = text_of(folder / "shown" / "video.npy");
  const std::vector<std::uint16_t>& levels = frames.rbegin()->second.video;
  ASSERT_FALSE(levels.empty());
  EXPECT_EQ(newest.substr(newest.size() - levels.size()), std::string(levels.begin(), levels.end()));
  Running replay({"replay", file, "--serve", "--port", "0", "--loop"}, folder / "replay.log");
  const std::string address = replay.await(" on ");
  ASSERT_NE(address, "") << replay.log();
  const Outcome watched =
      obliq({"watch", "--server", address, "--planes", "video", "--frames", "1", "--out", folder / "served"});
  ASSERT_EQ(watched.code, 0) << watched.err;
  const std::string served = text_of(folder / "served" / "video.npy");
  bool is_one = false;
  for (const auto& [id, frame] : frames)
    is_one |= served.substr(served.size() - frame.video.size()) ==
              std::string(frame.video.begin(), frame.video.end());
  EXPECT_TRUE(is_one);
  const Outcome refused = obliq({"get", "--server", address, "--planes", "iq", "--out", folder / "never"});
  EXPECT_NE(refused.code, 0);
}

TEST_F(RecordTest, VideoFollowsFromTheIqThatWasRecorded) {
  const Daemon daemon({"--config", scene}, folder.path());
  ASSERT_EQ(obliq(record(daemon.address(), {"--out", file, "--frames", "1", "--planes", "iq"})).code, 0);
  Running replay({"replay", file, "--serve", "--port", "0", "--loop"}, folder / "replay.log");
  const std::string address = replay.await(" on ");
  for (const std::string bits : {"8", "16"}) {
    for (const std::string& server : {daemon.address(), address}) {
      const Outcome watched = obliq({"watch", "--server", server, "--radar", "main", "--planes", "video",
                                     "--video-bits", bits, "--frames", "1", "--rate", "20", "--out",
                                     folder / (server == address ? "replayed" : "live")});
      ASSERT_EQ(watched.code, 0) << watched.err << replay.log();
    }
    const std::string live = text_of(folder / "live" / "video.npy");
    EXPECT_FALSE(live.empty());
    EXPECT_TRUE(live == text_of(folder / "replayed" / "video.npy")) << bits;
  }
  EXPECT_EQ(replay.end(SIGTERM), 0) << replay.log();
}

TEST_F(RecordTest, TheTrackOfARecordingIsFlownAgain) {
  const Daemon daemon({"--config", scene}, folder.path());
  const std::string track =
      folder.write("flown.csv",
                   "0,33.0,-99.5,1500,20\n1,33.01,-99.49,1600,60\n1.5,33.01,-99.49,1600,60\n"
                   "2,33.02,-99.5,1550,-10\n");
  Running recorder({"record", "--server", daemon.address(), "--radar", "main", "--out", file, "--rate", "20",
                    "--seconds", "60"},
                   folder / "record.log");
  await_size(file, 1000, recorder);
  ASSERT_EQ(obliq({"fly", track, "--server", daemon.address(), "--radar", "main"}).code, 0);
  // The radar follows the track a moment later: until what was flown last is recorded, too.
  const std::string out = folder / "track.csv";
  const auto last_latitude = [&] {
    const Outcome written = obliq({"replay", file, "--track", out});
    EXPECT_EQ(written.code, 0) << written.err;
    EXPECT_NE(written.out.find(" poses of radar main over "), std::string::npos) << written.out;
    const std::string text = text_of(out);
    double time_s = 0, latitude_deg = 0;
    (void)std::sscanf(text.c_str() + text.rfind('\n', text.size() - 2) + 1, "%lf,%lf", &time_s,
                      &latitude_deg);
    return latitude_deg;
  };
  while (last_latitude() < 33.02 - 1e-9 && !recorder.has_ended()) {
  }
  EXPECT_EQ(recorder.end(SIGINT), 0) << recorder.log();

  std::istringstream lines(text_of(out));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line.find("time,latitude,longitude,height,bearing,"), 0u) << line;
  double last_s = -1, latitude = 0, longitude = 0, height = 0, bearing = 0;
  int points = 0, with_velocity = 0;
  while (std::getline(lines, line)) {
    double time_s = 0;
    ASSERT_EQ(
        std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf,%lf", &time_s, &latitude, &longitude, &height, &bearing),
        5)
        << line;
    EXPECT_GT(time_s, last_s);
    last_s = time_s;
    ++points;
    // tilt, height_reference, utc_ns, sim_time_ns and pose_id stand before it. 0.01 degrees and 100 m a
    // second at first; what is flown in a tenth of a second turns by the curve of the parallel, 1e-4 m/s.
    double north = 0, east = 0, up = 0;
    const char* motion = line.c_str();
    for (int i = 0; i < 10; ++i) motion = std::strchr(motion, ',') + 1;
    if (std::sscanf(motion, "%lf,%lf,%lf", &north, &east, &up) == 3 && latitude > 33.0 + 1e-6 &&
        latitude < 33.01 - 1e-6) {
      EXPECT_NEAR(north, 1109.3, 1) << line;
      EXPECT_NEAR(east, 934.5, 1) << line;
      EXPECT_NEAR(up, 100, 0.5) << line;
      ++with_velocity;
    }
    // On the way: longitude and height follow from the latitude.
    if (latitude <= 33.01) {
      EXPECT_NEAR(longitude, -99.5 + (latitude - 33.0), 1e-6) << line;
      EXPECT_NEAR(height, 1500 + (latitude - 33.0) * 10000, 0.01) << line;
    }
  }
  EXPECT_GT(points, 5);
  EXPECT_GT(with_velocity, 0) << text_of(out);
  EXPECT_NEAR(latitude, 33.02, 1e-9);
  EXPECT_NEAR(longitude, -99.5, 1e-9);
  EXPECT_NEAR(height, 1550, 1e-3);
  EXPECT_NEAR(bearing, -10, 1e-6);
  // It is what fly reads, to the same end.
  const Outcome flown =
      obliq({"fly", out, "--server", daemon.address(), "--radar", "main", "--speed", "100"});
  EXPECT_EQ(flown.code, 0) << flown.err;
  EXPECT_EQ(obliq({"replay", file, "--track", folder / "no" / "where.csv"}).code, 1);
}

TEST_F(RecordTest, TheTrackOfAScanningAntennaHasAPoseForEachDwellThatMoved) {
  folder.write("scene.toml", text_of(SmallScene{.server = "[scan]\nmode = \"sector\"\nrate_deg_s = 240.0\n"
                                                          "dwell_bins = 8\n"}));
  const Daemon daemon({"--config", scene}, folder.path());
  Running recorder({"record", "--server", daemon.address(), "--out", file, "--seconds", "60"},
                   folder / "record.log");
  await_size(file, 1000, recorder);
  ASSERT_EQ(obliq({"fly", folder.write("t.csv", "0,33.0,-99.5,1500,20\n1,33.01,-99.5,1500,20\n"), "--server",
                   daemon.address()})
                .code,
            0);
  EXPECT_EQ(recorder.end(SIGINT), 0) << recorder.log();
  const Outcome written = obliq({"replay", file, "--track", "-"});
  ASSERT_EQ(written.code, 0) << written.err;
  // A second has four passes of five dwells; frames alone would be four lines.
  EXPECT_GT(std::ranges::count(written.out, '\n'), 8) << written.out;
}

}  // namespace
}  // namespace obliq::test::record_test
