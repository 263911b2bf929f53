// SIGHUP: the scene file is read anew while clients are served.
// SIGHUP reads tokens and certificate first and by themselves: who is shown the door goes, whatever else is
// wrong, and also while a scene is being built.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <csignal>
#include <thread>

#include "client/frame_assembler.h"
#include "proto/error_number.h"
#include "proto/obliq.pb.h"
#include "tests/integration/clients.h"
#include "tests/integration/daemon.h"

namespace obliq::test::reload_test {
namespace {

using client::FrameAssembler;

constexpr const char* kHighRidge =
    "synthetic = \"ridge\"\nshape = { distance_m = 5000.0, height_m = 900.0 }\n";

std::string scene_text(const std::string& terrain, const std::string& more = "") {
  return text_of(SmallScene{.terrain = terrain, .server = more});
}

class DaemonReload : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(watching.connect(*client::parse_endpoint(daemon.address())).ok()) << daemon.log();
    watching.set_handler(&frames);
    ASSERT_TRUE(watching.subscribe("main", 50).ok());
  }
  /// The next whole frame's planes of power.
  std::vector<double> next_frame() {
    while (frames.state() != FrameAssembler::State::complete) {
      const client::Status status = watching.receive(kLong);
      if (!status.ok()) {
        ADD_FAILURE() << status.sentence() << "\n" << daemon.log();
        return {};
      }
    }
    return frames.take().power_w;
  }
  /// Frames go on until the log says so; false when the client is dropped before.
  bool frames_until_log(const std::string& part) {
    while (daemon.log().find(part) == std::string::npos) {
      if (next_frame().empty()) return false;
    }
    return true;
  }

  TestFolder folder;
  std::string scene = folder.write("scene.toml", scene_text(kFlat));
  Daemon daemon{{"--config", scene}, folder.path()};
  client::Client watching;
  FrameAssembler frames;
};

TEST_F(DaemonReload, TheNewGroundShowsAndTheClientStays) {
  const std::vector<double> flat = next_frame();
  ASSERT_FALSE(flat.empty());
  folder.write("scene.toml", scene_text(kHighRidge));
  daemon.send_signal(SIGHUP);
  ASSERT_TRUE(frames_until_log("reloaded: serving the new scene"));
  (void)next_frame();  // one that had begun before
  const std::vector<double> ridge = next_frame();
  EXPECT_NE(ridge, flat);
  // The same as of a daemon that started with the ridge.
  const Daemon fresh({"--config", scene}, folder.path());
  client::Client other = connected(fresh.address());
  FrameAssembler expected;
  other.set_handler(&expected);
  ASSERT_TRUE(other.subscribe("main", 50).ok());
  while (expected.state() != FrameAssembler::State::complete) ASSERT_TRUE(other.receive(kLong).ok());
  EXPECT_EQ(ridge, expected.frame().power_w);
}

TEST_F(DaemonReload, ABrokenFileChangesNothingAndTheLogSaysWhy) {
  const std::vector<double> before = next_frame();
  folder.write("scene.toml", scene_text(kFlat) + "max_clients = -3\n");
  daemon.send_signal(SIGHUP);
  ASSERT_TRUE(frames_until_log("reload refused"));
  EXPECT_NE(daemon.log().find("server.max_clients: found -3"), std::string::npos) << daemon.log();
  EXPECT_EQ(next_frame(), before);
  // And when it is mended, the next signal is heeded.
  folder.write("scene.toml", scene_text(kHighRidge));
  daemon.send_signal(SIGHUP);
  ASSERT_TRUE(frames_until_log("reloaded: serving the new scene"));
}

TEST_F(DaemonReload, AFileThatIsGoneOrAnElevationModelThatIsNotThereChangesNothing) {
  const std::vector<double> before = next_frame();
  folder.write("scene.toml", scene_text("dem = \"nowhere.tif\"\n"));
  daemon.send_signal(SIGHUP);
  ASSERT_TRUE(frames_until_log("send SIGHUP again"));
  std::filesystem::remove(scene);
  daemon.send_signal(SIGHUP);
  ASSERT_TRUE(frames_until_log("scene.toml"));
  EXPECT_EQ(next_frame(), before);
}

TEST_F(DaemonReload, APipeWhereAFileBelongsIsRefusedByNameAndLaterReloadsGoOn) {
  const std::string pipe = folder / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const std::string is_pipe = pipe + ": found a pipe; allowed: a regular file";
  const auto buildings = [](const std::string& source) {
    return kFlat + std::string("[[buildings]]\nsource = \"") + source + "\"\n";
  };
  for (const auto& [terrain, said] : std::vector<std::pair<std::string, std::string>>{
           {"dem = \"" + pipe + "\"\n", "[terrain] dem: " + is_pipe},
           {buildings(pipe), "[[buildings]] source: " + is_pipe},
           {buildings("/dev/zero"), "[[buildings]] source: /dev/zero: found a device; allowed: a regular"}}) {
    folder.write("scene.toml", scene_text(terrain));
    daemon.send_signal(SIGHUP);
    ASSERT_TRUE(frames_until_log(said));
  }
  std::filesystem::remove(scene);
  ASSERT_EQ(mkfifo(scene.c_str(), 0600), 0);
  daemon.send_signal(SIGHUP);
  ASSERT_TRUE(frames_until_log(scene + ": found a pipe; allowed: a regular file"));
  std::filesystem::remove(scene);
  folder.write("scene.toml", scene_text(kHighRidge));
  daemon.send_signal(SIGHUP);
  ASSERT_TRUE(frames_until_log("reloaded: serving the new scene"));
}

TEST_F(DaemonReload, LimitsChangeAtOnceAndPortsAreNamedAsNeedingARestart) {
  folder.write("scene.toml",
               scene_text(kFlat, "max_clients = 1\nmax_pixels = 1000000\nhandshake_timeout_s = 3.0\n") +
                   "[run]\nthreads = 1\n[log]\nlevel = \"debug\"\n");
  daemon.send_signal(SIGHUP);
  ASSERT_TRUE(frames_until_log("reloaded: the scene is the same"));
  EXPECT_NE(daemon.log().find("run.threads differs from what runs; restart"), std::string::npos)
      << daemon.log();
  EXPECT_EQ(daemon.log().find("server.max_"), std::string::npos) << daemon.log();
  client::Client second;
  const client::Status status = second.connect(*client::parse_endpoint(daemon.address()));
  EXPECT_NE(status.sentence().find("max_clients is 1"), std::string::npos) << status.sentence();
  EXPECT_FALSE(next_frame().empty());
}

TEST_F(DaemonReload, ParametersWhoseTextHasChangedAreTakenOverAndOthersStayAsClientsSetThem) {
  const auto write = [&](const std::string& radar) {
    folder.write("scene.toml", text_of(SmallScene{.terrain = kFlat, .radars = radar}));
    daemon.send_signal(SIGHUP);
  };
  client::Client other = connected(daemon.address(), "pilot");
  ASSERT_TRUE(other.claim_control("main").ok());
  wire::RadarSettings settings;
  settings.set_power_w(7);
  wire::Ack ack;
  ASSERT_TRUE(other.set_settings("main", settings, ack).ok());
  write("[radar]\nr_min_m = 2000.0\nr_max_m = 7000.0\n");
  ASSERT_TRUE(frames_until_log("radar main: settings are held by pilot"));
  EXPECT_NE(daemon.log().find("\"radar.r_max_m is now 7000.0\""), std::string::npos) << daemon.log();
  wire::RadarInfo info;
  ASSERT_TRUE(other.get_radar("main", info).ok());
  EXPECT_EQ(info.settings().r_max_m(), 9000);

  ASSERT_TRUE(other.release_control("main").ok());
  daemon.send_signal(SIGHUP);  // the file has not changed since, but not all of it was taken over
  ASSERT_TRUE(frames_until_log("radar main: radar.r_max_m is now 7000.0"));
  ASSERT_TRUE(other.get_radar("main", info).ok());
  EXPECT_EQ(info.settings().r_max_m(), 7000);
  EXPECT_EQ(info.settings().power_w(), 7) << "its text in the file has not changed";

  // Planes follow the bins that the file and clients have; columns that the file names decide.
  const std::string ranges = "[radar]\nr_min_m = 2000.0\nr_max_m = 7000.0\n";
  write(ranges + "frustum.quality = \"standard\"\nfrustum.planes_per_bin = 3\n");
  ASSERT_TRUE(frames_until_log("frustum.planes_per_bin is now 3"));
  ASSERT_TRUE(other.get_radar("main", info).ok());
  EXPECT_EQ(info.settings().pixel_columns(), 3 * info.settings().azimuth_bins());
  EXPECT_EQ(info.settings().planes_per_bin(), 3);
  write(ranges + "frustum.kind = \"sweep\"\nfrustum.pixel_columns = 50\n");
  ASSERT_TRUE(frames_until_log("frustum.planes_per_bin is now 0"));
  ASSERT_TRUE(other.get_radar("main", info).ok());
  EXPECT_EQ(info.settings().pixel_columns(), 50);
  EXPECT_EQ(info.settings().planes_per_bin(), 0);
  EXPECT_EQ(daemon.log().find("restart obliqd"), std::string::npos) << daemon.log();
}

TEST(DaemonReloadOfPlatforms, TakesOverARidersTiltAndNamesWhatNeedsARestart) {
  const TestFolder folder;
  const auto write = [&](const std::string& height_m, const std::string& tilt_deg) {
    return folder.write(
        "scene.toml",
        "[terrain]\nsynthetic = \"flat\"\n[server]\nport = 0\n[http]\nenabled = false\n"
        "[[platform]]\nname = \"ship\"\nlatitude_deg = 33\nlongitude_deg = -99.5\nheight_m = " +
            height_m +
            "\n[radar]\nname = \"main\"\nplatform = \"ship\"\nr_min_m = 1000\nr_max_m = 3000\n"
            "[radar.antenna]\ntilt_deg = " +
            tilt_deg + "\n[bins]\nazimuth = 16\nrange = 16\n");
  };
  Daemon daemon({"--config", write("300", "-2")}, folder.path());
  client::Client client = connected(daemon.address(), "pilot");
  wire::Pose pose;
  pose.set_height_m(500);
  wire::Ack ack;
  ASSERT_TRUE(client.claim("ship", wire::kPoseClaim).ok());
  ASSERT_TRUE(client.set_pose("ship", pose, ack).ok());
  write("400", "-3");
  daemon.send_signal(SIGHUP);
  const auto end = std::chrono::steady_clock::now() + kLong;
  while (daemon.log().find("antenna.tilt_deg is now -3") == std::string::npos) {
    ASSERT_LT(std::chrono::steady_clock::now(), end) << daemon.log();
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  EXPECT_NE(daemon.log().find("[[platform]] or what rides on it differs from what runs"), std::string::npos)
      << daemon.log();
  wire::RadarInfo info;
  ASSERT_TRUE(client.get_radar("main", info).ok());
  EXPECT_EQ(info.pose().height_m(), 500) << "where it is flown";
  EXPECT_EQ(info.pose().tilt_deg(), -3);
}

constexpr const char* kStays = "token-of-one-who-stays";
constexpr const char* kGoes = "token-of-one-who-goes";

/// Seconds of work for one thread.
constexpr const char* kFineHills = "synthetic = \"hills\"\ncell_m = 5.0\nshape = { height_m = 300.0 }\n";

class Withdrawal : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(come(kStays, stays).ok()) << daemon.log();
    ASSERT_TRUE(come(kGoes, goes).ok()) << daemon.log();
  }
  client::Status come(const std::string& token, client::Client& made) const {
    return made.connect(*client::parse_endpoint(daemon.address()), {.name = "tester", .token = token});
  }
  std::string tokens_of(const std::vector<std::string>& names) const {
    std::string text;
    for (const std::string& token : names) text += "admin " + token + "\n";
    const std::string path = folder.write("tokens", text);
    EXPECT_EQ(chmod(path.c_str(), 0600), 0);
    return path;
  }
  void write_scene(const std::string& terrain, const std::string& more = "") const {
    folder.write("scene.toml", text_of(SmallScene{.terrain = terrain, .server = more}));
  }
  void withdraw() const {
    (void)tokens_of({kStays});
    daemon.send_signal(SIGHUP);
  }
  void expect_gone() {
    const client::Status told = goes.receive(kLong);
    EXPECT_EQ(told.number, static_cast<std::uint32_t>(wire::ErrorNumber::token_refused)) << daemon.log();
    client::Client again;
    EXPECT_FALSE(come(kGoes, again).ok());
    wire::RadarList list;
    EXPECT_TRUE(stays.list_radars(list).ok()) << daemon.log();
  }
  void await_log(const std::string& part) const {
    for (int i = 0; i < 2000 && daemon.log().find(part) == std::string::npos; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    EXPECT_NE(daemon.log().find(part), std::string::npos) << daemon.log();
  }

  TestFolder folder;
  std::string scene = folder.write("scene.toml", text_of(SmallScene{.terrain = kFlat}));
  Daemon daemon{{"--config", scene, "--set", "server.tokens=\"" + tokens_of({kStays, kGoes}) + "\""},
                folder.path()};
  client::Client stays;
  client::Client goes;
};

TEST_F(Withdrawal, HoldsWhereTheAccuracyCannotBeMet) {
  write_scene(kRidge, "[accuracy]\nmax_power_error_db = 1e-9\n");
  withdraw();
  expect_gone();
  await_log("send SIGHUP again");
}

TEST_F(Withdrawal, HoldsWhereASceneIsBeingBuiltAndTheNewSignalSupersedesIt) {
  write_scene(kFineHills);
  daemon.send_signal(SIGHUP);
  await_log("tokens were taken over");
  write_scene(kFlat);
  withdraw();
  expect_gone();
  await_log("reloaded: the scene is the same");
  EXPECT_EQ(daemon.log().find("serving the new scene"), std::string::npos) << daemon.log();
}

TEST_F(Withdrawal, AFaultyTokenFileChangesNothingAndIsNamed) {
  (void)tokens_of({kStays});
  ASSERT_EQ(chmod((folder / "tokens").c_str(), 0644), 0);
  daemon.send_signal(SIGHUP);
  await_log("the old one stays in effect");
  EXPECT_NE(daemon.log().find("found mode 644"), std::string::npos) << daemon.log();
  wire::RadarList list;
  EXPECT_TRUE(goes.list_radars(list).ok());
  await_log("reloaded: the scene is the same");
}

}  // namespace
}  // namespace obliq::test::reload_test
