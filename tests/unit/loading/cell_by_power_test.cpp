// Automatic cells by the power that radars see.
// Automatic cells against the elevation model that they stand for.
// The memory that there is: of the machine, and of control groups of both versions (cgroups(7)).
#include "server/loading/cell_by_power.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <numeric>
#include <string>

#include "server/radar/frame_plan.h"
#include "server/radar/render.h"
#include "terrain/base/memory_limit.h"
#include "terrain/dem/source_error.h"
#include "tests/support/scenes.h"
#include "tests/unit/terrain_files.h"

namespace obliq::test::cell_by_power_test {
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

/// Ridges of 120 m, 2.5 to 3 km from crest to crest, at 300 m a post.
double gentle_alps(double lon, double lat) { return 2000 + 60 * std::sin(235 * lon) * std::cos(235 * lat); }

WorldSpec by_itself(const std::string& dem, double most_posts = 16e6) {
  WorldSpec spec = test::scene(-99.5, 33, 10000, {dem});
  spec.terrain.most_auto_posts = most_posts;
  return spec;
}

bool notes(const World& world, const std::string& part) {
  for (const std::string& note : world.report.notes) {
    if (note.find(part) != std::string::npos) return true;
  }
  return false;
}

TEST(AutoCell, BecomesFinerUntilTheGridFollowsTheModel) {
  const Folder folder;
  const std::string dem = coarse(folder, gentle_alps);
  const World before = load_world(by_itself(dem, 0));
  EXPECT_NEAR(before.grid.cell_m, 299, 5);  // the root of 275 x 326 m
  EXPECT_GT(before.report.source_error.p95_m, 1);
  const World after = load_world(by_itself(dem));
  EXPECT_LE(after.report.source_error.p95_m, 0.5);
  EXPECT_NEAR(std::remainder(std::log2(before.grid.cell_m / after.grid.cell_m), 1.0), 0, 0.02) << "halves";
  EXPECT_TRUE(notes(after, "terrain.cell_m = \"auto\""));
}

TEST(AutoCell, OfANamedSizeStays) {
  const Folder folder;
  WorldSpec spec = by_itself(coarse(folder, gentle_alps));
  spec.terrain.cell_m = 250;
  EXPECT_EQ(load_world(spec).grid.cell_m, 250);
}

TEST(AutoCell, OverPlainsStaysAtThePosting) {
  const Folder folder;
  const auto plain = [](double lon, double lat) { return 100 + 3 * lon + 2 * lat; };
  const World world = load_world(by_itself(coarse(folder, plain)));
  EXPECT_NEAR(world.grid.cell_m, 299, 5);
  EXPECT_FALSE(notes(world, "cell_m"));
}

TEST(AutoCell, ThatStopsEarlySaysWhyAndWhatIsLeft) {
  const Folder folder;
  const std::string dem = coarse(folder, gentle_alps);
  const World few = load_world(by_itself(dem, 30000));
  EXPECT_LE(few.grid.y_m.size(), 30000u);
  EXPECT_TRUE(notes(few, "flight.max_megaposts"));
  EXPECT_TRUE(notes(few, "of the grid; wanted: 0.5 m"));
  WorldSpec slow = by_itself(dem);
  slow.sampling_footprint_m = 150;  // finer cells are most of the march
  EXPECT_TRUE(notes(load_world(slow), "times the frame time"));
}

TEST(AutoCell, IsTheSameFromTheCache) {
  const Folder folder;
  WorldSpec spec = by_itself(coarse(folder, gentle_alps));
  const World plain = load_world(spec);
  std::filesystem::last_write_time(spec.terrain.dem[0],
                                   std::filesystem::file_time_type::clock::now() - std::chrono::hours(1));
  spec.terrain.cache_folder = folder.file("cache");
  for (int k = 0; k < 2; ++k) {
    const World world = load_world(spec);
    EXPECT_EQ(world.grid.cell_m, plain.grid.cell_m);
    EXPECT_EQ(world.grid.y_m, plain.grid.y_m);
  }
}

TEST(AutoCell, HalvingTakesTheTimeThatWasMeasured) {
  // The sweep of source_error.cpp: range bins of 18.55 m, half of which is the footprint.
  EXPECT_NEAR(halving_time(60, 9.28), 268.0 / 184, 0.1);
  EXPECT_NEAR(halving_time(30, 9.28), 472.0 / 268, 0.2);
  EXPECT_NEAR(halving_time(15, 9.28), 862.0 / 472, 0.2);
}

TEST(AutoCell, AllowsHalfTheModelsOwnErrorAndHalfAMetreAtLeast) {
  EXPECT_EQ(allowed_error_m({"", 0}), 0.5);
  EXPECT_EQ(allowed_error_m({"", 0.1}), 0.5);
  EXPECT_EQ(allowed_error_m({"", 5.5}), 2.75);
}

TEST(AutoCell, KnowsModelsByNameFormatAndPosting) {
  const Folder folder;
  const auto rmse_m = [&](const std::string& name, double pixel_deg, const char* type) {
    test::RasterPlan plan = test::around(-99.5, 33, [](double, double) { return 1; });
    plan.geotransform = {-99.5, pixel_deg, 0, 33, 0, -pixel_deg};
    plan.type = type;
    return dem_accuracy(Raster(test::write_raster(folder, name, plan), "[terrain] dem", {})).rmse_m;
  };
  EXPECT_EQ(rmse_m("NASADEM_HGT_n34w119.tif", 1 / 3600.0, "Int16"), 3.66);
  EXPECT_EQ(rmse_m("USGS_13_n34w119.tif", 1 / 10800.0, "Float32"), 0.82);
  EXPECT_EQ(rmse_m("mine.tif", 1 / 3600.0, "Int16"), 5.5);
  EXPECT_EQ(rmse_m("mine.tif", 1 / 3600.0, "Float32"), 1.55);
  EXPECT_EQ(rmse_m("mine.tif", 1e-5, "Float32"), 0.10);
  EXPECT_EQ(rmse_m("mine.tif", 0.01, "Float32"), 0) << "nobody knows";
}

namespace fs = std::filesystem;

constexpr double kInfinite = std::numeric_limits<double>::infinity();

class MemoryLimit : public testing::Test {
 protected:
  MemoryLimit()
      : folder_(
            fs::path(testing::TempDir()) /
            ("memory_limit_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()))),
        files_{folder_ / "meminfo", folder_ / "cgroup", folder_ / "sys"} {
    fs::remove_all(folder_);
    write("meminfo", "MemTotal:        8000000 kB\nMemFree:          100000 kB\n");
  }
  ~MemoryLimit() override { fs::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << text;
  }
  std::int64_t there_is() const { return memory_there_is_bytes(files_); }

  static constexpr std::int64_t kMachine = 8'000'000LL * 1024;

  fs::path folder_;
  MemoryFiles files_;
};

TEST_F(MemoryLimit, IsTheMachinesOutsideOfGroups) { EXPECT_EQ(there_is(), kMachine); }

TEST_F(MemoryLimit, IsTheLeastOfTheGroupsThatTheProcessIsIn) {
  write("cgroup", "0::/system.slice/obliqd.service\n");
  write("sys/system.slice/obliqd.service/memory.max", "max\n");
  write("sys/system.slice/obliqd.service/memory.high", "max\n");
  EXPECT_EQ(there_is(), kMachine);
  write("sys/system.slice/memory.max", "4000000000\n");
  EXPECT_EQ(there_is(), 4'000'000'000);
  write("sys/system.slice/obliqd.service/memory.max", "3000000000\n");
  EXPECT_EQ(there_is(), 3'000'000'000);
  write("sys/system.slice/obliqd.service/memory.high", "2000000000\n");
  EXPECT_EQ(there_is(), 2'000'000'000);
  write("sys/system.slice/other.service/memory.max", "1000\n");
  EXPECT_EQ(there_is(), 2'000'000'000);
}

TEST_F(MemoryLimit, OfAContainerIsThatOfTheRootThatItSees) {
  write("cgroup", "0::/\n");
  write("sys/memory.max", "1500000000\n");
  EXPECT_EQ(there_is(), 1'500'000'000);
}

TEST_F(MemoryLimit, OfVersionOneStandsBelowItsController) {
  write("cgroup", "9:cpu,cpuacct:/a\n4:memory:/docker/0123\n0::/\n");
  write("sys/memory/memory.limit_in_bytes", "9223372036854771712\n");
  EXPECT_EQ(there_is(), kMachine);
  write("sys/memory/docker/0123/memory.limit_in_bytes", "500000000\n");
  EXPECT_EQ(there_is(), 500'000'000);
  write("cgroup", "9:cpu,cpuacct:/a\n4:blkio,memory:/of_the_host/0123\n0::/\n");
  EXPECT_EQ(there_is(), kMachine) << "the host's name, which is not seen in here";
  write("sys/memory/memory.limit_in_bytes", "600000000\n");
  EXPECT_EQ(there_is(), 600'000'000);
}

TEST_F(MemoryLimit, OfNothingIsThreeQuartersOfWhatThereIs) {
  EXPECT_EQ(memory_limit_mb(0, files_), 6144);
  EXPECT_EQ(memory_limit_mb(300, files_), 300);
  EXPECT_EQ(memory_limit_mb(kInfinite, files_), kInfinite);
  write("cgroup", "0::/\n");
  write("sys/memory.max", "4000000000\n");
  EXPECT_EQ(memory_limit_mb(0, files_), 3000);
  EXPECT_EQ(memory_limit_mb(5000, files_), 5000) << "what the operator says counts";
}

TEST_F(MemoryLimit, IsNoneWhereTheSystemDoesNotSay) {
  fs::remove(folder_ / "meminfo");
  EXPECT_EQ(there_is(), 0);
  EXPECT_EQ(memory_limit_mb(0, files_), kInfinite);
  write("cgroup", "nonsense\n:\n0:\n0::\n");
  EXPECT_EQ(there_is(), 0);
}

TEST_F(MemoryLimit, OfThisMachineIsKnown) { EXPECT_GT(memory_there_is_bytes(), 100'000'000); }

}  // namespace
}  // namespace obliq::test::cell_by_power_test
