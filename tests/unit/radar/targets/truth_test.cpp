// What a frame says of its targets: where they are, what hides them, what they return from which side.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "server/radar/targets/aspect_table.h"
#include "tests/support/target_scenes.h"
#include "tests/unit/terrain_files.h"

namespace obliq::test::truth_test {
namespace {

TargetTruth truth_of(const TargetScene& scene, const RadarSettings& s, const Target& target,
                     AzimuthRange azimuths = {0, 100000}) {
  const PlanResult planned = plan_frame(scene.shared(), snapshot(s), scene.pose());
  TargetLook look;
  look.truth = true;
  const TargetEchoes echoes(*planned.plan, air_view(planned.plan->looks_at()), {1, {target}}, azimuths, look);
  return echoes.truth().empty() ? TargetTruth{} : echoes.truth().front();
}

/// A wall 200 m high across the way, 4 km to the north.
World walled_world() {
  return made_world(13000, 100, [](double, double z) { return z >= 4000 && z < 4300 ? 900.0 : 0.0; });
}

TEST(TargetTruth, NamesTheBinsAndWhatHides) {
  const TargetScene level(level_world());
  const RadarSettings s = beam_settings();
  const Bin bin = bin_near(s, 0.2, 6000);
  Target target = level.at_range(bin.azimuth_rad, bin.range_m, 0);
  target.size = {20, 0};
  const TargetTruth seen = truth_of(level, s, target);
  EXPECT_EQ(seen.azimuth_bin, bin.azimuth);
  EXPECT_EQ(seen.range_bin, bin.range);
  EXPECT_EQ(seen.share, 1);
  EXPECT_EQ(seen.hidden_by, HiddenBy::nothing);
  EXPECT_NEAR(seen.rcs_m2, 100, 1e-9);
  EXPECT_GT(seen.power_w, 0);

  const TargetScene walled(walled_world());
  target = walled.at(0, 9000, 0);
  target.size = {20, 0, 0, 0, 4};
  const TargetTruth hidden = truth_of(walled, s, target);
  EXPECT_EQ(hidden.share, 0);
  EXPECT_EQ(hidden.power_w, 0);
  EXPECT_EQ(hidden.hidden_by, HiddenBy::ground);
  EXPECT_GE(hidden.range_bin, 0) << "it is where it is, hidden or not";
  target.height_m = 2000;
  EXPECT_EQ(truth_of(walled, s, target).hidden_by, HiddenBy::nothing);
  // Beyond the loaded ground nothing is known to hide it.
  target = level.at(0, 20000, 500);
  const TargetTruth far = truth_of(level, s, target);
  EXPECT_EQ(far.hidden_by, HiddenBy::unknown_ground);
  EXPECT_EQ(far.share, 1);
  EXPECT_EQ(far.range_bin, -1);
}

TEST(TargetTruth, NamesTheStrongestInEachBin) {
  const TargetScene scene(level_world());
  const RadarSettings s = beam_settings();
  const Bin near = bin_near(s, 0.1, 5000), far = bin_near(s, 0.1, 8000);
  Target weak = scene.at_range(near.azimuth_rad, near.range_m, 0);
  weak.size = {10, 0};
  weak.id = (std::uint64_t{5} << 32) + 77;
  Target strong = weak;
  strong.size = {20, 0};
  strong.id = 99;
  Target other = scene.at_range(far.azimuth_rad, far.range_m, 0);
  other.id = 3;
  const TargetSet set{1, {other, strong, weak}};
  RenderOptions options;
  options.targets = &set;
  options.target_ids = true;
  const Frame frame = obliq::render(scene.shared(), snapshot(s), scene.pose(), {0, s.azimuth_bins}, options);
  const auto at = [&](const Bin& bin) {
    return frame.bins
        .target[static_cast<std::size_t>(bin.azimuth) * static_cast<std::size_t>(frame.bins.n_range) +
                static_cast<std::size_t>(bin.range)];
  };
  EXPECT_EQ(at(near), 99u);
  EXPECT_EQ(at(far), 3u);
  EXPECT_EQ(at(bin_near(s, -0.5, 5000)), 0u);
  // A target that is alone has its last 32 bits.
  const TargetSet alone{1, {weak}};
  options.targets = &alone;
  const Frame one = obliq::render(scene.shared(), snapshot(s), scene.pose(), {0, s.azimuth_bins}, options);
  EXPECT_EQ(*std::ranges::max_element(one.bins.target), 77u);
  options.targets = nullptr;
  const Frame none = obliq::render(scene.shared(), snapshot(s), scene.pose(), {0, s.azimuth_bins}, options);
  EXPECT_EQ(none.bins.target.size(), none.bins.state.size());
  EXPECT_EQ(*std::ranges::max_element(none.bins.target), 0u);
  options.target_ids = false;
  EXPECT_TRUE(obliq::render(scene.shared(), snapshot(s), scene.pose(), {0, s.azimuth_bins}, options)
                  .bins.target.empty());
}

TEST(TargetTruth, OfADwellIsOfItsOwnAzimuths) {
  const TargetScene scene(level_world());
  const RadarSettings s = beam_settings();
  const Bin bin = bin_near(s, 0.1, 6000);
  Target target = scene.at_range(bin.azimuth_rad, bin.range_m, 0);
  for (int first = 0; first < s.azimuth_bins; first += 32) {
    const bool is_there = bin.azimuth >= first && bin.azimuth < first + 32;
    EXPECT_EQ(truth_of(scene, s, target, {first, 32}).id == 1, is_there) << first;
  }
}

TEST(TargetTruth, ClosesAsTargetAndAntennaDo) {
  TargetScene scene(level_world());
  const RadarSettings s = beam_settings();
  Target target = scene.at(0, 6000, 1000);  // as high as the antenna, straight ahead
  target.velocity_m_s = {0, 0, -200};
  EXPECT_NEAR(truth_of(scene, s, target).closing_m_s, 200, 0.05);
  scene.pose().settings.velocity_north_m_s = 150;
  EXPECT_NEAR(truth_of(scene, s, target).closing_m_s, 350, 0.05);
  target.velocity_m_s = {0, 0, 150};
  EXPECT_NEAR(truth_of(scene, s, target).closing_m_s, 0, 0.05);
  scene.pose().settings.velocity_east_m_s = 100;
  EXPECT_NEAR(truth_of(scene, s, target).closing_m_s, 0, 0.05) << "across the sight";
}

class Aspects : public testing::Test {
 protected:
  std::string write(const std::string& rows) const {
    return folder_.text("rcs.csv", "aspect_deg,elevation_deg,rcs_dbsm\n" + rows);
  }
  std::string complaint(const std::string& rows) {
    try {
      (void)AspectTable::read(write(rows));
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  Folder folder_;
};

TEST_F(Aspects, AreLinearInDecibels) {
  const AspectTable round = AspectTable::read(
      write("0,-10,0\n0,10,4\n90,-10,10\n90,10,14\n180,-10,20\n180,10,24\n270,-10,-30\n270,10,-26\n"));
  EXPECT_NEAR(round.rcs_dbsm(45, 0), 7, 1e-12);
  EXPECT_NEAR(round.rcs_dbsm(45 + 720, 5), 8, 1e-12);
  EXPECT_NEAR(round.rcs_dbsm(-45, -10), -15, 1e-12) << "across the nose";
  EXPECT_NEAR(round.rcs_dbsm(315, -60), -15, 1e-12) << "below the table's elevations";
  EXPECT_FALSE(round.is_all_positive());
  const AspectTable sides = AspectTable::read(write("0,0,10\n90,0,30\n180,0,20\n"));
  EXPECT_NEAR(sides.rcs_dbsm(-90, 3), 30, 1e-12);
  EXPECT_NEAR(sides.rcs_dbsm(225, 3), 25, 1e-12);
  EXPECT_NEAR(sides.mean_dbsm(), 10 * std::log10((10 + 1000 + 100) / 3.0), 1e-12);
  EXPECT_TRUE(sides.is_all_positive());
}

TEST_F(Aspects, WithMistakesAreRefusedWithTheirLine) {
  const auto has = [&](const std::string& rows, const std::string& part) {
    const std::string said = complaint(rows);
    EXPECT_NE(said.find(part), std::string::npos) << said;
  };
  has("", "no rows");
  has("0,0,10\n0,0,11\n", "rcs.csv:3");
  has("0,0,10\n0,5,11\n90,0,3\n", "3 rows of 2 aspects and 2 elevations");
  has("361,0,10\n", "rcs.csv:2");
  has("0,91,10\n", "-90 to 90");
  has("0,0,nan\n", "rcs.csv:2");
  has("0,0\n", "rcs.csv:2");
  has("0,0,1,2\n", "aspect_deg,elevation_deg,rcs_dbsm");
  has("0,0,1e3\n", "-100 to 100");
  has(std::string(300, '1'), "more than 200 characters");
}

TEST_F(Aspects, ShowTheSideThatTheAntennaSees) {
  const TargetScene scene(level_world());
  const RadarSettings s = beam_settings();
  Target target = scene.at(0, 6000, 1000);
  target.size = {0, 0};
  target.size.aspects =
      std::make_shared<const AspectTable>(AspectTable::read(write("0,0,10\n90,0,20\n180,0,30\n270,0,40\n")));
  const auto rcs_db = [&](double heading_deg) {
    target.heading_deg = heading_deg;
    return 10 * std::log10(truth_of(scene, s, target).rcs_m2);
  };
  EXPECT_NEAR(rcs_db(180), 10, 0.02) << "its nose";
  EXPECT_NEAR(rcs_db(0), 30, 0.02) << "its stern";
  EXPECT_NEAR(rcs_db(90), 20, 0.02) << "it heads east, and the antenna in the south is on its right";
  EXPECT_NEAR(rcs_db(270), 40, 0.02) << "on its left";
}

}  // namespace
}  // namespace obliq::test::truth_test
