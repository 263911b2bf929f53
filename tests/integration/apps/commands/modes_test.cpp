// Radars whose modes look at Doppler, from the command line: recorded and replayed, saved and loaded, shown
// and moved.
#include <gtest/gtest.h>

#include <csignal>
#include <cstring>
#include <nlohmann/json.hpp>

#include "client/frame_assembler.h"
#include "proto/obliq.pb.h"
#include "tests/integration/clients.h"
#include "tests/integration/daemon.h"

namespace obliq::test::modes_test {
namespace {

/// Four radars of one flight, north at 150 m/s, that look to the right of it.
constexpr const char* kModes = R"(
[beam]
pattern = "gaussian"
width_deg = 3.0
[[radar]]
name = "plain"
sector_deg = 8.0
r_min_m = 4000.0
r_max_m = 6000.0
[[radar]]
name = "mti"
mode = "mti"
sector_deg = 8.0
r_min_m = 4000.0
r_max_m = 6000.0
[[radar]]
name = "dbs"
mode = "dbs"
sector_deg = 8.0
r_min_m = 4000.0
r_max_m = 6000.0
[[radar]]
name = "sar"
mode = "sar"
sector_deg = 8.0
r_min_m = 4000.0
r_max_m = 6000.0
[radar.doppler]
resolution_m = 20.0
)";

SmallScene modes_scene() {
  return {.terrain = "synthetic = \"hills\"\n",
          .antenna =
              "latitude_deg = 33.0\nlongitude_deg = -99.5\nbearing_deg = 60.0\n"
              "velocity_north_m_s = 150.0\n",
          .radars = kModes,
          .azimuth_bins = 64};
}

class ModesCommand : public ProgramTest {
 protected:
  Outcome obliq(const std::vector<std::string>& arguments) {
    return ProgramTest::obliq(arguments, {"--server", daemon.address()});
  }
  wire::RadarInfo info(const std::string& radar) {
    client::Client client = connected(daemon.address());
    wire::RadarInfo found;
    EXPECT_TRUE(client.get_radar(radar, found).ok());
    return found;
  }
  std::string state() {
    client::Client client = connected(daemon.address());
    wire::ExerciseState found;
    EXPECT_TRUE(is_ok(client.get_exercise(found)));
    return found.DebugString();
  }

  Daemon daemon{{"--config", folder.write("scene.toml", text_of(modes_scene()))}, folder.path()};
};

TEST_F(ModesCommand, FramesOfEachModeAreRecordedAndReplayedToTheBit) {
  std::string map;
  for (const char* mode : {"plain", "mti", "dbs", "sar"}) {
    const std::string file = folder / (std::string(mode) + ".obliq");
    ASSERT_EQ(obliq({"record", "--radar", mode, "--out", file, "--frames", "2", "--rate", "50"}).code, 0);
    const std::string got = std::string("got_") + mode;
    const std::string played = std::string("played_") + mode;
    ASSERT_EQ(obliq({"get", "--radar", mode, "--out", folder / got}).code, 0);
    ASSERT_EQ(ProgramTest::obliq({"replay", file, "--speed", "max", "--out", folder / played}).code, 0);
    for (const char* plane : {"bins.npy", "power.npy", "state.npy"}) {
      const std::string now = text_of(folder / (got + "/" + plane));
      ASSERT_GT(now.size(), 2000u);
      EXPECT_TRUE(text_of(folder / (played + "/" + plane)) == now) << mode << " " << plane;
    }
    const auto said = nlohmann::json::parse(text_of(folder / (played + "/frame.json")));
    EXPECT_EQ(said["frame"]["settings"]["mode"],
              mode == std::string("plain") ? "map_mode" : mode + std::string("_mode"));
    // The mode is in the picture: other power than the map's.
    const std::string power = text_of(folder / (played + "/power.npy"));
    if (map.empty()) map = power;
    EXPECT_EQ(power == map, mode == std::string("plain")) << mode;

    Running replay({"replay", file, "--serve", "--port", "0", "--loop"}, folder / (played + ".log"));
    client::Client client = connected(replay.await(" on "));
    client::FrameAssembler frames(wire::kAllPlanes);
    client.set_handler(&frames);
    ASSERT_TRUE(client.subscribe(mode, 10, wire::kAllPlanes).ok());
    while (frames.state() != client::FrameAssembler::State::complete) ASSERT_TRUE(client.receive(kLong).ok());
    const client::AssembledFrame frame = frames.take();
    EXPECT_EQ(frame.descriptor->settings().mode(), info(mode).settings().mode());
    EXPECT_EQ(frame.descriptor->pose().velocity_north_m_s(), 150);
    ASSERT_LT(frame.power_w.size() * sizeof(double), power.size());
    EXPECT_EQ(
        std::memcmp(frame.power_w.data(), power.data() + power.size() - frame.power_w.size() * sizeof(double),
                    frame.power_w.size() * sizeof(double)),
        0)
        << mode;
    EXPECT_EQ(replay.end(SIGTERM), 0) << replay.log();
  }
}

TEST_F(ModesCommand, AnExerciseKeepsItsModes) {
  ASSERT_EQ(obliq({"set", "--radar", "plain", "radar.mode=dbs", "doppler.pulses=12", "pulse.prf_hz=1500.5",
                   "doppler.window=hann", "radar.polarisation=vertical"})
                .code,
            0);
  ASSERT_EQ(obliq({"set", "--radar", "mti", "doppler.canceller=3", "doppler.clutter_lock=true",
                   "atmosphere.wind_m_s=7.5"})
                .code,
            0);
  ASSERT_EQ(obliq({"set", "--radar", "sar", "doppler.resolution_m=15"}).code, 0);
  const std::string saved = state();
  ASSERT_EQ(obliq({"save", folder / "state.toml"}).code, 0);
  const std::string text = text_of(folder / "state.toml");
  for (const char* line :
       {"radar.mode = \"dbs\"\n", "radar.mode = \"mti\"\n", "radar.mode = \"sar\"\n", "doppler.pulses = 12\n",
        "pulse.prf_hz = 1500.5\n", "doppler.window = \"hann\"\n", "doppler.canceller = 3\n",
        "doppler.clutter_lock = true\n", "doppler.resolution_m = 15.0\n", "atmosphere.wind_m_s = 7.5\n",
        "atmosphere.polarisation = \"vertical\"\n"})
    EXPECT_NE(text.find(line), std::string::npos) << line;
  ASSERT_EQ(obliq({"reset"}).code, 0);
  EXPECT_NE(state(), saved);
  ASSERT_EQ(obliq({"load", folder / "state.toml"}).code, 0);
  EXPECT_EQ(state(), saved);
  // And frames come by it.
  EXPECT_EQ(obliq({"get", "--radar", "plain", "--out", folder / "loaded"}).code, 0);
  // A mode without its beam in the file is refused as a whole.
  std::string bad = text;
  const std::string beam = "beam.pattern = \"gaussian\"";
  bad.replace(bad.find(beam), beam.size(), "beam.pattern = \"off\"");
  const Outcome refused = obliq({"load", folder.write("bad.toml", bad)});
  EXPECT_EQ(refused.code, 1);
  EXPECT_NE(refused.err.find("radar.mode: found \"dbs\" with beam.pattern = \"off\""), std::string::npos)
      << refused.err;
  EXPECT_EQ(state(), saved);
}

TEST_F(ModesCommand, StatusNamesTheModesThatAreNoMap) {
  const Outcome outcome = obliq({"status"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("  mode: mti, 2 delays at 1000 Hz\n"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("  mode: dbs, 16 pulses at 1000 Hz\n"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("  mode: sar, 20 m\n"), std::string::npos) << outcome.out;
  const Outcome plain = obliq({"status", "--radar", "plain"});
  EXPECT_EQ(plain.out.find("mode:"), std::string::npos) << plain.out;
}

TEST_F(ModesCommand, APoseByWhichAnImageHasNoFramesSaysSo) {
  const std::string warning =
      "warning: no frames by this pose: radar.mode: found \"sar\" of an antenna that flies "
      "across its line of sight at 0.00 m/s";
  const auto said = [&](const std::vector<std::string>& pose) {
    const Outcome outcome = obliq(pose);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return outcome.err.find(warning) != std::string::npos;
  };
  EXPECT_FALSE(said({"pose", "--radar", "sar", "--bearing", "80"}));
  EXPECT_TRUE(said({"pose", "--radar", "sar", "--bearing", "0"})) << "along its line of sight";
  EXPECT_FALSE(said({"pose", "--radar", "sar", "--bearing", "80"}));
  EXPECT_TRUE(said({"pose", "--radar", "sar", "--latitude", "33.01"}))
      << "a place without a velocity ends it";
  EXPECT_FALSE(said({"pose", "--radar", "sar", "--set", "antenna.velocity_north_m_s=90"}));
  EXPECT_FALSE(said({"pose", "--radar", "dbs", "--latitude", "33.01"})) << "the real beam's map";
  const Outcome two =
      obliq({"set", "--radar", "dbs", "radar.polarisation=vertical", "atmosphere.polarisation=horizontal"});
  EXPECT_EQ(two.code, 1);
  EXPECT_NE(two.err.find("radar.polarisation: found vertical beside atmosphere.polarisation = horizontal; "
                         "allowed: one of them"),
            std::string::npos)
      << two.err;
}

}  // namespace
}  // namespace obliq::test::modes_test
