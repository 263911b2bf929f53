// Automatic cells against the elevation model that they stand for.
#include <gtest/gtest.h>

#include <cmath>

#include "terrain/dem/source_error.h"
#include "tests/unit/terrain_files.h"

namespace obliq {
namespace {

using test::Folder;

/// Ridges of 120 m, 2.5 to 3 km from crest to crest, at 300 m a post.
double alps(double lon, double lat) { return 2000 + 60 * std::sin(235 * lon) * std::cos(235 * lat); }

test::RasterPlan coarse(const std::function<double(double, double)>& height_m) {
  test::RasterPlan plan = test::around(-99.5, 33, height_m);
  plan.columns = plan.rows = 100;
  plan.geotransform = {-99.5 - 50 / 340.0, 1 / 340.0, 0, 33 + 50 / 340.0, 0, -1 / 340.0};
  return plan;
}

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
  const std::string dem = test::write_raster(folder, "alps.tif", coarse(alps));
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
  WorldSpec spec = by_itself(test::write_raster(folder, "alps.tif", coarse(alps)));
  spec.terrain.cell_m = 250;
  EXPECT_EQ(load_world(spec).grid.cell_m, 250);
}

TEST(AutoCell, OverPlainsStaysAtThePosting) {
  const Folder folder;
  const auto plain = [](double lon, double lat) { return 100 + 3 * lon + 2 * lat; };
  const World world = load_world(by_itself(test::write_raster(folder, "plain.tif", coarse(plain))));
  EXPECT_NEAR(world.grid.cell_m, 299, 5);
  EXPECT_FALSE(notes(world, "cell_m"));
}

TEST(AutoCell, ThatStopsEarlySaysWhyAndWhatIsLeft) {
  const Folder folder;
  const std::string dem = test::write_raster(folder, "alps.tif", coarse(alps));
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
  WorldSpec spec = by_itself(test::write_raster(folder, "alps.tif", coarse(alps)));
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

}  // namespace
}  // namespace obliq
