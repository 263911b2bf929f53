// `obliq set`: live settings of a radar from the command line, against a real daemon.
#include <gtest/gtest.h>

#include <chrono>
#include <future>
#include <nlohmann/json.hpp>

#include "client/client.h"
#include "proto/obliq.pb.h"
#include "tests/integration/daemon.h"

namespace obliq::test {
namespace {

class SetCommand : public testing::Test {
 protected:
  SetCommand() {
    SmallScene scene;
    scene.radars = kTwoRadars;
    daemon = std::make_unique<Daemon>(
        std::vector<std::string>{"--config", folder.write("scene.toml", text_of(scene)), "--port", "0"},
        folder.path());
  }
  Outcome obliq(std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--server", daemon->address()});
    return run_program(OBLIQ_PROGRAM, arguments, folder.path());
  }
  wire::RadarInfo info(const std::string& radar = "nose") {
    client::Client client;
    EXPECT_TRUE(client.connect(*client::parse_endpoint(daemon->address())).ok());
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

  TestFolder folder;
  std::unique_ptr<Daemon> daemon;
};

TEST_F(SetCommand, WatchSaysThatASilentRadarSendsNothing) {
  ASSERT_EQ(obliq({"set", "--transmit", "off", "--radar", "nose"}).code, 0);
  std::filesystem::create_directories(folder / "watch");
  auto watch = std::async(std::launch::async, [&] {
    return run_program(OBLIQ_PROGRAM,
                       {"watch", "--server", daemon->address(), "--radar", "nose", "--frames", "1"},
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
  expect_refused({"antenna.bearing_deg=10"}, "obliq pose --set antenna.bearing_deg=VALUE");
  expect_refused({"radar.r_max_m"}, "allowed: KEY=VALUE");
  expect_refused({"radar.r_max_m=nan"}, "radar.r_max_m: found nan");
  expect_refused({"radar.r_max_m=8000", "radar.sector_deg=400"}, "allowed: number above 0, at most 360 deg");
  expect_refused({"bins.range=many"}, "bins.range: found many; allowed: integer 1 to 8192");
  expect_refused({"--transmit", "perhaps"}, "--transmit: found \"perhaps\"; allowed: on, off");
  expect_refused({"--freeze"}, "--freeze");
  expect_refused({""}, "allowed: KEY=VALUE");
}

TEST_F(SetCommand, ARadarThatSomebodyElseControlsIsLeftAloneAndHisNameIsSaid) {
  client::Client pilot;
  ASSERT_TRUE(pilot.connect(*client::parse_endpoint(daemon->address()), {.name = "pilot"}).ok());
  ASSERT_TRUE(pilot.claim_control("nose").ok());
  const Outcome outcome = obliq({"set", "radar.r_max_m=8000", "--radar", "nose"});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.err.find("controlled by pilot"), std::string::npos) << outcome.err;
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

}  // namespace
}  // namespace obliq::test
