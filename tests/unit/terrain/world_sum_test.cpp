// The sum of what a world is made from: it tells other sources and other keys, and nothing else.
#include "terrain/world_sum.h"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>

#include "tests/unit/terrain_files.h"

namespace obliq::world_sum_test {
namespace {

using test::Folder;

class WorldSum : public testing::Test {
 protected:
  WorldSum() {
    spec = test::scene(-99.5, 33, 3000, {folder.text("dem.asc", "heights")});
    spec.buildings.push_back({folder.text("towns.geojson", "outlines"), "", "height", "", 8.0, 1});
  }
  std::string sum() const { return world_sum(spec, spec.terrain.dem); }

  Folder folder;
  WorldSpec spec;
};

TEST_F(WorldSum, HasThirtyTwoDigitsAndIsTheSameAgain) {
  EXPECT_EQ(sum().size(), 32u);
  EXPECT_EQ(sum(), sum());
}

TEST_F(WorldSum, OneByteOfASourceMakesAnother) {
  const std::string before = sum();
  folder.text("dem.asc", "heighty");
  EXPECT_NE(sum(), before);
  folder.text("dem.asc", "heights");
  EXPECT_EQ(sum(), before);
  folder.text("towns.geojson", "outlines.");
  EXPECT_NE(sum(), before);
}

TEST_F(WorldSum, AByteInTheMiddleOfAFileOfManyPiecesMakesAnother) {
  std::string large(5'000'000, 'x');
  folder.text("dem.asc", large);
  const std::string before = sum();
  large[3'333'333] = 'y';
  folder.text("dem.asc", large);
  EXPECT_NE(sum(), before);
}

TEST_F(WorldSum, ADatabaseBesideAShapefileCounts) {
  spec.buildings[0].source = folder.text("towns.shp", "outlines");
  folder.text("towns.dbf", "heights of 4 m");
  const std::string before = sum();
  folder.text("towns.dbf", "heights of 5 m");
  EXPECT_NE(sum(), before);
}

TEST_F(WorldSum, AnotherNameOrTimeOfTheSameContentsMakesNoOther) {
  const std::string before = sum();
  std::filesystem::rename(spec.terrain.dem[0], folder.file("moved.asc"));
  spec.terrain.dem[0] = folder.file("moved.asc");
  std::filesystem::last_write_time(spec.terrain.dem[0],
                                   std::filesystem::file_time_type::clock::now() - std::chrono::hours(9));
  EXPECT_EQ(sum(), before);
}

TEST_F(WorldSum, KeysThatShapeTheWorldMakeAnother) {
  const std::string before = sum();
  const auto other = [&](auto change) {
    const WorldSpec kept = spec;
    change();
    const std::string found = sum();
    spec = kept;
    return found != before;
  };
  EXPECT_TRUE(other([&] { spec.radius_factor = 1; }));
  EXPECT_TRUE(other([&] { spec.terrain.unit = VerticalUnit::foot; }));
  EXPECT_TRUE(other([&] { spec.terrain.fill_void_m = 0; }));
  EXPECT_TRUE(other([&] { spec.terrain.water_material = std::uint8_t{2}; }));
  EXPECT_TRUE(other([&] { spec.buildings[0].default_height_m = 9; }));
  EXPECT_TRUE(other([&] { spec.buildings[0].height_field = "levels"; }));
  EXPECT_TRUE(other([&] { spec.prisms.emplace_back(); }));
  EXPECT_TRUE(other([&] { spec.surfaces.emplace_back().source = spec.buildings[0].source; }));
}

TEST_F(WorldSum, TheHeightsOfScatteredPrismsCount) {
  spec.prisms.emplace_back();
  const std::string before = sum();
  spec.prisms[0].height_m = {40, 60};
  EXPECT_NE(sum(), before);
}

TEST_F(WorldSum, GammaRastersCountByContentsAndMeaning) {
  spec.surfaces.emplace_back().gamma_raster = folder.text("fields.tif", "decibels");
  const std::string before = sum();
  spec.surfaces[0].raster_is_gamma = true;
  EXPECT_NE(sum(), before);
  spec.surfaces[0].raster_is_gamma = false;
  folder.text("fields.tif", "decibelz");
  EXPECT_NE(sum(), before);
}

TEST_F(WorldSum, WhatIsLoadedOfTheWorldMakesNoOther) {
  const std::string before = sum();
  spec.reaches.push_back({{-99, 33.5}, 9000});
  spec.terrain.area = {{-99, 33}, {-98, 33}, {-98, 34}};
  spec.terrain.cell_m = 5;
  spec.sampling_footprint_m = 3;
  spec.origin = {-98, 34};
  EXPECT_EQ(sum(), before);
}

TEST_F(WorldSum, MadeUpGroundIsAnchored) {
  spec.terrain.dem.clear();
  spec.terrain.synthetic = SyntheticKind::hills;
  const std::string before = sum();
  const LonLat first = spec.origin;
  spec.origin = {-98, 34};
  EXPECT_NE(sum(), before);
  spec.terrain.shape.anchor = first;
  EXPECT_EQ(sum(), before);
}

}  // namespace
}  // namespace obliq::world_sum_test
