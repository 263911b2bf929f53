// `obliq set`: live settings of a radar from the command line, against a real daemon.
// `obliq fly`: a radar along a track from a file or a pipe, against a real daemon.
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <future>
#include <nlohmann/json.hpp>
#include <thread>

#include "proto/obliq.pb.h"
#include "tests/integration/clients.h"
#include "tests/integration/daemon.h"

namespace obliq::test::set_test {
namespace {

class SetCommand : public ProgramTest {
 protected:
  Outcome obliq(const std::vector<std::string>& arguments) {
    return ProgramTest::obliq(arguments, {"--server", daemon.address()});
  }
  wire::RadarInfo info(const std::string& radar = "nose") {
    client::Client client = connected(daemon.address());
    wire::RadarInfo found;
    EXPECT_TRUE(client.get_radar(radar, found).ok());
    return found;
  }
  /// Refused: one line with `part`, and nothing has changed.
  void expect_refused(const std::vector<std::string>& settings, const std::string& part) {
    const std::string before = info().SerializeAsString();
    std::vector<std::string> arguments{"set", "--radar", "nose"};
    arguments.insert(arguments.end(), settings.begin(), settings.end());
    const Outcome outcome = obliq(arguments);
    EXPECT_EQ(outcome.code, 1) << outcome.out;
    EXPECT_NE(outcome.err.find(part), std::string::npos) << part << "\nin: " << outcome.err;
    EXPECT_EQ(outcome.out, "");
    wire::RadarInfo after = info();
    EXPECT_EQ(after.controller(), "");
    EXPECT_EQ(after.SerializeAsString(), before) << after.DebugString();
  }

  Daemon daemon{{"--config", folder.write("scene.toml", text_of(SmallScene{.radars = kTwoRadars}))},
                folder.path()};
};

TEST_F(SetCommand, WatchSaysThatASilentRadarSendsNothing) {
  ASSERT_EQ(obliq({"set", "--transmit", "off", "--radar", "nose"}).code, 0);
  std::filesystem::create_directories(folder / "watch");
  auto watch = std::async(std::launch::async, [&] {
    return run_program(OBLIQ_PROGRAM,
                       {"watch", "--server", daemon.address(), "--radar", "nose", "--frames", "1"},
                       folder / "watch");
  });
  const auto said = [&] {
    return text_of(folder / "watch/err").find("transmit is off") != std::string::npos;
  };
  while (!said() && watch.wait_for(std::chrono::milliseconds(10)) != std::future_status::ready) {
  }
  EXPECT_TRUE(said());
  ASSERT_EQ(obliq({"set", "--transmit", "on", "--radar", "nose"}).code, 0);
  EXPECT_EQ(watch.get().code, 0);
}

TEST_F(SetCommand, SeveralKeysChangeAtOnceAndTheOtherRadarStays) {
  const Outcome outcome =
      obliq({"set", "radar.r_max_m=8000", "bins.range=16", "frustum.quality=draft", "--radar", "nose"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("radar.r_max_m = 8000.0"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("# was 9000.0"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("# nose: settings 2"), std::string::npos) << outcome.out;
  const wire::RadarInfo nose = info();
  EXPECT_EQ(nose.settings().r_max_m(), 8000);
  EXPECT_EQ(nose.settings().range_bins(), 16);
  EXPECT_EQ(nose.settings().frustum(), wire::SWEEP);
  EXPECT_EQ(nose.settings().r_min_m(), 2000);
  EXPECT_EQ(nose.settings_version(), 2u);
  EXPECT_EQ(nose.controller(), "") << "control is given back";
  EXPECT_EQ(info("main").settings_version(), 1u);
}

TEST_F(SetCommand, LengthsAndSpeedsMayNameTheirUnit) {
  ASSERT_EQ(obliq({"set", "--radar", "nose", "radar.r_max_m=5nmi", "radar.r_min_m=0.5 km"}).code, 0);
  EXPECT_EQ(info().settings().r_max_m(), 9260);
  EXPECT_EQ(info().settings().r_min_m(), 500);
  ASSERT_EQ(obliq({"pose", "--radar", "nose", "--height", "9842ft"}).code, 0);
  EXPECT_DOUBLE_EQ(info().pose().height_m(), 9842 * 0.3048);
  ASSERT_EQ(obliq({"pose", "--radar", "nose", "--set", "antenna.velocity_north_m_s=100kt", "--set",
                   "antenna.velocity_up_m_s=-36 km/h", "--roll", "12"})
                .code,
            0);
  EXPECT_DOUBLE_EQ(info().pose().velocity_north_m_s(), 100 * 1852.0 / 3600);
  EXPECT_DOUBLE_EQ(info().pose().velocity_up_m_s(), -10);
  EXPECT_EQ(info().pose().roll_deg(), 12);
  ASSERT_EQ(obliq({"pose", "--radar", "nose", "--set", "antenna.velocity_north_m_s=auto"}).code, 0);
  EXPECT_FALSE(info().pose().has_velocity_up_m_s());
  EXPECT_EQ(info().pose().roll_deg(), 12);
  const Outcome knots = obliq({"pose", "--radar", "nose", "--set", "antenna.velocity_east_m_s=5nmi"});
  EXPECT_NE(knots.err.find("antenna.velocity_east_m_s: found 5nmi; allowed: \"auto\" or a number -20000 to "
                           "20000 m/s; or with a unit: m/s, kt, km/h"),
            std::string::npos)
      << knots.err;
  expect_refused({"radar.r_max_m=5yd"},
                 "radar.r_max_m: found 5yd; allowed: number above 0, at most 500000 m; "
                 "or with a unit: m, km, ft, nmi");
  expect_refused({"radar.sector_deg=5km"},
                 "radar.sector_deg: found 5km; allowed: number above 0, at most 360 deg");
  expect_refused({"radar.r_max_m=1e999km"}, "radar.r_max_m: found");
  expect_refused({"radar.r_max_m=nan ft"}, "radar.r_max_m: found");
}

TEST_F(SetCommand, PlanesFollowTheBinsUnlessColumnsAreNamed) {
  ASSERT_EQ(obliq({"set", "frustum.quality=standard", "bins.azimuth=48", "--radar", "nose"}).code, 0);
  EXPECT_EQ(info().settings().planes_per_bin(), 2);
  EXPECT_EQ(info().settings().pixel_columns(), 96);
  ASSERT_EQ(obliq({"set", "bins.azimuth=64", "--radar", "nose"}).code, 0);
  EXPECT_EQ(info().settings().pixel_columns(), 128) << "twice the bins still: standard, not draft";
  ASSERT_EQ(obliq({"set", "frustum.planes_per_bin=5", "--radar", "nose"}).code, 0);
  EXPECT_EQ(info().settings().pixel_columns(), 320);
  ASSERT_EQ(obliq({"set", "frustum.pixel_columns=100", "--radar", "nose"}).code, 0);
  EXPECT_EQ(info().settings().pixel_columns(), 100);
  EXPECT_EQ(info().settings().planes_per_bin(), 0);
  expect_refused({"frustum.planes_per_bin=1025"}, "allowed: integer 0 to 1024");
}

TEST_F(SetCommand, TransmitAndFreezeAreSwitched) {
  ASSERT_EQ(obliq({"set", "--transmit", "off", "--radar", "nose"}).code, 0);
  EXPECT_TRUE(info().transmit_off());
  EXPECT_FALSE(info().frozen());
  const Outcome both = obliq({"set", "--transmit", "on", "--freeze", "on", "--radar", "nose"});
  ASSERT_EQ(both.code, 0) << both.err;
  EXPECT_NE(both.out.find("frozen: frames keep older settings"), std::string::npos) << both.out;
  EXPECT_TRUE(info().frozen());
  EXPECT_FALSE(info().transmit_off());
  const Outcome status = obliq({"status", "--radar", "nose"});
  EXPECT_NE(status.out.find("frozen"), std::string::npos) << status.out;
  const Outcome again = obliq({"set", "--freeze", "on", "--radar", "nose"});
  EXPECT_NE(again.out.find("was so already"), std::string::npos) << again.out;
  ASSERT_EQ(obliq({"set", "--freeze", "off", "--radar", "nose"}).code, 0);
  EXPECT_FALSE(info().frozen());
}

TEST_F(SetCommand, WithoutASettingItShowsWhatIsInEffect) {
  const Outcome text = obliq({"set", "--radar", "nose"});
  ASSERT_EQ(text.code, 0) << text.err;
  for (const char* line : {"transmit = \"on\"", "radar.r_max_m = 9000.0", "# m\n", "bins.range = 32",
                           "scan.mode = \"frame\"", "antenna.bearing_deg = "})
    EXPECT_NE(text.out.find(line), std::string::npos) << line << "\nin: " << text.out;
  const Outcome outcome = obliq({"set", "--radar", "nose", "--json"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["radar"], "nose");
  EXPECT_EQ(json["transmit"], true);
  EXPECT_EQ(json["settings"]["radar.r_max_m"], 9000.0);
  EXPECT_EQ(json["settings"]["scan.mode"], "frame");
  EXPECT_TRUE(json["pose"].contains("antenna.latitude_deg"));
  EXPECT_EQ(info().settings_version(), 1u);
}

TEST_F(SetCommand, WhatCannotBeSetIsRefusedAndChangesNothing) {
  expect_refused({"radar.r_max_m=8000", "radar.r_mx_m=3"}, "did you mean radar.r_max_m?");
  expect_refused({"radar.r_max_m=8000", "terrain.cell_m=10"}, "set terrain.cell_m: belongs to the scene");
  expect_refused({"server.port=10"}, "reads when it starts");
  expect_refused({"antenna.height_m=10"}, "obliq pose --set antenna.height_m=VALUE");
  expect_refused({"radar.r_max_m"}, "allowed: KEY=VALUE");
  expect_refused({"radar.r_max_m=nan"}, "radar.r_max_m: found nan");
  expect_refused({"radar.r_max_m=8000", "radar.sector_deg=400"}, "allowed: number above 0, at most 360 deg");
  expect_refused({"bins.range=many"}, "bins.range: found many; allowed: integer 1 to 8192");
  expect_refused({"--transmit", "perhaps"}, "--transmit: found \"perhaps\"; allowed: on, off");
  expect_refused({"--freeze"}, "--freeze");
  expect_refused({""}, "allowed: KEY=VALUE");
}

TEST_F(SetCommand, ARadarThatSomebodyElseControlsIsLeftAloneAndHisNameIsSaid) {
  client::Client pilot = connected(daemon.address(), "pilot");
  ASSERT_TRUE(pilot.claim_control("nose").ok());
  const Outcome outcome = obliq({"set", "radar.r_max_m=8000", "--radar", "nose"});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.err.find("held by pilot"), std::string::npos) << outcome.err;
  EXPECT_EQ(info().settings().r_max_m(), 9000);
  EXPECT_EQ(obliq({"set", "--radar", "nose"}).code, 0) << "looking needs no control";
}

TEST_F(SetCommand, OtherCommandsPointAtTheRightOne) {
  const Outcome pose = obliq({"pose", "--radar", "nose", "--set", "radar.r_max_m=8000"});
  EXPECT_EQ(pose.code, 1);
  EXPECT_NE(pose.err.find("obliq set radar.r_max_m=VALUE"), std::string::npos) << pose.err;
  const Outcome get =
      obliq({"get", "--radar", "nose", "--out", folder / "frame", "--set", "scan.mode=sector"});
  EXPECT_EQ(get.code, 1);
  EXPECT_NE(get.err.find("--set scan.mode: a frame on request takes no notice of it"), std::string::npos)
      << get.err;
}

/// What a track that cannot be read is refused with; no server is needed to hear it.
using FlyTrack = ProgramTest;

TEST_F(FlyTrack, BadLinesAreNamedBeforeAnythingMoves) {
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
    const Outcome outcome = obliq({"fly", folder.write("track.csv", text), "--server", "127.0.0.1:1"});
    EXPECT_EQ(outcome.code, 1);
    EXPECT_NE(outcome.err.find(says), std::string::npos) << says << "\nin: " << outcome.err;
    EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
  }
  for (const auto& [file, says] : {std::pair{(folder / "none.csv").string(), "No such file"},
                                   std::pair{folder.path().string(), "found a folder"}}) {
    const Outcome outcome = obliq({"fly", file});
    EXPECT_EQ(outcome.code, 1);
    EXPECT_NE(outcome.err.find(says), std::string::npos) << outcome.err;
  }
  for (const char* speed : {"0", "-1", "nan", "fast"}) {
    const Outcome outcome = obliq({"fly", folder.write("track.csv", good), "--speed", speed});
    EXPECT_EQ(outcome.code, 1);
    EXPECT_NE(outcome.err.find("--speed"), std::string::npos) << outcome.err;
  }
}

class Fly : public ProgramTest {
 protected:
  Outcome fly(const std::string& track, const std::vector<std::string>& more = {}) {
    return obliq({"fly", folder.write("track.csv", track), "--server", daemon.address()}, more);
  }
  wire::RadarInfo info() {
    wire::RadarInfo found;
    EXPECT_TRUE(client.get_radar("main", found).ok());
    return found;
  }

  const SmallScene scene{.antenna = "latitude_deg = 33.0\nlongitude_deg = -99.5\n"};
  Daemon daemon{{"--config", folder.write("scene.toml", text_of(scene))}, folder.path()};
  client::Client client = connected(daemon.address());
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
  Running flight({"fly", track, "--server", daemon.address()}, folder / "fly.log");
  while (info().pose().pose_id() < 2 && !flight.has_ended())
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_NE(info().controller().find("obliq fly"), std::string::npos);
  EXPECT_EQ(flight.end(SIGINT), 0) << flight.log();
  EXPECT_NE(flight.log().find("main: interrupted after"), std::string::npos) << flight.log();
  EXPECT_EQ(info().controller(), "");
}

TEST_F(Fly, KnobsAndTiltAreTurnedWhileItFlies) {
  const std::string track = folder.write("track.csv", "0,33,-99.5,1500,0\n3600,33.1,-99.5,1500,90\n");
  Running flight({"fly", track, "--server", daemon.address()}, folder / "fly.log");
  const auto fly_on = [&] {
    for (const std::uint64_t from = info().pose().pose_id();
         info().pose().pose_id() < from + 2 && !flight.has_ended();)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
  };
  fly_on();
  const std::vector<std::string> to_server{"--server", daemon.address()};
  const Outcome set =
      obliq({"set", "receiver.gain_db=6", "antenna.tilt_deg=-5", "antenna.bearing_deg=30"}, to_server);
  EXPECT_EQ(set.code, 0) << set.err;
  EXPECT_NE(set.out.find("receiver.gain_db = 6.0"), std::string::npos) << set.out;
  EXPECT_NE(set.out.find("antenna.tilt_deg = -5.0"), std::string::npos) << set.out;
  EXPECT_EQ(obliq({"set", "--freeze", "on"}, to_server).code, 0);
  EXPECT_EQ(obliq({"set", "--freeze", "off"}, to_server).code, 0);
  fly_on();
  const wire::RadarInfo now = info();
  EXPECT_NE(now.controller().find("obliq fly"), std::string::npos);
  EXPECT_EQ(now.settings_controller(), "");
  EXPECT_EQ(now.settings().receiver_gain_db(), 6);
  EXPECT_EQ(now.pose().tilt_deg(), -5);
  EXPECT_NEAR(now.pose().bearing_deg(), now.pose().heading_deg() + 30, 1e-9);
  const Outcome other = obliq({"pose", "--tilt", "-1"}, to_server);
  EXPECT_EQ(other.code, 1) << other.out;
  EXPECT_NE(other.err.find("pose is held by obliq fly"), std::string::npos) << other.err;
  EXPECT_EQ(flight.end(SIGINT), 0) << flight.log();
}

TEST_F(Fly, APipeIsFlownAsItsLinesCome) {
  const std::string pipe = folder / "pipe";
  ASSERT_EQ(std::system(("mkfifo " + pipe).c_str()), 0);
  Running flight({"fly", pipe, "--server", daemon.address(), "--height-reference", "ground"},
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
}  // namespace obliq::test::set_test
