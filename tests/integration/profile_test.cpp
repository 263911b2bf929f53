// obliq render --profile: a frame's time by stage. What is asserted are sums and bits, never how long
// anything takes.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "tests/integration/daemon.h"

namespace obliq::test {
namespace {

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
    {"nearest", "kind = \"oblique\"\nplates = \"nearest\"\n", {"rays", "trace", "refine"}},
    {"spread", "kind = \"symmetric\"\n", {"rays", "trace", "refine", "plates"}},
    {"sweep", "kind = \"sweep\"\n", {"ground", "buildings"}},
};

class ProfileOf : public testing::TestWithParam<Case> {
 protected:
  nlohmann::json profiled(const std::string& out) {
    const Outcome outcome = run_program(
        OBLIQ_PROGRAM, {"render", scene_, "--out", folder_.path() / out, "--threads", "2", "--profile"},
        folder_.path());
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    words_ = outcome.err;
    return nlohmann::json::parse(text_of(folder_.path() / out / "timing.json"))["profile"];
  }

  TestFolder folder_;
  std::string town_ = folder_.write("town.geojson", kTown);
  std::string scene_ = folder_.write("scene.toml", scene_text(GetParam().frustum));
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
  expected.insert({"plan", "scatter", "bin", "states", "encode", "send", "wait", "other", "idle"});
  EXPECT_EQ(stages, expected);

  const nlohmann::json& scene = profile["scene"];
  double scene_s = 0;
  for (const char* name : {"grid", "outlines", "build"}) EXPECT_GT(scene["stages"][name]["s"], 0) << name;
  for (const auto& [name, part] : scene["stages"].items()) scene_s += part["s"].get<double>();
  EXPECT_NEAR(scene_s, scene["whole_s"].get<double>(), 1e-9);
  EXPECT_GE(profile["probes"]["pairs"], 5);
}

TEST_P(ProfileOf, TheFrameHasTheSameBits) {
  profiled("with");
  const Outcome plain =
      run_program(OBLIQ_PROGRAM, {"render", scene_, "--out", folder_.path() / "without", "--threads", "2"},
                  folder_.path());
  ASSERT_EQ(plain.code, 0) << plain.err;
  EXPECT_EQ(plain.err.find("idle"), std::string::npos);
  for (const char* name : {"bins.npy", "power.npy", "count.npy", "state.npy", "frame.json", "ground_map.png"})
    EXPECT_TRUE(text_of(folder_.path() / "with" / name) == text_of(folder_.path() / "without" / name))
        << name;
}

INSTANTIATE_TEST_SUITE_P(Frames, ProfileOf, testing::ValuesIn(kCases),
                         [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace obliq::test
