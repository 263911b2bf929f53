#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "server/radar/ray_source.h"
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
    const auto source =
        make_ray_source(*planned.plan, {first, std::min(kWedgeAzimuthBins, settings.azimuth_bins - first)});
    while (source->next(*batch)) {
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
                    Shape{FrustumKind::symmetric, 30, 7, 180}, Shape{FrustumKind::polar, 120, 64, 15},
                    Shape{FrustumKind::polar, 360, 48, 300}, Shape{FrustumKind::polar, 90, 1, 0}));

}  // namespace
}  // namespace obliq
