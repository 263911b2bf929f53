// Windows and encodings from the command line: what `obliq get` writes of a part is that part of the whole.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "tests/integration/daemon.h"

namespace obliq::test {
namespace {

constexpr int kAzimuths = 36;
constexpr int kRanges = 32;
constexpr const char* kScene = R"(
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

class DaemonStreamTest : public testing::Test {
 protected:
  Outcome get(const Daemon& daemon, const std::string& out, const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = {"get", "--server", daemon.address(), "--out", folder / out};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_program(OBLIQ_PROGRAM, arguments, folder.path());
  }
  nlohmann::json frame_of(const std::string& out) const {
    return nlohmann::json::parse(text_of(folder / (out + "/frame.json")));
  }

  TestFolder folder;
  std::string scene = folder.write("scene.toml", kScene);
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
      run_program(OBLIQ_PROGRAM,
                  {"watch", "--server", daemon.address(), "--rate", "50", "--frames", "3", "--encoding",
                   "ci16_le", "--compress", "zstd", "--ranges", ":16", "--lossless"},
                  folder.path());
  EXPECT_EQ(watch.code, 0) << watch.err;
  EXPECT_EQ(std::count(watch.out.begin(), watch.out.end(), '\n'), 3) << watch.out;
  EXPECT_EQ(watch.out.find("skipped"), std::string::npos) << watch.out;
}

}  // namespace
}  // namespace obliq::test
