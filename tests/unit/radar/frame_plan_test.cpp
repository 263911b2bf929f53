// What plan_frame and place_antenna refuse, and in which words.
#include "server/radar/frame_plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <fstream>
#include <numbers>
#include <vector>

#include "server/radar/rays/ray_samples.h"
#include "server/radar/simd/kernels.h"
#include "terrain/buildings/footprints.h"
#include "tests/support/scenes.h"

namespace obliq::frame_plan_test {
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
    return test::radar_settings(kind, {1000, 10000}, {32, 32}, {64, 64});
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
  RadarSettings settings = test::radar_settings(FrustumKind::sweep, {20, 200}, {32, 32}, {64, 64});
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

struct Shape {
  FrustumKind kind;
  double sector_deg;
  int azimuth_bins;
  double bearing_deg;
};

class RaysOfEveryShape : public testing::TestWithParam<Shape> {};

TEST_P(RaysOfEveryShape, LieInTheirAzimuthBinAndEveryPixelIsCastOnce) {
  const Shape shape = GetParam();
  RadarSettings settings;
  settings.frustum = shape.kind;
  settings.sector_deg = shape.sector_deg;
  settings.azimuth_bins = shape.azimuth_bins;
  settings.pixel_columns = 200;
  settings.pixel_rows = 150;
  settings.r_min_m = 1500;
  settings.r_max_m = 6000;
  const auto scene = test::make_scene(load_world(test::synthetic_spec(SyntheticKind::hills, 7000, 100)));
  const Pose pose = test::pose_over_origin(scene->world(), 1400, shape.bearing_deg);
  const PlanResult planned = plan_frame(scene, test::snapshot(settings), pose);
  ASSERT_TRUE(planned.plan) << planned.errors.front().text();
  const BinGrid& bins = planned.plan->bins();
  std::vector<int> cast(static_cast<std::size_t>(settings.pixel_columns * settings.pixel_rows), 0);
  auto batch = std::make_unique<RayBatch>();
  double solid_angle = 0;
  int rays = 0;
  for (int first = 0; first < settings.azimuth_bins; first += kWedgeAzimuthBins) {
    const auto source = make_ray_source(planned.plan->looks_at(),
                                        {first, std::min(kWedgeAzimuthBins, settings.azimuth_bins - first)});
    while (source->generate(*batch)) {
      std::vector<std::uint16_t> order(batch->packet_order.begin(), batch->packet_order.begin() + batch->n);
      std::sort(order.begin(), order.end());
      for (std::size_t k = 0; k < order.size(); ++k) ASSERT_EQ(order[k], k) << "packets have every ray once";
      for (int k = 0; k < batch->n; ++k) {
        const auto ray = static_cast<std::size_t>(k);
        ++cast[batch->pixel[ray]];
        ++rays;
        solid_angle += batch->solid_angle_sr[ray];
        EXPECT_NEAR(std::hypot(batch->dir_x[ray], batch->dir_y[ray], batch->dir_z[ray]), 1, 1e-14);
        const double world = std::atan2(batch->dir_x[ray], batch->dir_z[ray]);
        const double offset =
            std::remainder(world - planned.plan->sector().bearing_rad, 2 * std::numbers::pi);
        const double bin = (offset - bins.azimuth_start_rad) / bins.azimuth_width_rad;
        // Rounding of the bin number alone may differ at an edge, by far less than 1e-9 of a bin.
        EXPECT_GE(bin, batch->azimuth_bin[ray] - 1e-9);
        EXPECT_LE(bin, batch->azimuth_bin[ray] + 1 + 1e-9);
      }
    }
  }
  for (int n : cast) EXPECT_LE(n, 1);
  EXPECT_GT(rays, 300);
  EXPECT_LE(solid_angle, 2 * std::numbers::pi);
}

INSTANTIATE_TEST_SUITE_P(
    Shapes, RaysOfEveryShape,
    testing::Values(Shape{FrustumKind::oblique, 120, 64, 15}, Shape{FrustumKind::oblique, 360, 33, -170},
                    Shape{FrustumKind::oblique, 200, 1, 90}, Shape{FrustumKind::oblique, 360, 1, 0},
                    Shape{FrustumKind::oblique, 0.5, 16, 359}, Shape{FrustumKind::symmetric, 120, 64, 15},
                    Shape{FrustumKind::symmetric, 30, 7, 180}));

TEST(PacketsOfRays, AreSquaresOfPixels) {
  RadarSettings settings;
  settings.frustum = FrustumKind::oblique;
  settings.sector_deg = 2;  // with a short swath: its far rows are full
  settings.azimuth_bins = 8;
  settings.pixel_columns = 64;
  settings.pixel_rows = 40;
  settings.r_min_m = 5500;
  settings.r_max_m = 6000;
  const auto scene = test::make_scene(load_world(test::synthetic_spec(SyntheticKind::hills, 7000, 100)));
  const PlanResult planned =
      plan_frame(scene, test::snapshot(settings), test::pose_over_origin(scene->world(), 1400));
  ASSERT_TRUE(planned.plan) << planned.errors.front().text();
  RayBatch batch;
  const auto source = make_ray_source(planned.plan->looks_at(), {0, 8});
  ASSERT_TRUE(source->generate(batch));
  ASSERT_GE(batch.n, 512);
  for (std::size_t packet = 0; packet < 16; ++packet) {
    std::uint32_t columns[2] = {~0u, 0};
    std::uint32_t rows[2] = {~0u, 0};
    for (std::size_t k = 16 * packet; k < 16 * packet + 16; ++k) {
      const std::uint32_t pixel = batch.pixel[batch.packet_order[k]];
      columns[0] = std::min(columns[0], pixel % 64);
      columns[1] = std::max(columns[1], pixel % 64);
      rows[0] = std::min(rows[0], pixel / 64);
      rows[1] = std::max(rows[1], pixel / 64);
    }
    EXPECT_EQ(columns[1] - columns[0], 3u) << packet;
    EXPECT_EQ(rows[1] - rows[0], 3u) << packet;
  }
}

TEST(AimedPixels, HaveTheSameRaysInEveryInstructionSet) {
  const PixelCamera camera{-900, 1.5, 0.6, 0.8, 3.7e6, 1300.0 * 1300, {1250, 1100, 1500, 6000}, 20};
  const auto pixels = std::make_unique<PixelList>();
  pixels->n = 1021;
  for (int k = 0; k < kBatch; ++k) {
    pixels->column[k] = 37 * k % 1200;
    pixels->up_m[k] = -1200;
    pixels->ahead_m[k] = 5.0 * k - 300;
  }
  const auto cast = [&](decltype(Kernels::pixel_rays) kernel) {
    std::vector<double> found(4 * kBatch);
    std::vector<std::int32_t> from(kBatch);
    double* const x = found.data();
    const int n = kernel(camera, *pixels, {x, x + 1024, x + 2048, x + 3072, from.data()});
    std::vector<std::uint64_t> bits;
    for (std::size_t k = 0; k < static_cast<std::size_t>(n); ++k) {
      bits.push_back(static_cast<std::uint64_t>(from[k]));
      for (std::size_t array = 0; array < 4; ++array)
        bits.push_back(std::bit_cast<std::uint64_t>(found[1024 * array + k]));
    }
    return bits;
  };
  const auto first = cast(all_kernels().front().pixel_rays);
  EXPECT_GT(first.size(), 5 * 100u);
  EXPECT_LT(first.size(), 5 * 1021u) << "some are to miss the swath";
  for (const Kernels& kernels : all_kernels()) EXPECT_EQ(cast(kernels.pixel_rays), first) << kernels.name;
}

}  // namespace
}  // namespace obliq::frame_plan_test
