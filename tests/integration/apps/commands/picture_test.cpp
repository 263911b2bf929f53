// Pictures by the real programs: of a stream, with a scale of one's own, placed by the ground's heights.
// Every option of obliq that is a number refuses what is none that can be meant, before anything else
// happens.
// obliq render --profile: a frame's time by stage. What is asserted are sums and bits, never how long
// anything takes.
// `obliq query` against a real daemon over ground whose shape is known.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>

#include "terrain/base/text.h"
#include "tests/integration/daemon.h"

namespace obliq::test::picture_test {
namespace {

class PictureCommands : public ProgramTest {
 protected:
  void refused(const std::vector<std::string>& arguments, const std::string& part) const {
    const Outcome outcome = obliq(arguments);
    EXPECT_EQ(outcome.code, 1) << arguments[0] << ": " << outcome.err;
    EXPECT_NE(outcome.err.find(part), std::string::npos) << arguments[0] << ": " << outcome.err;
  }

  std::string scene = folder.write("scene.toml", text_of(SmallScene{}));
};

/// Width and height as a PNG's first chunk says them; 0 x 0 for what is none.
std::pair<int, int> size_of_png(const std::filesystem::path& file) {
  const std::string bytes = text_of(file);
  if (bytes.size() < 24 || bytes.substr(1, 3) != "PNG" || bytes.substr(12, 4) != "IHDR") return {0, 0};
  const auto number = [&](std::size_t at) {
    int value = 0;
    for (std::size_t k = 0; k < 4; ++k) value = value << 8 | static_cast<unsigned char>(bytes[at + k]);
    return value;
  };
  return {number(16), number(20)};
}

TEST_F(PictureCommands, WatchKeepsOneWholePictureAndNothingElse) {
  const Daemon daemon({"--config", scene}, folder.path());
  ASSERT_NE(daemon.address(), "") << daemon.log();
  const std::filesystem::path place = folder / "shown";
  const Outcome watched = obliq({"watch", "--server", daemon.address(), "--rate", "20", "--frames", "3",
                                 "--picture", place / "radar.png", "--picture-side", "900"});
  ASSERT_EQ(watched.code, 0) << watched.err;
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(place), {}), 1);
  const auto [width, height] = size_of_png(place / "radar.png");
  EXPECT_GT(std::max(width, height), 900);
  EXPECT_LT(std::max(width, height), 1400);

  const std::vector<std::string> watch = {"watch", "--server", daemon.address(), "--frames", "1"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), watch.begin(), watch.end());
    return more;
  };
  refused(with({"--picture", place}), "a folder; allowed: a file");
  refused(with({"--picture", place / "a.png", "--planes", "count"}), "iq, power or video among them");
  refused(with({"--picture", place / "a.png", "--picture-side", "0"}), "100");
  refused(with({"--ortho", "--out", place}), "allowed: with `obliq render`");
  refused({"get", "--server", daemon.address(), "--out", place, "--ortho"}, "allowed: with `obliq render`");
  for (const std::string bad : {"", "30", "30:20", "20:20", "a:b", "0:nan", "0:1e9"})
    refused({"get", "--server", daemon.address(), "--out", place, "--db-range=" + bad},
            bad.empty() ? "--db-range" : "--db-range: found \"" + bad + "\"; allowed: LOW:HIGH in dB");
  EXPECT_EQ(obliq({"get", "--server", daemon.address(), "--out", place, "--db-range", "-20:30"}).code, 0);
}

TEST_F(PictureCommands, RenderPlacesTheMapByTheHeightsOfTheGroundAndSaysSo) {
  ASSERT_EQ(obliq({"render", scene, "--out", folder / "plain"}).code, 0);
  const Outcome ortho = obliq({"render", scene, "--out", folder / "placed", "--ortho"});
  ASSERT_EQ(ortho.code, 0) << ortho.err;
  const std::string plain = text_of(folder / "plain" / "ground_map.tif");
  const std::string placed = text_of(folder / "placed" / "ground_map.tif");
  EXPECT_NE(plain.find("as if all ground lay"), std::string::npos);
  EXPECT_NE(placed.find("by the heights of the ground"), std::string::npos);
  for (const char* same : {"bins.npy", "power.npy", "ground_map.png"})
    EXPECT_TRUE(text_of(folder / "plain" / same) == text_of(folder / "placed" / same)) << same;
}

struct NumberOption {
  std::string command;
  std::string option;
  std::string allowed;
  bool takes_zero = true;
};

const std::string kFrames = "a whole number from 0 to 1000000000000";
const std::string kSeconds = "a whole number from 0 to 86400";
const std::string kThreads = "a whole number from 0 to 1024";
const std::string kRate = "a number from 0.001 to 100";

const std::vector<NumberOption> kOptions = {
    {"get", "--wait", kSeconds},
    {"watch", "--rate", kRate, false},
    {"watch", "--frames", kFrames},
    {"watch", "--wait", kSeconds},
    {"watch", "--reconnect", kSeconds},
    {"record", "--rate", kRate, false},
    {"record", "--frames", kFrames},
    {"record", "--seconds", "a number from 0 to 1000000000"},
    {"record", "--reconnect", kSeconds},
    {"replay", "--frames", kFrames},
    {"replay", "--port", "a whole number from 0 to 65535"},
    {"replay", "--speed", "0.01 to 1000000 recorded seconds in a second, or max", false},
    {"cat240", "--rate", kRate, false},
    {"render", "--threads", kThreads},
    {"explain", "--threads", kThreads},
    {"frontier", "--threads", kThreads},
    {"frontier", "--azimuths", "a whole number from 0 to 8192"},
    {"frontier", "--pixels", "a whole number from 1 to 16384", false},
    {"frontier", "--cells", "a number from 0.03125 to 10000", false},
    {"frontier", "--repeats", "a whole number from 1 to 1000", false},
    {"frontier", "--truth-planes", "a whole number from 1 to 65536", false},
    {"frontier", "--truth-planes-limit", "a whole number from 1 to 65536", false},
    {"frontier", "--truth-step", "a number from 0.001 to 1000", false},
    {"frontier", "--stop-after", "a whole number from 0 to 100000"},
    {"health", "--timeout", "a number from 0.1 to 3600", false},
};

/// What else a command needs so that the option is what is wrong.
std::vector<std::string> line_of(const std::string& command, const std::string& option,
                                 const std::string& value) {
  std::vector<std::string> words = {command, option + "=" + value};
  if (value.empty()) words = {command, option, value};
  if (command == "get" || command == "record") words.insert(words.end(), {"--out", "out"});
  if (command == "cat240") words.insert(words.end(), {"--to", "127.0.0.1:8600"});
  if (command == "health") words.insert(words.end(), {"--config", "none.toml"});
  if (command == "replay" || command == "render" || command == "explain" || command == "frontier") {
    words.emplace_back("none");
  }
  if (option == "--port") words.emplace_back("--serve");
  return words;
}

using NumberOptions = ProgramTest;

TEST_F(NumberOptions, RefuseWhatIsNoNumberWithTheirNameWhatWasFoundAndWhatIsAllowed) {
  for (const NumberOption& option : kOptions) {
    std::vector<std::string> wrong = {"nan", "-1", "1e300"};
    if (!option.takes_zero) wrong.emplace_back("0");
    if (option.command == "record" && option.takes_zero)
      wrong.insert(wrong.end(), {"", "inf", "5x", " 5", "0x10"});
    for (const std::string& value : wrong) {
      const Outcome outcome = obliq(line_of(option.command, option.option, value));
      EXPECT_EQ(outcome.code, 1) << option.command << " " << option.option << " " << value;
      EXPECT_NE(outcome.err.find("obliq: " + option.option + ": found \"" + value +
                                 "\"; allowed: " + option.allowed),
                std::string::npos)
          << option.command << " " << option.option << " " << value << ": " << outcome.err;
    }
  }
}

constexpr auto kTown =
    R"({"type": "Polygon", "coordinates": [[[-99.52, 33.02], [-99.48, 33.02], [-99.48, 33.06], [-99.52, 33.06],
        [-99.52, 33.02]]]})";

std::string scene_text(const std::string& frustum) {
  return R"([terrain]
synthetic = "hills"
cell_m = 100
[[prisms]]
within = "town.geojson"
per_km2 = 20
[antenna]
latitude_deg = 33.0
longitude_deg = -99.5
height_m = 1400
[radar]
sector_deg = 90
r_min_m = 1500
r_max_m = 8000
[bins]
azimuth = 40
range = 64
[frustum]
pixels = 256
)" + frustum;
}

struct Case {
  const char* name;
  const char* frustum;
  std::set<std::string> stages;  ///< of its own, besides those of every frame
};

const Case kCases[] = {
    {"nearest", "kind = \"oblique\"\nplates = \"nearest\"\n", {"rays", "trace", "refine", "scatter"}},
    {"spread", "kind = \"symmetric\"\n", {"rays", "trace", "refine", "plates", "scatter"}},
    {"sweep", "kind = \"sweep\"\n", {"ground", "buildings"}},
};

class ProfileOf : public ProgramTest, public testing::WithParamInterface<Case> {
 protected:
  nlohmann::json profiled(const std::string& out) {
    const Outcome outcome = obliq({"render", scene_, "--out", folder / out, "--threads", "2", "--profile"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    words_ = outcome.err;
    return nlohmann::json::parse(text_of(folder / out / "timing.json"))["profile"];
  }

  std::string town_ = folder.write("town.geojson", kTown);
  std::string scene_ = folder.write("scene.toml", scene_text(GetParam().frustum));
  std::string words_;  ///< on stderr
};

TEST_P(ProfileOf, ItsPartsAddUpToTheFrameAndEveryStageTookTime) {
  const nlohmann::json profile = profiled("frame");
  const nlohmann::json& frame = profile["frame"];
  EXPECT_EQ(frame["threads"], 2);
  double sum_s = 0, shares = 0;
  std::set<std::string> stages;
  for (const auto& [name, part] : frame["stages"].items()) {
    stages.insert(name);
    sum_s += part["s"].get<double>();
    shares += part["share"].get<double>();
    EXPECT_GT(part["s"].get<double>(), 0) << name;
    EXPECT_NE(words_.find("  " + name + " "), std::string::npos) << name << " is not in\n" << words_;
  }
  EXPECT_NEAR(sum_s, frame["whole_thread_s"].get<double>(), 1e-9);
  EXPECT_NEAR(frame["whole_thread_s"].get<double>(), 2 * frame["wall_s"].get<double>(), 1e-9);
  EXPECT_NEAR(shares, 1, 1e-9);
  std::set<std::string> expected = GetParam().stages;
  expected.insert({"plan", "bin", "states", "encode", "send", "wait", "other", "idle"});
  EXPECT_EQ(stages, expected);

  const nlohmann::json& scene = profile["scene"];
  double scene_s = 0;
  for (const char* name : {"grid", "outlines", "build"}) EXPECT_GT(scene["stages"][name]["s"], 0) << name;
  for (const auto& [name, part] : scene["stages"].items()) scene_s += part["s"].get<double>();
  EXPECT_NEAR(scene_s, scene["whole_s"].get<double>(), 1e-9);
  EXPECT_GE(profile["probes"]["pairs"], 5);
}

INSTANTIATE_TEST_SUITE_P(Frames, ProfileOf, testing::ValuesIn(kCases),
                         [](const auto& tested) { return tested.param.name; });

class QueryCommand : public ProgramTest {
 protected:
  Outcome query(const std::vector<std::string>& arguments) {
    return obliq({"query", "--server", daemon.address()}, arguments);
  }
  void expect_refused(const std::vector<std::string>& arguments, const std::string& part) {
    const Outcome outcome = query(arguments);
    EXPECT_EQ(outcome.code, 1) << outcome.out;
    EXPECT_NE(outcome.err.find(part), std::string::npos) << part << "\nin: " << outcome.err;
    EXPECT_EQ(outcome.out, "");
  }

  /// A ridge across the north, 5 km from the antenna and nearly as high.
  const SmallScene scene{
      .terrain = "synthetic = \"ridge\"\nshape = { distance_m = 5000.0, height_m = 1400.0 }\n",
      .antenna = "latitude_deg = 33.0\nlongitude_deg = -99.5\n",
      .radars = kTwoRadars};
  Daemon daemon{{"--config", folder.write("scene.toml", text_of(scene))}, folder.path()};
};

TEST_F(QueryCommand, SaysWhatIsThereAndWhetherTheRadarSeesIt) {
  // 7 km north, behind the crest; 2 km south, nothing in the way; 100 km east.
  const Outcome outcome =
      query({"--radar", "nose", "--at", "33.0631,-99.5", "--at", "32.982,-99.5", "--at", "33.0,-98.4"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  std::istringstream lines(outcome.out);
  std::string behind, seen, outside;
  std::getline(lines, behind);
  std::getline(lines, seen);
  std::getline(lines, outside);
  EXPECT_NE(behind.find("is hidden by ground"), std::string::npos) << behind;
  EXPECT_NE(seen.find("is seen"), std::string::npos) << seen;
  EXPECT_NE(seen.find("ground 0.00 m"), std::string::npos) << seen;
  EXPECT_NE(outside.find("beyond the loaded terrain"), std::string::npos) << outside;
}

TEST_F(QueryCommand, TakesFilesOfPointsInManyQueriesAndPrintsTables) {
  std::string points = "latitude,longitude\n# the plain south of the antenna\n";
  for (int k = 0; k < 10500; ++k) points += std::to_string(32.99 - 1e-6 * k) + ",-99.5\n";
  const Outcome outcome = query({"--no-sight", "--csv", "--points", folder.write("points.csv", points)});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  std::istringstream lines(outcome.out);
  std::string line;
  std::getline(lines, line);
  const std::vector<std::string> header = csv_fields(line);
  EXPECT_EQ(header[0], "latitude_deg");
  int count = 0;
  for (; std::getline(lines, line); ++count) {
    const std::vector<std::string> fields = csv_fields(line);
    ASSERT_EQ(fields.size(), header.size()) << line;
    ASSERT_NEAR(std::stod(fields[0]), 32.99 - 1e-6 * count, 1e-9);
    ASSERT_EQ(fields[2], "known");
    ASSERT_EQ(fields[11], "not_asked");
  }
  EXPECT_EQ(count, 10500);
}

TEST_F(QueryCommand, TakesBearingsAndRangesAndAnAntennaOfItsOwn) {
  const Outcome outcome =
      query({"--csv", "--range", "180,3000", "--antenna", "33.0,-99.5,1000", "--height-reference", "ground"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  std::istringstream lines(outcome.out);
  std::string line;
  std::getline(lines, line);
  std::getline(lines, line);
  const std::vector<std::string> fields = csv_fields(line);
  // sqrt(3000^2 - 1000^2) m south; a degree of latitude is 110,898 m at 33 N.
  EXPECT_NEAR(std::stod(fields[0]), 33 - 2828.427 / 110898, 2e-6) << line;
  EXPECT_EQ(fields[11], "visible");
}

TEST_F(QueryCommand, SomePointsHaveHeightsAndOthersNone) {
  const Outcome outcome = query(
      {"--csv", "--at", "33,-99.5", "--at", "33.01,-99.5,2000", "--at", "33.02,-99.5", "--radar", "main"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  std::istringstream lines(outcome.out);
  std::string line;
  std::getline(lines, line);
  for (const auto& [latitude, height_m] : {std::pair{"33", 0.0}, {"33.01", 2000.0}, {"33.02", 0.0}}) {
    ASSERT_TRUE(std::getline(lines, line));
    const std::vector<std::string> fields = csv_fields(line);
    EXPECT_EQ(fields[0], latitude);
    EXPECT_NEAR(std::stod(fields[10]), height_m, 1e-6) << line;
  }
}

TEST_F(QueryCommand, RefusesWhatItCannotAsk) {
  expect_refused({}, "found 0 of --at, --range and --points");
  expect_refused({"--at", "33"}, "--at: found 33; allowed: two or three numbers");
  expect_refused({"--at", "33,-99,nan", "--radar", "main"}, "height_m[0]: found nan");
  expect_refused({"--at", "33,-99", "--radar", "tail"}, "main, nose");
  expect_refused({"--at", "133,-99", "--radar", "main"}, "latitude_deg[0]: found 133; allowed: -90 to 90");
  expect_refused({"--points", "nothing.csv", "--radar", "main"}, "nothing.csv cannot be read");
  expect_refused({"--points", folder.write("bad.csv", "33,-99\n33;-99\n"), "--radar", "main"},
                 "bad.csv:2: found");
  expect_refused({"--points", folder.write("other.txt", "1,s3cret\n"), "--radar", "main"},
                 "other.txt:1: found no point; allowed: two or three numbers");
  expect_refused({"--range", "10,5000", "--no-sight"}, "radar: found none");
  expect_refused({"--at", "33,-99", "--antenna", "33,-99"}, "--antenna: found no height");
  expect_refused({"--at", "33,-99", "--antenna", "33,-99.5,-50"}, "below the ground");
}

}  // namespace
}  // namespace obliq::test::picture_test
