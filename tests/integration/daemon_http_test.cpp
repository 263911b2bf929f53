// What a running obliqd says over HTTP.
#include <gtest/gtest.h>

#include <set>
#include <sstream>
#include <string>

#include "client/client.h"
#include "client/frame_assembler.h"
#include "tests/integration/daemon.h"
#include "tests/integration/http_peer.h"

namespace obliq::test {
namespace {

const std::string kScene = text_of(SmallScene{.terrain = "synthetic = \"ridge\"\n"});

class DaemonHttpTest : public testing::Test {
 protected:
  /// The port in "HTTP on 127.0.0.1:PORT: ".
  static std::uint16_t http_port(const Daemon& daemon) {
    const std::string log = daemon.log();
    const std::size_t at = log.find("HTTP on ");
    EXPECT_NE(at, std::string::npos) << log;
    return port_of(log.substr(at + 8, log.find(": ", at) - at - 8));
  }

  TestFolder folder;
  std::string scene = folder.write("scene.toml", kScene);
};

/// The value of a sample line, or -1.
double value_of(const std::string& text, const std::string& sample) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind(sample + " ", 0) == 0) return std::stod(line.substr(sample.size() + 1));
  }
  return -1;
}

TEST_F(DaemonHttpTest, ItIsHealthyButNotReadyWhileItLoads) {
  // Fifty million posts: seconds of loading, of which the questions come in the first.
  const Daemon daemon({"--config", scene, "--set", "terrain.synthetic=hills", "--set", "terrain.cell_m=2.5"},
                      folder.path(), "loading terrain");
  EXPECT_EQ(http_get(http_port(daemon), "/healthz").status, 200);
  const HttpReply ready = http_get(http_port(daemon), "/readyz");
  EXPECT_EQ(ready.status, 503);
  EXPECT_EQ(ready.body.rfind("loading: ", 0), 0u) << ready.body;
  EXPECT_EQ(http_get(http_port(daemon), "/metrics").status, 200);
}

TEST_F(DaemonHttpTest, ItIsReadyOnceClientsAreServed) {
  const Daemon daemon({"--config", scene}, folder.path());
  EXPECT_EQ(http_get(http_port(daemon), "/readyz").status, 200);
  EXPECT_EQ(http_get(http_port(daemon), "/healthz").status, 200);
  EXPECT_EQ(http_get(http_port(daemon), "/nothing").status, 404);
}

TEST_F(DaemonHttpTest, TheMetricsCountTheFramesThatAClientGot) {
  const Daemon daemon({"--config", scene}, folder.path());
  client::Client client;
  ASSERT_TRUE(client.connect(*client::parse_endpoint(daemon.address())).ok());
  client::FrameAssembler frames;
  client.set_handler(&frames);
  ASSERT_TRUE(client.subscribe("main", 50).ok());
  for (int whole = 0; whole < 5;) {
    const bool was_whole = frames.state() == client::FrameAssembler::State::complete;
    ASSERT_TRUE(client.receive(client::Timeout(20000)).ok());
    whole += !was_whole && frames.state() == client::FrameAssembler::State::complete ? 1 : 0;
  }
  const std::string text = http_get(http_port(daemon), "/metrics").body;
  const double counted = value_of(text, "obliq_frames_total{radar=\"main\"}");
  EXPECT_GE(counted, 4) << text;  // the end of the fifth may not have been counted yet
  EXPECT_EQ(value_of(text, "obliq_frame_render_seconds_count{radar=\"main\"}"), counted);
  EXPECT_EQ(value_of(text, "obliq_frame_render_seconds_bucket{radar=\"main\",le=\"+Inf\"}"), counted);
  EXPECT_EQ(value_of(text, "obliq_clients"), 1);
  EXPECT_EQ(value_of(text, "obliq_radar_watchers{radar=\"main\"}"), 1);
  EXPECT_GT(value_of(text, "obliq_rays_total{radar=\"main\"}"), 0);
  EXPECT_GE(value_of(text, "obliq_rays_total{radar=\"main\"}"),
            value_of(text, "obliq_hits_total{radar=\"main\"}"));
  EXPECT_GT(value_of(text, "obliq_sent_bytes_total"), 5 * 36 * 32 * 8) << "five frames of I&Q at least";
  EXPECT_GT(value_of(text, "process_resident_memory_bytes"), 1e6);
  EXPECT_EQ(value_of(text, "obliq_scene_swaps_total"), 0);
  EXPECT_GT(value_of(text, "obliq_scene_load_seconds"), 0);
  EXPECT_GE(value_of(text, "obliq_log_lines_total{level=\"info\"}"), 3);
}

TEST_F(DaemonHttpTest, EmbreeTakesNoMemoryUntilAFrustumCastsRays) {
  const Daemon daemon({"--config", scene, "--set", "frustum.kind=sweep", "--set", "run.rays=embree"},
                      folder.path());
  const auto embree = [&] {
    return value_of(http_get(http_port(daemon), "/metrics").body,
                    "obliq_scene_memory_bytes{kind=\"embree\"}");
  };
  EXPECT_EQ(embree(), 0);
  const auto get = [&](const char* out) {
    return run_program(OBLIQ_PROGRAM, {"get", "--server", daemon.address(), "--out", folder / out},
                       folder.path());
  };
  ASSERT_EQ(get("swept").code, 0);
  EXPECT_EQ(embree(), 0);
  ASSERT_EQ(run_program(OBLIQ_PROGRAM,
                        {"get", "--server", daemon.address(), "--out", folder / "cast", "--set",
                         "frustum.kind=oblique"},
                        folder.path())
                .code,
            0);
  EXPECT_GT(embree(), 0);
  EXPECT_NE(daemon.log().find("building the ray-tracing scene"), std::string::npos) << daemon.log();
  const std::string text = http_get(http_port(daemon), "/metrics").body;
  EXPECT_GT(value_of(text, "obliq_scene_memory_bytes{kind=\"heights\"}"), 0);
  EXPECT_GE(value_of(text, "process_resident_memory_peak_bytes"),
            value_of(text, "process_resident_memory_bytes"));
}

TEST_F(DaemonHttpTest, TheMetricsCountRenderOnceFrames) {
  const Daemon daemon({"--config", scene}, folder.path());
  EXPECT_EQ(value_of(http_get(http_port(daemon), "/metrics").body, "obliq_once_frames_total"), 0);
  for (const char* out : {"first", "second"}) {
    const Outcome got = run_program(
        OBLIQ_PROGRAM, {"get", "--server", daemon.address(), "--out", folder / out}, folder.path());
    ASSERT_EQ(got.code, 0) << got.err;
  }
  const std::string text = http_get(http_port(daemon), "/metrics").body;
  EXPECT_EQ(value_of(text, "obliq_once_frames_total"), 2) << text;
  EXPECT_EQ(value_of(text, "obliq_once_render_seconds_count"), 2);
  EXPECT_GT(value_of(text, "obliq_once_render_seconds_sum"), 0);
  EXPECT_GT(value_of(text, "obliq_once_hits_total"), 0);
  EXPECT_GE(value_of(text, "obliq_once_rays_total"), value_of(text, "obliq_once_hits_total"));
  EXPECT_EQ(value_of(text, "obliq_frames_total{radar=\"main\"}"), 0) << "they are no live frames";
}

TEST_F(DaemonHttpTest, TheMetricsShowFramesThatAClientDoesNotTake) {
  const Daemon daemon({"--config", scene, "--set", "bins.azimuth=2048", "--set", "bins.range=1024"},
                      folder.path());
  const auto live = [&](const std::string& name) {
    return value_of(http_get(http_port(daemon), "/metrics").body, name + "{radar=\"main\"}");
  };
  EXPECT_EQ(live("obliq_radar_live_frames"), 0);
  EXPECT_EQ(live("obliq_radar_live_bytes"), 0);
  client::Client stalled;  // subscribes and does not read: frames of 40 MB wait
  ASSERT_TRUE(stalled.connect(*client::parse_endpoint(daemon.address())).ok());
  ASSERT_TRUE(stalled.subscribe("main", 50).ok());
  while (live("obliq_radar_live_frames") < 1 || live("obliq_radar_live_bytes") < 1e6) {
  }
}

TEST_F(DaemonHttpTest, ThePageOfMetricsListsWhatThereIs) {
  const Daemon daemon({"--config", scene}, folder.path());
  std::set<std::string> found;
  std::istringstream lines(http_get(http_port(daemon), "/metrics").body);
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("# TYPE ", 0) == 0) found.insert(line.substr(7, line.find(' ', 7) - 7));
  }
  std::set<std::string> listed;
  std::istringstream page(text_of(OBLIQ_SOURCE_DIR "/server/http/METRICS.md"));
  for (std::string line; std::getline(page, line);) {
    if (line.rfind("| `", 0) != 0) continue;
    std::istringstream names(line.substr(2, line.find(" |", 2) - 2));  // `one`, `other`
    for (std::string name; names >> name;) listed.insert(name.substr(1, name.rfind('`') - 1));
  }
  EXPECT_EQ(found, listed);
}

TEST_F(DaemonHttpTest, PrometheusOwnParserReadsTheMetrics) {
  const Daemon daemon({"--config", scene}, folder.path());
  const std::string metrics = folder.write("metrics", http_get(http_port(daemon), "/metrics").body);
  const std::string modules = folder / "modules";
  // Python's client library of Prometheus, from PyPI, for this test alone.
  const Outcome install =
      run_program("/usr/bin/env",
                  {"python3", "-m", "pip", "install", "--quiet", "--target", modules, "prometheus_client"},
                  folder.path());
  if (install.code != 0) GTEST_SKIP() << "no prometheus_client to be had here: " << install.err;
  const char* program = R"(
import sys
sys.path.insert(0, sys.argv[1])
from prometheus_client.parser import text_string_to_metric_families
for family in text_string_to_metric_families(open(sys.argv[2]).read()):
    assert family.documentation and family.type != "unknown", family
    print(family.name, family.type, len(family.samples))
)";
  const Outcome parsed =
      run_program("/usr/bin/env", {"python3", "-c", program, modules, metrics}, folder.path());
  EXPECT_EQ(parsed.code, 0) << parsed.err;
  // 22 buckets, one for the rest, count and sum.
  EXPECT_NE(parsed.out.find("obliq_frame_render_seconds histogram 25\n"), std::string::npos) << parsed.out;
  EXPECT_NE(parsed.out.find("obliq_frames counter 1\n"), std::string::npos) << parsed.out;
}

TEST_F(DaemonHttpTest, ItCanBeSwitchedOff) {
  const Daemon daemon({"--config", scene, "--set", "http.enabled=false"}, folder.path());
  ASSERT_NE(daemon.address(), "");
  EXPECT_EQ(daemon.log().find("HTTP on"), std::string::npos) << daemon.log();
}

TEST_F(DaemonHttpTest, APortInUseEndsItAtTheStartWithTheKey) {
  const Daemon first({"--config", scene}, folder.path());
  const std::string port = std::to_string(http_port(first));
  const Outcome second =
      run_program(OBLIQD_PROGRAM, {"--config", scene, "--set", "http.port=" + port}, folder.path());
  EXPECT_EQ(second.code, 1);
  EXPECT_EQ(second.err.rfind("obliqd: http.port " + port, 0), 0u) << second.err;
  EXPECT_EQ(second.err.find("terrain"), std::string::npos) << second.err;
}

}  // namespace
}  // namespace obliq::test
