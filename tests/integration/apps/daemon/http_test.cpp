// What a running obliqd says over HTTP.
// Windows and encodings from the command line: what `obliq get` writes of a part is that part of the whole.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>

#include "client/frame_assembler.h"
#include "tests/integration/clients.h"
#include "tests/integration/daemon.h"
#include "tests/integration/http_peer.h"

namespace obliq::test::http_test {
namespace {

const std::string kScene = text_of(SmallScene{.terrain = "synthetic = \"ridge\"\n"});

class DaemonHttpTest : public ProgramTest {
 protected:
  /// The port in "HTTP on 127.0.0.1:PORT: ".
  static std::uint16_t http_port(const Daemon& daemon) {
    const std::string log = daemon.log();
    const std::size_t at = log.find("HTTP on ");
    EXPECT_NE(at, std::string::npos) << log;
    return port_of(log.substr(at + 8, log.find(": ", at) - at - 8));
  }

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

TEST_F(DaemonHttpTest, ItIsReadyOnceClientsAreServed) {
  const Daemon daemon({"--config", scene}, folder.path());
  EXPECT_EQ(http_get(http_port(daemon), "/readyz").status, 200);
  EXPECT_EQ(http_get(http_port(daemon), "/healthz").status, 200);
  EXPECT_EQ(http_get(http_port(daemon), "/nothing").status, 404);
}

TEST_F(DaemonHttpTest, TheMetricsCountTheFramesThatAClientGot) {
  const Daemon daemon({"--config", scene}, folder.path());
  client::Client client = connected(daemon.address());
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
  EXPECT_GT(value_of(text, "obliq_memory_limit_bytes"), value_of(text, "process_resident_memory_bytes"));
  EXPECT_NE(text.find("\nobliq_tls_certificate_end_time_seconds +Inf\n"), std::string::npos) << text;
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
    return obliq({"get", "--server", daemon.address(), "--out", folder / out});
  };
  ASSERT_EQ(get("swept").code, 0);
  EXPECT_EQ(embree(), 0);
  ASSERT_EQ(
      obliq({"get", "--server", daemon.address(), "--out", folder / "cast", "--set", "frustum.kind=oblique"})
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
    const Outcome got = obliq({"get", "--server", daemon.address(), "--out", folder / out});
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
  client::Client stalled = connected(daemon.address());
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
  if (install.code != 0) GTEST_SKIP() << "prometheus_client cannot be installed: " << install.err;
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

constexpr int kAzimuths = 36;
constexpr int kRanges = 32;
constexpr const char* kHills = R"(
[terrain]
synthetic = "hills"
cell_m = 64.0
[antenna]
height_m = 1500.0
height_reference = "datum"
bearing_deg = 20.0
[radar]
sector_deg = 72.0
r_min_m = 2000.0
r_max_m = 8400.0
[frustum]
quality = "draft"
[bins]
azimuth = 36
range = 32
[server]
port = 0
[http]
enabled = false
)";

/// The values of an array file, of which only the size of an element is known here.
template <typename T>
std::vector<T> values_of(const std::filesystem::path& file) {
  const std::string bytes = text_of(file);
  EXPECT_EQ(bytes.substr(1, 5), "NUMPY") << file;  // numpy.lib.format: magic, version, header's length
  const auto length = static_cast<std::uint8_t>(bytes[8]) + 256u * static_cast<std::uint8_t>(bytes[9]);
  const std::string data = bytes.substr(10 + length);
  std::vector<T> values(data.size() / sizeof(T));
  std::memcpy(values.data(), data.data(), data.size());
  return values;
}

struct Part {
  int first_azimuth, n_azimuth, azimuth_step;
  int first_range, n_range, range_step;
};

template <typename T>
void expect_part(const std::filesystem::path& whole_file, const std::filesystem::path& part_file,
                 const Part& p) {
  const auto whole = values_of<T>(whole_file);
  const auto part = values_of<T>(part_file);
  ASSERT_EQ(whole.size(), static_cast<std::size_t>(kAzimuths * kRanges));
  std::vector<T> expected;
  for (int a = p.first_azimuth; a < p.first_azimuth + p.n_azimuth; a += p.azimuth_step) {
    for (int r = p.first_range; r < p.first_range + p.n_range; r += p.range_step)
      expected.push_back(whole[static_cast<std::size_t>(a * kRanges + r)]);
  }
  EXPECT_EQ(std::memcmp(expected.data(), part.data(), expected.size() * sizeof(T)), 0) << part_file;
  EXPECT_EQ(part.size(), expected.size());
}

class DaemonStreamTest : public ProgramTest {
 protected:
  Outcome get(const Daemon& daemon, const std::string& out, const std::vector<std::string>& more) const {
    return obliq({"get", "--server", daemon.address(), "--out", folder / out}, more);
  }
  nlohmann::json frame_of(const std::string& out) const {
    return nlohmann::json::parse(text_of(folder / (out + "/frame.json")));
  }

  std::string scene = folder.write("scene.toml", kHills);
};

TEST_F(DaemonStreamTest, APartOfAFrameHasTheWholeFramesBitsAndItsOwnPlace) {
  const Daemon daemon({"--config", scene}, folder.path());
  ASSERT_NE(daemon.address(), "") << daemon.log();
  const Outcome whole = get(daemon, "whole", {"--compress", "zstd"});
  ASSERT_EQ(whole.code, 0) << whole.err;
  const Outcome part = get(daemon, "part", {"--azimuths", "9:30", "--ranges", "4:", "--compress", "zstd"});
  ASSERT_EQ(part.code, 0) << part.err;
  const Part p{9, 21, 1, 4, 28, 1};
  expect_part<std::uint64_t>(folder / "whole/bins.npy", folder / "part/bins.npy", p);
  expect_part<std::uint64_t>(folder / "whole/power.npy", folder / "part/power.npy", p);
  expect_part<std::uint32_t>(folder / "whole/count.npy", folder / "part/count.npy", p);
  expect_part<std::uint8_t>(folder / "whole/state.npy", folder / "part/state.npy", p);
  const auto all = frame_of("whole");
  const auto some = frame_of("part");
  EXPECT_FALSE(all["frame"].contains("window"));
  ASSERT_EQ(some["azimuth_edges_deg"].size(), 22u);
  ASSERT_EQ(some["range_edges_m"].size(), 29u);
  for (std::size_t k = 0; k < 22; ++k)
    EXPECT_EQ(some["azimuth_edges_deg"][k], all["azimuth_edges_deg"][k + 9]);
  for (std::size_t k = 0; k < 29; ++k) EXPECT_EQ(some["range_edges_m"][k], all["range_edges_m"][k + 4]);
  EXPECT_DOUBLE_EQ(some["azimuth_edges_deg"][0], 20 - 36 + 9 * 2) << "bins of 2 degrees from bearing -16";
  EXPECT_DOUBLE_EQ(some["range_edges_m"][0], 2000 + 4 * 200);
}

TEST_F(DaemonStreamTest, EveryThirdBinIsUnalteredAndSaysWhereItLies) {
  const Daemon daemon({"--config", scene}, folder.path());
  ASSERT_EQ(get(daemon, "whole", {}).code, 0);
  const Outcome part = get(daemon, "part", {"--azimuths", "::3", "--ranges", "1::3"});
  ASSERT_EQ(part.code, 0) << part.err;
  expect_part<std::uint64_t>(folder / "whole/bins.npy", folder / "part/bins.npy",
                             {0, kAzimuths, 3, 1, kRanges - 1, 3});
  const auto frame = frame_of("part");
  EXPECT_FALSE(frame.contains("range_edges_m"));
  ASSERT_EQ(frame["range_intervals_m"].size(), 11u);
  EXPECT_DOUBLE_EQ(frame["range_intervals_m"][2][0], 2000 + 7 * 200);
  EXPECT_DOUBLE_EQ(frame["range_intervals_m"][2][1], 2000 + 8 * 200) << "one bin wide, not three";
  EXPECT_TRUE(std::filesystem::exists(folder / "part/ground_map.png"));
}

TEST_F(DaemonStreamTest, IntegersAreCloseAndMistakesAreNamed) {
  const Daemon daemon({"--config", scene}, folder.path());
  ASSERT_EQ(get(daemon, "floats", {}).code, 0);
  const Outcome integers = get(daemon, "integers", {"--encoding", "ci16_le"});
  ASSERT_EQ(integers.code, 0) << integers.err;
  EXPECT_EQ(text_of(folder / "floats/power.npy"), text_of(folder / "integers/power.npy"));
  const auto exact = values_of<float>(folder / "floats/bins.npy");
  const auto coarse = values_of<float>(folder / "integers/bins.npy");
  float largest = 0;
  for (const float value : exact) largest = std::max(largest, std::fabs(value));
  ASSERT_EQ(exact.size(), coarse.size());
  for (std::size_t i = 0; i < exact.size(); ++i)
    ASSERT_LE(std::fabs(exact[i] - coarse[i]), largest / 32767 * 0.51f);

  for (const auto& [option, value, words] : {std::tuple{"--azimuths", "36:", "window.first_azimuth"},
                                             {"--ranges", "5", "--ranges: found \"5\""},
                                             {"--ranges", "5:5", "allowed: FIRST:END:STEP"},
                                             {"--ranges", "::0", "allowed: FIRST:END:STEP"},
                                             {"--encoding", "raw", "--encoding"}}) {
    const Outcome refused = get(daemon, "refused", {option, value});
    EXPECT_EQ(refused.code, 1) << option << ' ' << value;
    EXPECT_NE(refused.err.find(words), std::string::npos) << refused.err;
  }
}

TEST_F(DaemonStreamTest, WatchTakesTheSameWishesAndLosesNothingWhereItIsToldTo) {
  const Daemon daemon({"--config", scene}, folder.path());
  const Outcome watch =
      obliq({"watch", "--server", daemon.address(), "--rate", "50", "--frames", "3", "--encoding", "ci16_le",
             "--compress", "zstd", "--ranges", ":16", "--lossless"});
  EXPECT_EQ(watch.code, 0) << watch.err;
  EXPECT_EQ(std::count(watch.out.begin(), watch.out.end(), '\n'), 3) << watch.out;
  EXPECT_EQ(watch.out.find("skipped"), std::string::npos) << watch.out;
}

}  // namespace
}  // namespace obliq::test::http_test
