// `obliq fly`: a radar along a track from a file or a pipe, against a real daemon.
#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <thread>

#include "client/client.h"
#include "proto/obliq.pb.h"
#include "tests/integration/daemon.h"

namespace obliq::test {
namespace {

/// What a track that cannot be read is refused with; no server is needed to hear it.
TEST(FlyTrack, BadLinesAreNamedBeforeAnythingMoves) {
  const TestFolder folder;
  const std::string good = "0,33,-99.5,1500,10\n";
  const struct {
    std::string text;
    std::string says;
  } cases[] = {
      {"", "track.csv: found no pose; allowed: lines of time,latitude,longitude,height,bearing"},
      {"time,lat,lon,height,bearing\n# nothing\n\n", "found no pose"},
      {good + "1,33,-99.5,1500,x\n", "track.csv:2: bearing: found \"x\"; allowed: number -360 to 360 deg"},
      {good + "1,nan,-99.5,1500,10\n", "track.csv:2: latitude: found \"nan\"; allowed: number -90 to 90 deg"},
      {good + "1,33,inf,1500,10\n", "longitude: found \"inf\""},
      {good + "1,33,-99.5,1e9,10\n", "height: found \"1e9\"; allowed: number -1000 to 100000 m"},
      {good + "1e10,33,-99.5,1500,10\n", "time: found \"1e10\"; allowed: number -4e9 to 4e9 s"},
      {good + "1,33,-99.5,,10\n", "height: found \"\""},
      {good + "1,33,-99.5\n", "track.csv:2: found 3 columns; allowed: time,latitude"},
      {good + "1;33;-99.5;1500;10\n", "time: found \"1;33;-99.5;1500;10\""},
      {"5,33,-99.5,1500,10\n4,33,-99.5,1500,10\n",
       "track.csv:2: time: found 4.0 after 5.0; allowed: a time "
       "that does not go back"},
      {good + "time,latitude,longitude,height,bearing\n", "track.csv:2: time: found \"time\""},
      {"time,lon,lat,height,bearing\n" + good,
       "track.csv:1: column 2: found \"lon\"; allowed: a number, or a "
       "header of time,latitude,longitude,height,bearing"},
      {"time,lat,lon,heading,height\n" + good, "column 4: found \"heading\""},
      {std::string("\x7f"
                   "ELF\2\1\0\0",
                   8),
       "track.csv:1: column 1: found neither; allowed: a number, or a header"},
      {"1,secret\n", "track.csv:1: latitude: found no number; allowed: number -90 to 90 deg"},
      {std::string(1000000, '7'), "track.csv:1: found a line of more than 4096 characters"},
  };
  for (const auto& [text, says] : cases) {
    const Outcome outcome = run_program(
        OBLIQ_PROGRAM, {"fly", folder.write("track.csv", text), "--server", "127.0.0.1:1"}, folder.path());
    EXPECT_EQ(outcome.code, 1);
    EXPECT_NE(outcome.err.find(says), std::string::npos) << says << "\nin: " << outcome.err;
    EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
  }
  for (const auto& [file, says] : {std::pair{(folder / "none.csv").string(), "No such file"},
                                   std::pair{folder.path().string(), "found a folder"}}) {
    const Outcome outcome = run_program(OBLIQ_PROGRAM, {"fly", file}, folder.path());
    EXPECT_EQ(outcome.code, 1);
    EXPECT_NE(outcome.err.find(says), std::string::npos) << outcome.err;
  }
  for (const char* speed : {"0", "-1", "nan", "fast"}) {
    const Outcome outcome =
        run_program(OBLIQ_PROGRAM, {"fly", folder.write("track.csv", good), "--speed", speed}, folder.path());
    EXPECT_EQ(outcome.code, 1);
    EXPECT_NE(outcome.err.find("--speed"), std::string::npos) << outcome.err;
  }
}

class Fly : public testing::Test {
 protected:
  Fly() {
    SmallScene scene;
    scene.antenna = "latitude_deg = 33.0\nlongitude_deg = -99.5\n";
    daemon = std::make_unique<Daemon>(
        std::vector<std::string>{"--config", folder.write("scene.toml", text_of(scene)), "--port", "0"},
        folder.path());
    EXPECT_TRUE(client.connect(*client::parse_endpoint(daemon->address())).ok()) << daemon->log();
  }
  Outcome fly(const std::string& track, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"fly", folder.write("track.csv", track), "--server",
                                       daemon->address()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_program(OBLIQ_PROGRAM, arguments, folder.path());
  }
  wire::RadarInfo info() {
    wire::RadarInfo found;
    EXPECT_TRUE(client.get_radar("main", found).ok());
    return found;
  }

  TestFolder folder;
  std::unique_ptr<Daemon> daemon;
  client::Client client;
};

TEST_F(Fly, ATrackIsFlownToItsEndInItsOwnClockAndTheRadarIsReleased) {
  const Outcome outcome =
      fly("Time [s], Latitude, Longitude, Height, Heading, remark\r\n"
          "100.0, 33.00, -99.50, 1500, 350, a\r\n"
          "# a comment\r\n\r\n"
          "100.5, 33.01, -99.49, 1550, 10, b, c\r\n",
          {"--rate", "20"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("main: flown after 11 poses"), std::string::npos) << outcome.out;
  const wire::RadarInfo after = info();
  EXPECT_DOUBLE_EQ(after.pose().latitude_deg(), 33.01);
  EXPECT_DOUBLE_EQ(after.pose().longitude_deg(), -99.49);
  EXPECT_DOUBLE_EQ(after.pose().height_m(), 1550);
  EXPECT_DOUBLE_EQ(after.pose().bearing_deg(), 10);
  EXPECT_EQ(after.pose().sim_time_ns(), 100'500'000'000);
  EXPECT_EQ(after.pose().pose_id(), 11u) << "the two lines and nine between them";
  EXPECT_EQ(after.late_poses(), 0u);
  EXPECT_EQ(after.controller(), "");
}

TEST_F(Fly, WithoutARateTheLinesAloneAreSentAndSpeedDividesTheirTimes) {
  const Outcome outcome =
      fly("0,33,-99.5,1500,0\n20,33.01,-99.5,1500,0\n", {"--rate", "0", "--speed", "100"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(info().pose().pose_id(), 2u);
  EXPECT_EQ(info().pose().sim_time_ns(), 200'000'000);
}

TEST_F(Fly, APoseThatTheServerRefusesEndsTheFlightAndNamesItsLine) {
  const Outcome outcome = fly("0,33,-99.5,1500,0\n0.1,33,-99.5,-900,0\n0.2,33,-99.5,1500,0\n");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.err.find("track.csv:2: pose refused"), std::string::npos) << outcome.err;
  while (!info().controller().empty()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_EQ(info().pose().height_m(), 1500);
}

TEST_F(Fly, AnInterruptEndsTheFlightInOrderAndReleasesTheRadar) {
  const std::string track = folder.write("track.csv", "0,33,-99.5,1500,0\n3600,33.1,-99.5,1500,90\n");
  Running flight({"fly", track, "--server", daemon->address()}, folder / "fly.log");
  while (info().pose().pose_id() < 2 && !flight.has_ended())
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_NE(info().controller().find("obliq fly"), std::string::npos);
  EXPECT_EQ(flight.end(SIGINT), 0) << flight.log();
  EXPECT_NE(flight.log().find("main: interrupted after"), std::string::npos) << flight.log();
  EXPECT_EQ(info().controller(), "");
}

TEST_F(Fly, APipeIsFlownAsItsLinesCome) {
  const std::string pipe = folder / "pipe";
  ASSERT_EQ(std::system(("mkfifo " + pipe).c_str()), 0);
  Running flight({"fly", pipe, "--server", daemon->address(), "--height-reference", "ground"},
                 folder / "fly.log");
  std::ofstream lines(pipe);
  lines << "0,33,-99.5,500,0\n" << std::flush;
  while (info().pose().pose_id() < 1 && !flight.has_ended())
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_EQ(info().pose().height_reference(), wire::GROUND);
  lines << "0.1,33.001,-99.5,500,0\nnonsense\n" << std::flush;
  EXPECT_EQ(flight.wait(), 1);
  EXPECT_NE(flight.log().find("pipe:3: time: found \"nonsense\""), std::string::npos) << flight.log();
  EXPECT_DOUBLE_EQ(info().pose().latitude_deg(), 33.001);
}

}  // namespace
}  // namespace obliq::test
