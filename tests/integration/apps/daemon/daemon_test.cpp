// obliqd and the commands that talk to it, end to end: scene file, terrain, Embree, TCP, files.
#include "tests/integration/daemon.h"

#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <future>
#include <sstream>

#include "proto/obliq.pb.h"
#include "tests/integration/clients.h"

namespace obliq::test::daemon_test {
namespace {

/// Small, with shadow behind the ridge and buildings on it; two radars.
const std::string kScene =
    text_of(SmallScene{.terrain = std::string(kRidge) + "[[prisms]]\nper_km2 = 0.5\n",
                       .antenna = "latitude_deg = 33.0\nlongitude_deg = -99.5\nbearing_deg = 20.0\n",
                       .radars = kTwoRadars});

class DaemonTest : public ProgramTest {
 protected:
  std::string scene = folder.write("scene.toml", kScene);
};

void expect_same_files(const std::filesystem::path& one, const std::filesystem::path& other, int files = 7) {
  int compared = 0;
  for (const auto& entry : std::filesystem::directory_iterator(one)) {
    const std::string name = entry.path().filename();
    if (name == "timing.json") continue;  // outside the promise
    EXPECT_TRUE(text_of(entry.path()) == text_of(other / name)) << name << " differs";
    ++compared;
  }
  EXPECT_EQ(compared, files) << "bins, power, count, state, frame.json, ground_map.png and .tif";
}

/// ", N of M buildings seen".
std::string last_part(const std::string& line) {
  const std::size_t comma = line.rfind(',');
  return comma == std::string::npos ? line : line.substr(comma);
}

std::string warnings_of(const std::string& lines) {
  std::string warnings;
  std::istringstream in(lines);
  for (std::string line; std::getline(in, line);) {
    if (line.rfind("warning: ", 0) == 0) warnings += line + '\n';
  }
  return warnings;
}

TEST_F(DaemonTest, GetWritesTheFilesOfRenderBitForBit) {
  const Daemon daemon({"--config", scene}, folder.path());
  ASSERT_NE(daemon.address(), "") << daemon.log();
  const std::vector<std::vector<std::string>> variants = {
      {"--radar", "main"},
      {"--radar", "nose", "--set", "frustum.kind=symmetric", "--set", "antenna.bearing_deg=100"},
      {"--radar", "nose", "--set", "frustum.pixels=[40, 50]", "--set", "radar.speckle=geometric"}};
  for (const auto& variant : variants) {
    std::vector<std::string> get = {"get", "--server", daemon.address(), "--out", folder / "got"};
    std::vector<std::string> render = {"render", scene, "--out", folder / "rendered"};
    get.insert(get.end(), variant.begin(), variant.end());
    render.insert(render.end(), variant.begin(), variant.end());
    const Outcome got = obliq(get);
    ASSERT_EQ(got.code, 0) << got.err;
    const Outcome rendered = obliq(render);
    ASSERT_EQ(rendered.code, 0) << rendered.err;
    expect_same_files(folder / "rendered", folder / "got");
    EXPECT_NE(rendered.out.find(" buildings seen\n"), std::string::npos) << rendered.out;
    EXPECT_EQ(last_part(got.out), last_part(rendered.out));
    // Both warn in the same words; render's other lines are about its loading.
    EXPECT_EQ(warnings_of(got.err), warnings_of(rendered.err));
  }
}

TEST_F(DaemonTest, VideoOfGetAndRenderIsTheSame) {
  const Daemon daemon({"--config", scene}, folder.path());
  ASSERT_NE(daemon.address(), "") << daemon.log();
  const std::vector<std::string> radar = {
      "--radar",           "main", "--set", "receiver.noise=true", "--set", "receiver.noise_frame=7", "--set",
      "radar.power_w=50e3"};
  for (const std::string bits : {"8", "16"}) {
    std::vector<std::string> get = {
        "get", daemon.address(), "--planes",    "iq,power,count,state,video", "--video-bits",
        bits,  "--out",          folder / "got"};
    std::vector<std::string> render = {"render", scene, "--video-bits", bits, "--out", folder / "rendered"};
    get.insert(get.end(), radar.begin(), radar.end());
    render.insert(render.end(), radar.begin(), radar.end());
    const Outcome got = obliq(get);
    ASSERT_EQ(got.code, 0) << got.err;
    const Outcome rendered = obliq(render);
    ASSERT_EQ(rendered.code, 0) << rendered.err;
    expect_same_files(folder / "rendered", folder / "got", 8);
  }
}

TEST_F(DaemonTest, GetLeavesTheLiveRadarAloneAndPoseMovesIt) {
  const Daemon daemon({"--config", scene}, folder.path());
  const std::string server = daemon.address();
  ASSERT_EQ(obliq({"get", "--server", server, "--radar", "main", "--set", "antenna.bearing_deg=300", "--out",
                   folder / "got"})
                .code,
            0);
  Outcome pose = obliq({"pose", "--server", server, "--radar", "main"});
  EXPECT_EQ(pose.out.rfind("main: 33.0000000 N, 99.5000000 W, ", 0), 0u) << pose.out;
  EXPECT_NE(pose.out.find("bearing 20.000"), std::string::npos) << pose.out;
  pose = obliq({"pose", "--server", server, "--radar", "main", "--bearing", "77", "--height=1600"});
  EXPECT_EQ(pose.code, 0) << pose.err;
  EXPECT_NE(pose.out.find("1600.00 m above datum, bearing 77.000"), std::string::npos) << pose.out;
  const Outcome status = obliq({"status", "--server", server});
  EXPECT_EQ(status.code, 0);
  std::string version = obliq({"--version"}).out.substr(std::string("obliq ").size());
  version.pop_back();
  EXPECT_NE(status.out.find(" " + version + ", scene "), std::string::npos)
      << version << "\nin: " << status.out;
  EXPECT_NE(status.out.find("nose: settings 1, controlled by nobody"), std::string::npos) << status.out;
  for (const char* line : {"  pose: ", "1600.00 m above datum, bearing 77.000",
                           "  ranges: 2000 to 9000 m, sector 60", "36 x 32 bins", "  sampling: "})
    EXPECT_NE(status.out.find(line), std::string::npos) << line << "\nin: " << status.out;
  const Outcome json = obliq({"status", server, "--json", "--radar", "main"});
  EXPECT_EQ(json.code, 0) << json.err;
  for (const char* part :
       {"\"radar\": \"main\"", "\"bearing_deg\": 77.0", "\"r_max_m\": 9000.0", "\"sampling\": "})
    EXPECT_NE(json.out.find(part), std::string::npos) << part << "\nin: " << json.out;
  EXPECT_EQ(json.out.find("\"radar\": \"nose\""), std::string::npos) << json.out;
}

TEST_F(DaemonTest, WatchSaysOnceWhatIsMissingWithCoverageOnEachLine) {
  const Daemon daemon({"--config", scene}, folder.path());
  EXPECT_EQ(obliq({"pose", daemon.address(), "--radar", "main", "--latitude", "45"}).code, 0);
  const Outcome watch =
      obliq({"watch", daemon.address(), "--radar", "main", "--rate", "50", "--frames", "3"});
  EXPECT_EQ(watch.code, 0) << watch.err;
  EXPECT_NE(watch.out.find(", coverage 0 %\n"), std::string::npos) << watch.out;
  const std::string warning = "warning: no known ground in the sector";
  EXPECT_NE(watch.err.find(warning), std::string::npos) << watch.err;
  EXPECT_EQ(watch.err.find(warning), watch.err.rfind(warning)) << watch.err;
}

TEST_F(DaemonTest, WatchPrintsALinePerFrameAndKeepsTheNewestPicture) {
  const Daemon daemon({"--config", scene}, folder.path());
  const Outcome watch = obliq({"watch", "--server", daemon.address(), "--radar", "nose", "--rate", "50",
                               "--frames", "3", "--out", folder / "newest"});
  EXPECT_EQ(watch.code, 0) << watch.err;
  EXPECT_EQ(std::count(watch.out.begin(), watch.out.end(), '\n'), 3) << watch.out;
  EXPECT_TRUE(std::filesystem::exists(folder / "newest/ground_map.png"));
}

TEST_F(DaemonTest, SignalsStopItCleanlyWhileClientsWatchAndStall) {
  for (const int signal : {SIGINT, SIGTERM}) {
    Daemon daemon({"--config", scene}, folder.path());
    client::Client stalled = connected(daemon.address());
    ASSERT_TRUE(stalled.subscribe("main", 100).ok());
    daemon.send_signal(signal);
    EXPECT_EQ(daemon.wait(), 0);
    EXPECT_NE(daemon.log().find("stopped"), std::string::npos) << daemon.log();
  }
}

TEST_F(DaemonTest, SignalsWhileItLoadsEndItAtOnceAlsoWhereTheyWereIgnored) {
  // Fifty million posts: seconds of loading, of which the signal comes in the first hundredth.
  const std::vector<std::string> slow = {
      "--config",          scene, "--set", "terrain.synthetic=hills", "--set", "terrain.shape={}", "--set",
      "terrain.cell_m=2.5"};
  for (const int signal : {SIGINT, SIGTERM}) {
    for (const auto inherited : {SIG_DFL, SIG_IGN}) {
      const auto ours = std::signal(signal, inherited);
      Daemon daemon(slow, folder.path(), "loading terrain");
      (void)std::signal(signal, ours);
      daemon.send_signal(signal);
      EXPECT_EQ(daemon.wait(), 0);
      EXPECT_NE(daemon.log().find("stopping while loading\n"), std::string::npos) << daemon.log();
      EXPECT_EQ(daemon.log().find("ready: "), std::string::npos) << daemon.log();
    }
  }
}

TEST_F(DaemonTest, GetWaitsForADaemonThatIsNotThereYet) {
  const std::string address = Daemon({"--config", scene}, folder.path()).address();
  ASSERT_NE(address, "");
  const TestFolder& own = folder;
  std::filesystem::create_directories(own / "get");
  auto waiting = std::async(std::launch::async, [&] {
    return run_program(OBLIQ_PROGRAM,
                       {"get", "--wait", "600", "--server", address, "--radar", "main", "--out", own / "got"},
                       own / "get");
  });
  while (text_of(own / "get/err").find("waiting for a server at " + address) == std::string::npos &&
         waiting.wait_for(std::chrono::milliseconds(10)) != std::future_status::ready) {
  }
  const Daemon daemon({"--config", scene, "--port", address.substr(address.find(':') + 1)}, folder.path());
  ASSERT_EQ(daemon.address(), address) << daemon.log();
  const Outcome got = waiting.get();
  EXPECT_EQ(got.code, 0) << got.err;
  EXPECT_TRUE(std::filesystem::exists(own / "got/ground_map.png"));
  // The one line, and what get says about the frame itself.
  EXPECT_EQ(got.err.find("waiting"), got.err.rfind("waiting")) << got.err;
}

TEST_F(DaemonTest, MistakesAtStartAreOneLineAndAnExitCode) {
  const Daemon running({"--config", scene}, folder.path());
  const std::string port = running.address().substr(running.address().find(':') + 1);
  const std::vector<std::pair<std::vector<std::string>, std::string>> mistakes = {
      {{"--config", scene, "--port", port}, "cannot listen on 127.0.0.1:" + port},
      {{"--config", scene, "--port", "70000"}, "server.port: found 70000"},
      {{"--config", scene, "--set", "antenna.height_m=-500"}, "radar \"main\""},
      {{"--config", folder / "none.toml"}, "none.toml"},
      {{"--config", scene, "--no-such-flag"}, "--no-such-flag"},
      {{}, "found no scene file"},
  };
  for (const auto& [arguments, part] : mistakes) {
    const Outcome outcome = run_program(OBLIQD_PROGRAM, arguments, folder.path());
    EXPECT_EQ(outcome.code, 1) << part;
    const std::string last = outcome.err.substr(
        outcome.err.rfind("obliqd: ") == std::string::npos ? 0 : outcome.err.rfind("obliqd: "));
    EXPECT_NE(last.find(part), std::string::npos) << outcome.err;
    EXPECT_EQ(std::count(last.begin(), last.end(), '\n'), 1) << outcome.err;
  }
}

TEST_F(DaemonTest, CheckConfigAndPrintConfigDoNotServe) {
  EXPECT_EQ(run_program(OBLIQD_PROGRAM, {"--config", scene, "--check-config"}, folder.path()).code, 0);
  const Outcome printed = run_program(OBLIQD_PROGRAM, {"--config", scene, "--print-config"}, folder.path());
  EXPECT_EQ(printed.code, 0);
  EXPECT_NE(printed.out.find("r_max_m = 9000"), std::string::npos) << printed.out;
}

TEST_F(DaemonTest, AClientProgramLinksNeitherEmbreeNorGdal) {
  const Outcome outcome = run_program("/usr/bin/ldd", {FIRST_FRAME_PROGRAM}, folder.path());
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("libprotobuf"), std::string::npos) << "ldd does list libraries";
  EXPECT_EQ(outcome.out.find("embree"), std::string::npos) << outcome.out;
  EXPECT_EQ(outcome.out.find("gdal"), std::string::npos) << outcome.out;

  const Daemon daemon({"--config", scene}, folder.path());
  const Outcome frame = run_program(FIRST_FRAME_PROGRAM, {daemon.address(), "nose"}, folder.path());
  EXPECT_EQ(frame.code, 0) << frame.err;
  EXPECT_NE(frame.out.find("nose: 36 x 32 bins"), std::string::npos) << frame.out;
}

}  // namespace
}  // namespace obliq::test::daemon_test
