// The closed forms of `obliq explain` against exact spheres and against each other.
#include "server/accuracy/thresholds.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace obliq::thresholds_test {
namespace {

/// Contrast (standard deviation over mean of the intensity) of the sum of n phasors of one length and random
/// phases: sqrt(1 - 1/n) (Goodman, Speckle Phenomena in Optics, 2007, section 3.2: second moment 2 - 1/n).
double phasor_sum_contrast(double phasors) { return std::sqrt(1 - 1 / phasors); }

constexpr double kRadius_m = 6371008.8;  // IUGG's R1
constexpr double kStandard = 0.75;       // 1/k for k = 4/3

/// How far a sphere of radius R/curvature lies under its tangent plane.
double exact_drop_m(double ground_m, double curvature) {
  const double radius = kRadius_m / curvature;
  return ground_m * ground_m / (radius + std::sqrt(radius * radius - ground_m * ground_m));
}

/// Sine of the depression of a sphere's surface at slant range r from height h: law of cosines, exact.
double exact_sine(double r, double h, double radius) {
  return (h * (2 * radius + h) + r * r) / (2 * r * (radius + h));
}

TEST(Thresholds, TheEarthDrops107MetresAt37KilometresInVacuum) {
  // DESIGN's and the figure: the vertical drop r^2 / 2R with k = 1, not a shift in range.
  EXPECT_NEAR(earth_drop_m(37000, 1), 107.4, 0.05);
  EXPECT_NEAR(earth_drop_m(37000, kStandard), 80.6, 0.05);
  EXPECT_EQ(earth_drop_m(37000, 0), 0);
  // The parabola leaves g^4 / 8R^3: 1 mm at 37 km, 4 cm at 100 km. Half or twice the drop would be metres
  // off.
  for (const double ground_m : {2000.0, 37000.0, 100000.0}) {
    const double rest_m = std::pow(ground_m, 4) / (8 * std::pow(kRadius_m, 3));
    EXPECT_NEAR(earth_drop_m(ground_m, 1), exact_drop_m(ground_m, 1), 1.01 * rest_m + 1e-9);
  }
}

TEST(Thresholds, AGroundPointFarOffMovesByMetresInSlantRangeNotByItsDrop) {
  // From 1 km, at 37 km: h drop / r = 2.9 m and drop^2 / 2r = 0.16 m.
  const double shift_m = ground_slant_range_m(37000, 1000, 1) - ground_slant_range_m(37000, 1000, 0);
  EXPECT_NEAR(shift_m, 1000 * 107.44 / 37000 + 107.44 * 107.44 / 74000, 0.01);
  EXPECT_NEAR(ground_slant_range_m(37000, 1000, 1), std::hypot(37000, 1000 + exact_drop_m(37000, 1)), 1e-4);
}

TEST(Thresholds, BinPowerOnASphereIsThatOfTheLawOfCosines) {
  for (const double h : {300.0, 1000.0, 3000.0}) {
    for (const double curvature : {kStandard, 1.0}) {
      const double radius = kRadius_m / curvature;
      const double horizon = horizon_m(h, curvature);
      EXPECT_NEAR(horizon, std::sqrt(2 * radius * h + h * h), horizon * h / radius);
      for (const double share : {0.1, 0.5, 0.9}) {
        const double r = share * horizon;
        // d(sin e)/dr of the sphere over that of the plane, h / r^2. Orders of h/R are left out: 5e-4 at
        // most.
        const double step = 1e-3 * r;
        const double slope = (exact_sine(r - step, h, radius) - exact_sine(r + step, h, radius)) / (2 * step);
        EXPECT_NEAR(curved_ground_power_ratio(r, h, curvature), slope * r * r / h, 1e-3) << h << " " << share;
      }
      EXPECT_EQ(curved_ground_power_ratio(1.1 * horizon, h, curvature), 0);
    }
  }
  EXPECT_EQ(curved_ground_power_ratio(37000, 1000, 0), 1);
}

TEST(Thresholds, RangesOfAChangeAreWhereTheChangeIsReached) {
  for (const auto& [a, b] : {std::pair{0.0, kStandard}, {kStandard, 1.0}, {1.0, kStandard}, {0.0, 1.0}}) {
    const double r = range_of_power_change_m(1000, a, b, 0.1);
    const double db =
        10 * std::log10(curved_ground_power_ratio(r, 1000, a) / curved_ground_power_ratio(r, 1000, b));
    EXPECT_NEAR(std::abs(db), 0.1, 1e-9);
    const double g = range_of_slant_shift_m(1000, a, b, 2);
    EXPECT_NEAR(std::abs(ground_slant_range_m(g, 1000, a) - ground_slant_range_m(g, 1000, b)), 2, 1e-6);
  }
  // By hand: 1 - r^2 / (2 k R h) = 10^-0.01, 2 k R h = 1.6989e10 m^2.
  EXPECT_NEAR(range_of_power_change_m(1000, 0, kStandard, 0.1), std::sqrt(0.022763 * 1.6989357e10), 2);
  EXPECT_TRUE(std::isinf(range_of_power_change_m(1000, 1, 1, 0.1)));
  EXPECT_TRUE(std::isinf(range_of_slant_shift_m(1000, 1, 1, 2)));
}

TEST(Thresholds, WallsShowAsMuchOfABlockAsTheirProjection) {
  // 12 m high, 24 m deep, at 45 degrees: one part of wall to two of roof.
  EXPECT_NEAR(wall_share(12, 24, std::atan(1.0)), 1.0 / 3, 1e-12);
  EXPECT_NEAR(wall_share(12, 24, 1e-9), 1, 1e-8);
  for (const double share : {0.02, 0.3, 0.9})
    EXPECT_NEAR(wall_share(12, 24, depression_of_wall_share_rad(12, 24, share)), share, 1e-12);
}

TEST(Thresholds, VerticalErrorsAndCellsScaleAsTheySay) {
  // Straight down, height is range; at 30 degrees it counts half.
  EXPECT_NEAR(vertical_tolerance_m(15, std::acos(0.0)), 15, 1e-12);
  EXPECT_NEAR(vertical_tolerance_m(15, std::asin(0.5)), 30, 1e-12);
  EXPECT_NEAR(cell_of_error_m(20, 1, 2, 4), 40, 1e-12);
  EXPECT_NEAR(cell_of_error_m(20, 1, 1, 4), 80, 1e-12);
}

TEST(Thresholds, PhasorsOfOneLengthReachFullContrastSlowly) {
  EXPECT_EQ(phasor_sum_contrast(1), 0);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> turn(0, 2 * M_PI);
  for (const int n : {2, 5, 25}) {
    constexpr int kTrials = 100000;
    double sum = 0, squares = 0;
    for (int t = 0; t < kTrials; ++t) {
      double re = 0, im = 0;
      for (int k = 0; k < n; ++k) {
        const double phase = turn(random);
        re += std::cos(phase);
        im += std::sin(phase);
      }
      const double intensity = re * re + im * im;
      sum += intensity;
      squares += intensity * intensity;
    }
    const double mean = sum / kTrials;
    // The contrast of 1e5 exponential values has a standard error of 1 / sqrt(1e5) = 0.3 %; four of them.
    EXPECT_NEAR(std::sqrt(squares / kTrials - mean * mean) / mean, phasor_sum_contrast(n), 0.013) << n;
  }
}

}  // namespace
}  // namespace obliq::thresholds_test
