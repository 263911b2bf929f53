#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <vector>

#include "server/radar/rays/ray_samples.h"
#include "server/radar/simd/kernels.h"
#include "tests/support/scenes.h"

namespace obliq {
namespace {

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
}  // namespace obliq
