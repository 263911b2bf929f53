// What plan_frame and place_antenna refuse, and in which words.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>

#include "server/radar/frame_plan.h"
#include "terrain/buildings/footprints.h"
#include "tests/support/scenes.h"

namespace obliq {
namespace {

class PlanTest : public testing::Test {
 protected:
  static std::shared_ptr<const Scene> ridge_scene() {
    WorldSpec spec = test::synthetic_spec(SyntheticKind::ridge, 12000, 100);
    spec.terrain.shape.height_m = 600;
    spec.terrain.shape.distance_m = 6000;
    spec.terrain.shape.width_m = 2000;
    return test::make_scene(load_world(spec));
  }
  static RadarSettings settings(FrustumKind kind) {
    RadarSettings s;
    s.frustum = kind;
    s.r_min_m = 1000;
    s.r_max_m = 10000;
    s.pixel_columns = s.pixel_rows = 64;
    s.azimuth_bins = s.range_bins = 32;
    return s;
  }
  std::shared_ptr<const Scene> scene_ = ridge_scene();
};

TEST_F(PlanTest, ObliqueBelowTheTerrainTopNamesTheSweep) {
  const Pose pose = test::pose_over_origin(scene_->world(), 500);
  const PlanResult result = plan_frame(scene_, test::snapshot(settings(FrustumKind::oblique)), pose);
  ASSERT_EQ(result.errors.size(), 1u);
  EXPECT_EQ(result.errors[0].field, "frustum.kind");
  EXPECT_NE(result.errors[0].found.find("100.00 m below the highest ground"), std::string::npos)
      << result.errors[0].found;
  EXPECT_NE(result.errors[0].allowed.find("frustum.quality = \"standard\", the sweep"), std::string::npos);
  EXPECT_TRUE(plan_frame(scene_, test::snapshot(settings(FrustumKind::sweep)), pose).plan);
}

TEST_F(PlanTest, NearestRangeBelowTheHeightAboveGroundIsRefusedForCamerasOnlyAndEqualityIsLegal) {
  const Pose pose = test::pose_over_origin(scene_->world(), 1000);
  for (FrustumKind kind : {FrustumKind::symmetric, FrustumKind::oblique}) {
    RadarSettings s = settings(kind);
    EXPECT_TRUE(plan_frame(scene_, test::snapshot(s), pose).plan) << "equality";
    s.r_min_m = 999;
    const PlanResult result = plan_frame(scene_, test::snapshot(s), pose);
    ASSERT_EQ(result.errors.size(), 1u);
    EXPECT_EQ(result.errors[0].field, "radar.r_min_m");
    EXPECT_NE(result.errors[0].allowed.find("1000.00 m"), std::string::npos) << result.errors[0].allowed;
  }
  RadarSettings s = settings(FrustumKind::sweep);
  s.r_min_m = 10;
  EXPECT_TRUE(plan_frame(scene_, test::snapshot(s), pose).plan);
}

TEST_F(PlanTest, AntennaUnderTheGroundIsRefusedWithTheGroundsHeight) {
  std::vector<FieldError> errors;
  EXPECT_FALSE(place_antenna(scene_->world(), test::settings_over_origin(-3), errors));
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_EQ(errors[0].text().substr(0, 43), "antenna.height_m: found 3.00 m below the gr");
}

TEST_F(PlanTest, AntennaInsideABuildingIsRefusedAndAboveItsRoofOrBesideItIsNot) {
  const std::string path = testing::TempDir() + "obliq_plan_tower.geojson";
  // A courtyard building of about 200 m with a hole of about 60 m around (33, -99.5), 50 m high.
  std::ofstream(path)
      << R"({"type":"FeatureCollection","features":[{"type":"Feature","properties":{"height":50},
    "geometry":{"type":"Polygon","coordinates":[
      [[-99.501,32.999],[-99.499,32.999],[-99.499,33.001],[-99.501,33.001],[-99.501,32.999]],
      [[-99.5003,32.9997],[-99.5003,33.0003],[-99.4997,33.0003],[-99.4997,32.9997],[-99.5003,32.9997]]]}}]})";
  WorldSpec spec = test::synthetic_spec(SyntheticKind::flat, 3000, 50);
  BuildingSourceSpec source;
  source.source = path;
  spec.buildings = {source};
  const World world = load_world(spec);
  ASSERT_EQ(world.buildings.list.size(), 1u);
  PoseSettings pose = test::settings_over_origin(20);
  pose.longitude_deg = -99.5007;
  std::vector<FieldError> errors;
  EXPECT_FALSE(place_antenna(world, pose, errors));
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_EQ(errors[0].text().substr(0, 63),
            "antenna.height_m: found inside a building, 30.00 m below its ro");
  pose.height_m = 51;
  EXPECT_TRUE(place_antenna(world, pose, errors)) << "above the roof";
  pose.height_m = 20;
  pose.longitude_deg = -99.5;
  EXPECT_TRUE(place_antenna(world, pose, errors)) << "in the courtyard";
  pose.longitude_deg = -99.503;
  EXPECT_TRUE(place_antenna(world, pose, errors)) << "beside it";
}

TEST_F(PlanTest, HeightReferencesMeanWhatTheySay) {
  PoseSettings pose;
  pose.latitude_deg = 33.05;  // on the ridge's near slope, 5.5 km north
  pose.longitude_deg = -99.5;
  std::vector<FieldError> errors;
  pose.height_m = 1000;
  pose.height_reference = HeightReference::datum;
  const double datum_y = place_antenna(scene_->world(), pose, errors)->antenna.m.y;
  pose.height_reference = HeightReference::ground;
  const Pose over_ground = *place_antenna(scene_->world(), pose, errors);
  // The plumb line's own meeting with the ground, by bisection over heights above the datum.
  const Geodetic at{33.05 * std::numbers::pi / 180, -99.5 * std::numbers::pi / 180, 0};
  const auto above = [&](double height_m) {
    const WorldPoint p =
        scene_->world().frame.world_from_geodetic({at.latitude_rad, at.longitude_rad, height_m});
    return p.m.y - scene_->world().grid.height_at_m(p.m.x, p.m.z);
  };
  double low = 0, high = 600;
  for (int k = 0; k < 60; ++k) (above((low + high) / 2) < 0 ? low : high) = (low + high) / 2;
  EXPECT_GT(low, 100);
  EXPECT_NEAR(scene_->world().frame.geodetic_from_world(over_ground.antenna).height_m, low + 1000, 1e-3);
  pose.height_reference = HeightReference::ellipsoid;
  pose.geoid_undulation_m = -27;
  EXPECT_NEAR(place_antenna(scene_->world(), pose, errors)->antenna.m.y - datum_y, 27, 1e-3);
  EXPECT_TRUE(errors.empty());
}

TEST_F(PlanTest, HeightOverUnknownGroundIsRefusedAndADatumHeightThereIsNot) {
  PoseSettings pose;
  pose.latitude_deg = 34;
  pose.longitude_deg = -99.5;
  pose.height_reference = HeightReference::ground;
  std::vector<FieldError> errors;
  EXPECT_FALSE(place_antenna(scene_->world(), pose, errors));
  EXPECT_EQ(errors.at(0).field, "antenna.height_reference");
  pose.height_reference = HeightReference::datum;
  EXPECT_TRUE(place_antenna(scene_->world(), pose, errors));
}

TEST_F(PlanTest, AFrameFarFromAllGroundIsEmptyAndSaysSo) {
  PoseSettings place;
  place.latitude_deg = 35;
  place.longitude_deg = -99.5;
  std::vector<FieldError> errors;
  const Pose pose = *place_antenna(scene_->world(), place, errors);
  for (FrustumKind kind : {FrustumKind::symmetric, FrustumKind::oblique, FrustumKind::sweep}) {
    const Frame frame = render(scene_, test::snapshot(settings(kind)), pose, {0, 32});
    EXPECT_EQ(frame.stats.rays, 0u);
    EXPECT_EQ(frame.stats.samples, 0u);
    EXPECT_EQ(frame.stats.coverage(), 0);
    for (std::uint8_t state : frame.bins.state) EXPECT_EQ(state, static_cast<int>(BinState::no_surface));
  }
}

TEST_F(PlanTest, ARoofWithinReachIsSeenThoughAllGroundIsTooFar) {
  // A tower of 250 m, 100 m away from an antenna at 300 m that sees 200 m far: the ground is out of reach.
  World world = load_world(test::synthetic_spec(SyntheticKind::flat, 2000, 50));
  OutlineShaper shaper;
  const Polygon outline{{{{-30, 80}, {30, 80}, {30, 120}, {-30, 120}}}};
  ASSERT_EQ(stand_outline(world, shaper, outline, {250, 1, 7}), 1u);
  const auto scene = test::make_scene(std::move(world));
  RadarSettings settings;
  settings.frustum = FrustumKind::sweep;
  settings.r_min_m = 20;
  settings.r_max_m = 200;
  settings.azimuth_bins = settings.range_bins = 32;
  settings.pixel_columns = settings.pixel_rows = 64;
  const Pose pose = test::pose_over_origin(scene->world(), 300);
  const PlanResult planned = plan_frame(scene, test::snapshot(settings), pose);
  ASSERT_TRUE(planned.plan);
  EXPECT_TRUE(planned.plan->looks_at().extent().any);
  EXPECT_GT(render(scene, test::snapshot(settings), pose, {0, 32}).stats.samples, 100u);
}

TEST_F(PlanTest, WhatNeedsRaysAndWhatOnlyRecordingsHaveIsRefusedByName) {
  const Pose pose = test::pose_over_origin(scene_->world(), 1000);
  const auto refused = [&](const std::shared_ptr<const Scene>& scene, const RadarSettings& s) {
    const PlanResult result = plan_frame(scene, test::snapshot(s), pose);
    EXPECT_EQ(result.plan == nullptr, !result.errors.empty());
    return all_text(result.errors);
  };
  EXPECT_EQ(
      refused(scene_, settings(FrustumKind::polar)),
      "frustum.kind: found \"polar\", which only recordings have; allowed: \"symmetric\" | \"oblique\" | "
      "\"sweep\"");
  RadarSettings s = settings(FrustumKind::sweep);
  s.speckle = SpeckleKind::geometric;
  EXPECT_NE(refused(scene_, s).find("radar.speckle: found \"geometric\""), std::string::npos);
  s.frustum = FrustumKind::oblique;
  EXPECT_EQ(refused(scene_, s), "");
  // Range bins below a metre are not refused.
  s = settings(FrustumKind::sweep);
  s.r_max_m = 1010;
  EXPECT_EQ(refused(scene_, s), "");
  std::vector<Material> materials = test::two_materials();
  materials[1].name = "steel";
  materials[1].model = ScatteringModel::flat_plate;
  const auto scene = [&] {
    return test::make_scene(load_world(test::synthetic_spec(SyntheticKind::flat, 12000, 200)), materials);
  };
  EXPECT_NE(refused(scene(), settings(FrustumKind::sweep)).find("found \"sweep\" with flat plates (steel)"),
            std::string::npos);
  EXPECT_EQ(refused(scene(), settings(FrustumKind::oblique)), "");
  materials[1].used = false;
  EXPECT_EQ(refused(scene(), settings(FrustumKind::sweep)), "");
}

TEST_F(PlanTest, SymmetricSectorWithACornerBehindTheCameraIsRefused) {
  RadarSettings s = settings(FrustumKind::symmetric);
  s.sector_deg = 179.9;
  const Pose pose = test::pose_over_origin(scene_->world(), 900);
  const PlanResult result = plan_frame(scene_, test::snapshot(s), pose);
  if (!result.plan) {
    EXPECT_NE(result.errors[0].allowed.find("oblique"), std::string::npos);
    return;
  }
  const Frame frame = render(scene_, test::snapshot(s), pose, {0, 32});
  for (double power : frame.bins.power_w) EXPECT_TRUE(std::isfinite(power));
}

TEST_F(PlanTest, TheNarrowestSectorsSortBuildingsWithoutOverflow) {
  WorldSpec spec = test::synthetic_spec(SyntheticKind::flat, 12000, 200);
  PrismSpec prisms;
  prisms.per_km2 = 5;
  spec.prisms = {prisms};
  const auto scene = test::make_scene(load_world(spec));
  ASSERT_GT(scene->world().buildings.list.size(), 100u);
  const Pose pose = test::pose_over_origin(scene->world(), 900);
  for (double sector_deg : {1e-3, 1e-9, 1e-300, 5e-324}) {
    RadarSettings s = settings(FrustumKind::sweep);
    s.sector_deg = sector_deg;
    s.azimuth_bins = 4096;
    const PlanResult result = plan_frame(scene, test::snapshot(s), pose);
    ASSERT_TRUE(result.plan);
    for (int bin : {0, 2048, 4095}) EXPECT_LE(result.plan->looks_at().buildings_in(bin).size(), 600u);
  }
}

}  // namespace
}  // namespace obliq
