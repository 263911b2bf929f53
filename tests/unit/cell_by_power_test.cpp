// Automatic cells by the power that radars see.
#include "server/loading/cell_by_power.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numeric>

#include "server/radar/frame_plan.h"
#include "server/radar/render.h"
#include "tests/support/scenes.h"
#include "tests/unit/terrain_files.h"

namespace obliq {
namespace {

using test::Folder;

/// Ridges of 800 m, 2.5 to 3 km from crest to crest, at 300 m a post: their crests are cut off.
double alps(double lon, double lat) { return 2000 + 400 * std::sin(235 * lon) * std::cos(235 * lat); }
double plain(double lon, double lat) { return 100 + 3 * lon + 2 * lat; }

std::string coarse(const Folder& folder, const std::function<double(double, double)>& height_m) {
  test::RasterPlan plan = test::around(-99.5, 33, height_m);
  plan.columns = plan.rows = 100;
  plan.geotransform = {-99.5 - 50 / 340.0, 1 / 340.0, 0, 33 + 50 / 340.0, 0, -1 / 340.0};
  return test::write_raster(folder, "dem.tif", plan);
}

/// A radar over the middle whose range bins of 300 m make half the cell look dear.
SceneConfig scene_of(const std::string& dem) {
  SceneConfig config;
  config.world = test::scene(-99.5, 33, 12000, {dem});
  config.world.terrain.most_auto_posts = 16e6;
  config.world.sampling_footprint_m = 150;
  config.materials = test::two_materials();
  config.rays = RayMethod::march;
  RadarConfig radar;
  radar.name = "main";
  radar.settings.sector_deg = 120;
  radar.settings.r_min_m = 2500;
  radar.settings.r_max_m = 11000;
  radar.pose = test::settings_over_origin(3500);
  config.radars = {radar};
  return config;
}

/// Of what `standard` sees of 256 x 256 bins.
double power_over(const SceneConfig& config, World world) {
  RadarSettings s = config.radars[0].settings;
  s.frustum = FrustumKind::sweep;
  s.azimuth_bins = s.range_bins = 256;
  s.pixel_columns = 512;
  const auto scene = test::make_scene(std::move(world));
  std::vector<FieldError> errors;
  const auto pose = place_antenna(scene->world(), config.radars[0].pose, errors);
  if (!pose) throw std::runtime_error(all_text(errors));
  const Frame frame = render(scene, test::snapshot(s), *pose, {0, 256}, {});
  return std::accumulate(frame.bins.power_w.begin(), frame.bins.power_w.end(), 0.0);
}

double power_over_cells(const SceneConfig& config, double cell_m) {
  WorldSpec spec = config.world;
  spec.terrain.cell_m = cell_m;
  return power_over(config, load_world(spec));
}

std::string note_of(const World& world) {
  for (const std::string& note : world.report.notes)
    if (note.find("by power") != std::string::npos) return note;
  return "";
}

TEST(CellByPower, IsHalvedWhereThatMovesTheTotal) {
  const Folder folder;
  const SceneConfig config = scene_of(coarse(folder, alps));
  const World before = load_world(config.world);
  const World after = load_judged_world(config, 1, {});
  EXPECT_LT(after.grid.cell_m, 0.6 * before.grid.cell_m) << note_of(after);
  EXPECT_GE(after.grid.cell_m, 0.24 * before.grid.cell_m);
  const double truth = power_over_cells(config, 18);
  EXPECT_GT(std::abs(power_over(config, before) / truth - 1), kMostPowerMove) << "else nothing is tested";
  // What the next halving would move, and a quarter of that with each one after it (the error is of second
  // order): 4/3 of the limit.
  EXPECT_LT(std::abs(power_over(config, after) / truth - 1), kMostPowerMove * 4 / 3) << note_of(after);
}

TEST(CellByPower, OfANamedSizeStays) {
  const Folder folder;
  SceneConfig config = scene_of(coarse(folder, alps));
  config.world.terrain.cell_m = 250;
  const World world = load_judged_world(config, 1, {});
  EXPECT_EQ(world.grid.cell_m, 250);
  EXPECT_EQ(note_of(world), "");
}

TEST(CellByPower, OverPlainsStaysAndSaysSo) {
  const Folder folder;
  const SceneConfig config = scene_of(coarse(folder, plain));
  const World world = load_judged_world(config, 1, {});
  EXPECT_EQ(world.grid.cell_m, load_world(config.world).grid.cell_m);
  EXPECT_NE(note_of(world), "");
}

TEST(CellByPower, StaysWithinPostsAndMemory) {
  const Folder folder;
  SceneConfig config = scene_of(coarse(folder, alps));
  const double cell_m = load_world(config.world).grid.cell_m;
  config.server.max_memory_mb = 1;
  World world = load_judged_world(config, 1, {});
  EXPECT_EQ(world.grid.cell_m, cell_m);
  EXPECT_NE(note_of(world).find("server.max_memory_mb"), std::string::npos) << note_of(world);
  config.server.max_memory_mb = 0;
  config.world.terrain.most_auto_posts = 2.0 * static_cast<double>(world.grid.y_m.size());
  world = load_judged_world(config, 1, {});
  EXPECT_EQ(world.grid.cell_m, cell_m);
  EXPECT_NE(note_of(world).find("flight.max_megaposts"), std::string::npos) << note_of(world);
}

TEST(CellByPower, IsNotJudgedFromBesideTheGround) {
  const Folder folder;
  SceneConfig config = scene_of(coarse(folder, alps));
  config.radars[0].pose.latitude_deg = 35;
  const World world = load_judged_world(config, 1, {});
  EXPECT_EQ(world.grid.cell_m, load_world(config.world).grid.cell_m);
  EXPECT_NE(note_of(world).find("not judged"), std::string::npos) << note_of(world);
}

TEST(CellByPower, OfACoarseModelOfTheRockiesIsWithinThreeThousandths) {
  const auto dem = test::shared_data() / "small" / "rmnp-dem.tif";
  if (!std::filesystem::exists(dem)) GTEST_SKIP() << "no " << dem;
  SceneConfig config = scene_of(dem.string());
  config.world.origin = {-105.7, 40.35};
  config.world.reaches = {{config.world.origin, 24000}};
  config.world.sampling_footprint_m = 37;
  RadarConfig& radar = config.radars[0];
  radar.pose.latitude_deg = 40.35;
  radar.pose.longitude_deg = -105.7;
  radar.pose.height_m = 4600;
  radar.settings.r_min_m = 4000;
  radar.settings.r_max_m = 20000;
  const World world = load_judged_world(config, 1, {});
  const double found = power_over_cells(config, world.grid.cell_m);
  EXPECT_NEAR(found / power_over_cells(config, 15), 1, kMostPowerMove) << note_of(world);
  RecordProperty("note", note_of(world));
  RecordProperty(
      "before",
      std::to_string(power_over(config, load_world(config.world)) / power_over_cells(config, 15) - 1));
}

}  // namespace
}  // namespace obliq
