// The ends of what materials, wavelengths and transmitters may be: no NaN, no infinity, sensible zeros, in
// every plane, picture and file.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "proto/obliq.pb.h"
#include "server/control/parameters.h"
#include "server/output/describe_frame.h"
#include "server/output/frame_files.h"
#include "server/output/ground_map.h"
#include "server/radar/frame_plan.h"
#include "tests/support/made_worlds.h"
#include "tests/support/npy.h"
#include "tests/support/samplings.h"
#include "tests/support/sane_frames.h"
#include "tests/support/scenes.h"

namespace obliq::materials_test {
namespace {

namespace fs = std::filesystem;

constexpr double kLeast = 5e-324;

/// Two hills, a cliff and a few houses, on the effective earth's own frame so that files have all they need.
World town() {
  World world = test::made_world(4000, 100, [](double x, double z) {
    return 60 * std::sin(x / 500) * std::cos(z / 700) + (z > 2500 ? 150.0 : 0.0);
  });
  for (int k = 0; k < 12; ++k)
    test::add_prism(world, test::rectangle(-1500 + 260.0 * k, 1400 + 90.0 * k, 40, 30), 10.0 + k);
  return world;
}

RadarSettings settings() {
  RadarSettings s = test::radar_settings(FrustumKind::oblique, {1000, 3900, 70}, {9, 24}, {45, 60});
  s.sub_columns = 0;  // whose floats keep no tiny powers, and count no ground that is dark
  return s;
}

struct Case {
  const char* name;
  Material ground, building;
  bool dark;  ///< nothing scatters at all
};

std::vector<Case> cases() {
  const Material diffuse = test::two_materials()[0];
  const Material specular = test::two_materials()[1];
  std::vector<Case> all;
  const auto add = [&](const char* name, bool dark, const auto& change) {
    Case one{name, diffuse, specular, dark};
    change(one);
    all.push_back(one);
  };
  add("as shipped", false, [](Case&) {});
  add("zero reflectivity and no floor", true, [](Case& c) {
    c.ground.gamma = 0;
    c.building.gamma = 0;
    c.building.reflectivity = 0;
  });
  add("zero reflectivity over a floor", false, [](Case& c) { c.building.reflectivity = 0; });
  add("gamma of a million", false, [](Case& c) { c.ground.gamma = c.building.gamma = 1e6; });
  add("least gamma", false, [](Case& c) { c.ground.gamma = c.building.gamma = 1e-20; });
  add("mirror", false, [](Case& c) {
    c.ground = c.building;
    c.ground.rms_slope = c.building.rms_slope = 0.001;
    c.ground.reflectivity = c.building.reflectivity = 1;
  });
  add("roughest", false, [](Case& c) {
    c.ground = c.building;
    c.ground.rms_slope = c.building.rms_slope = 10;
  });
  add("largest plates", false, [](Case& c) {
    c.ground.model = c.building.model = ScatteringModel::flat_plate;
    c.ground.plate_tau = c.building.plate_tau = 1e6;
  });
  add("plates of the steepest law", false, [](Case& c) {
    c.ground.model = c.building.model = ScatteringModel::flat_plate;
    c.ground.plate_exponent = c.building.plate_exponent = 1000;
  });
  add("plates of tau 0", true, [](Case& c) {
    c.ground.model = c.building.model = ScatteringModel::flat_plate;
    c.ground.plate_tau = c.building.plate_tau = 0;
  });
  return all;
}

bool has_plates(const Case& c) { return c.ground.model == ScatteringModel::flat_plate; }

/// Only what must hold for flat plates, whose power grows with the square of a pixel's solid angle.
double total_power(const Frame& frame) {
  double total = 0;
  for (std::size_t k = 0; k < frame.bins.power_w.size(); ++k) {
    EXPECT_TRUE(std::isfinite(frame.bins.power_w[k]) && frame.bins.power_w[k] >= 0);
    EXPECT_TRUE(std::isfinite(frame.bins.iq[k].real()) && std::isfinite(frame.bins.iq[k].imag()));
    total += frame.bins.power_w[k];
  }
  return total;
}

TEST(HardMaterials, EveryEndOfTheirRangesGivesFiniteBinsAndExactZerosWhereNothingScatters) {
  const auto world = std::make_shared<const World>(town());
  for (const Case& c : cases()) {
    const auto scene = std::make_shared<const Scene>(world, std::vector<Material>{c.ground, c.building}, 0);
    const Pose pose = test::pose_at(*world, {13, 900, -7}, 20);
    for (const test::Sampling& sampling : test::kSamplings) {
      if (has_plates(c) && !sampling.rays()) continue;
      for (const double frequency_ghz : {0.03, 10.0, 300.0}) {  // wavelengths 10 m, 3 cm, 1 mm
        for (const auto& [power_w, gain_db] :
             {std::pair{1.0, 0.0}, {0.0, 0.0}, {0.0, 100.0}, {1e12, 100.0}, {kLeast, -100.0}}) {
          for (const bool normalised : {false, true}) {
            for (const SpeckleKind speckle : {SpeckleKind::ground, SpeckleKind::geometric}) {
              if (speckle == SpeckleKind::geometric && !sampling.rays()) continue;
              RadarSettings s = test::sampled(settings(), sampling);
              s.frequency_ghz = frequency_ghz;
              s.power_w = power_w;
              s.gain_db = gain_db;
              s.range_normalisation = normalised;
              s.speckle = speckle;
              ASSERT_TRUE(validate(s).empty()) << validate(s).front().text();
              SCOPED_TRACE(std::string(c.name) + ", " + sampling.name + ", " + std::to_string(frequency_ghz) +
                           " GHz, " + std::to_string(power_w) + " W, " + std::to_string(gain_db) + " dB");
              const Frame frame = render(scene, test::snapshot(s), pose, {0, s.azimuth_bins});
              const double total = has_plates(c) ? total_power(frame)
                                                 : test::expect_sane(frame, s, scene->materials()).power_w;
              EXPECT_GT(frame.stats.samples, 500u);
              if (c.dark || power_w == 0) {
                EXPECT_EQ(total, 0);
                for (const std::complex<float>& v : frame.bins.iq) EXPECT_EQ(v, std::complex<float>{});
              } else if (power_w != kLeast && !has_plates(c)) {
                EXPECT_GT(total, 0);
              }
            }
          }
        }
      }
    }
  }
}

TEST(HardMaterials, PowerScalesWithGammaOverTwentySixDecades) {
  // P is proportional to gamma: exactly, but for the rounding of one product a sample.
  const auto world = std::make_shared<const World>(town());
  const Pose pose = test::pose_at(*world, {13, 900, -7}, 20);
  Material one = test::two_materials()[0];
  const auto total = [&](double gamma, const test::Sampling& sampling) {
    one.gamma = gamma;
    const auto scene = std::make_shared<const Scene>(world, std::vector<Material>{one, one}, 0);
    const RadarSettings s = test::sampled(settings(), sampling);
    return total_power(render(scene, test::snapshot(s), pose, {0, s.azimuth_bins}));
  };
  for (const test::Sampling& sampling : test::kSamplings) {
    const double unit = total(1, sampling);
    for (const double gamma : {1e-20, 1e-6, 1e6})
      EXPECT_NEAR(total(gamma, sampling) / gamma / unit, 1, 1e-12) << sampling.name;
  }
}

TEST(HardMaterials, ASilentRadarStillSeesWhereItLooks) {
  // Power 0 is legal: what is lit, shadowed or unknown does not depend on it.
  const auto scene = test::make_scene(town());
  const Pose pose = test::pose_at(scene->world(), {13, 900, -7}, 20);
  for (const test::Sampling& sampling : test::kSamplings) {
    RadarSettings s = test::sampled(settings(), sampling);
    const Frame loud = render(scene, test::snapshot(s), pose, {0, s.azimuth_bins});
    s.power_w = 0;
    const Frame silent = render(scene, test::snapshot(s), pose, {0, s.azimuth_bins});
    EXPECT_EQ(silent.bins.state, loud.bins.state) << sampling.name;
    EXPECT_EQ(silent.bins.count, loud.bins.count) << sampling.name;
    EXPECT_EQ(total_power(silent), 0) << sampling.name;
    EXPECT_GT(total_power(loud), 0) << sampling.name;
  }
}

/// Numbers in a JSON text are finite by the grammar; what stands for others is a word or null. Flat ground's
/// earth is infinite, which is null, and nothing else.
void expect_numbers(const nlohmann::json& json, const std::string& where) {
  EXPECT_TRUE(!json.is_null() || where.ends_with("/radius_factor")) << where;
  if (json.is_string()) {
    for (const char* word : {"nan", "-nan", "inf", "-inf"}) EXPECT_NE(json.get<std::string>(), word) << where;
  }
  if (json.is_structured())
    for (const auto& [key, value] : json.items()) expect_numbers(value, where + "/" + key);
}

/// Transmitter's power and frequency: a test each, as files take their time.
class FilesOfPower : public testing::TestWithParam<std::pair<double, double>> {};

TEST_P(FilesOfPower, HoldNumbersForEveryMaterial) {
  const auto [power_w, frequency_ghz] = GetParam();
  const auto world = std::make_shared<const World>(town());
  const Pose pose = test::pose_at(*world, {13, 900, -7}, 20);
  const fs::path folder = fs::path(testing::TempDir()) / ("obliq_hard_materials_" + std::to_string(getpid()));
  for (const Case& c : cases()) {
    const auto scene = std::make_shared<const Scene>(world, std::vector<Material>{c.ground, c.building}, 0);
    for (const test::Sampling& sampling : test::kSamplings) {
      if (has_plates(c) && !sampling.rays()) continue;
      for (const bool normalised : {false, true}) {
        SCOPED_TRACE(std::string(c.name) + ", " + sampling.name + ", " + std::to_string(power_w) + " W");
        RadarSettings s = test::sampled(settings(), sampling);
        s.power_w = power_w;
        s.frequency_ghz = frequency_ghz;
        s.range_normalisation = normalised;
        const PlanResult planned = plan_frame(scene, test::snapshot(s), pose);
        ASSERT_TRUE(planned.plan);
        const Frame frame = render(scene, test::snapshot(s), pose, {0, s.azimuth_bins});
        wire::FrameDescriptor descriptor;
        wire::FrameSummary summary;
        describe_frame(*planned.plan, "main", "test", descriptor);
        summarise_frame(*planned.plan, frame.stats, summary);
        std::size_t shown = 0;
        for (const float level_db : bin_levels(descriptor, frame.bins).db) {
          EXPECT_TRUE(std::isfinite(level_db));
          shown += level_db != BinLevels::kNoValue ? 1 : 0;
        }
        const bool dark = c.dark || power_w == 0;
        if (dark) {
          EXPECT_EQ(shown, 0u) << "nothing has no decibels";
        } else if (power_w != kLeast) {
          EXPECT_GT(shown, 0u);
        }
        write_frame_files(folder, descriptor, summary, frame.bins);
        std::ifstream text(folder / "frame.json");
        expect_numbers(nlohmann::json::parse(text), "");
        for (const double power : test::read_npy<double>(folder / "power.npy")) {
          EXPECT_TRUE(dark ? power == 0 : std::isfinite(power) && power >= 0);
        }
        const auto parts = test::read_npy<float>(folder / "bins.npy");
        EXPECT_EQ(parts.size(), 2 * frame.bins.iq.size());
        for (const float part : parts) EXPECT_TRUE(dark ? part == 0 : std::isfinite(part));
        EXPECT_GT(fs::file_size(folder / "ground_map.png"), 1000u);
        EXPECT_GT(fs::file_size(folder / "ground_map.tif"), 100u);
      }
    }
  }
  fs::remove_all(folder);
}
INSTANTIATE_TEST_SUITE_P(None, FilesOfPower, testing::Values(std::pair{0.0, 0.03}));
INSTANTIATE_TEST_SUITE_P(Most, FilesOfPower, testing::Values(std::pair{1e12, 0.03}));
INSTANTIATE_TEST_SUITE_P(Usual, FilesOfPower, testing::Values(std::pair{1.0, 300.0}));
INSTANTIATE_TEST_SUITE_P(Least, FilesOfPower, testing::Values(std::pair{kLeast, 10.0}));

}  // namespace
}  // namespace obliq::materials_test
