// Bin power over a flat plane of constant gamma against the closed form of PAPER.md, definitions:
// P = K gamma w y_c (1/r1^3 - 1/r2^3) / 3.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/support/figures.h"
#include "tests/support/scenes.h"

namespace obliq::flat_plane_test {
namespace {

struct Errors {
  double median;
  double rms;
  double total;
};

Errors errors_over_flat_ground(FrustumKind kind, int sub_columns = 64) {
  RadarSettings settings;
  settings.frustum = kind;
  settings.sub_columns = sub_columns;
  settings.sector_deg = 60;
  const auto scene = test::make_scene(load_world(test::synthetic_spec(SyntheticKind::flat, 40000, 100)));
  const Pose pose = test::pose_over_origin(scene->world(), 1000);
  const Frame frame = render(scene, test::snapshot(settings), pose, {0, settings.azimuth_bins});
  const double lambda = 299792458.0 / 10e9;
  const double k = lambda * lambda / std::pow(4 * std::numbers::pi, 3);
  const double width = settings.sector_deg * std::numbers::pi / 180 / settings.azimuth_bins;
  const double spacing = (settings.r_max_m - settings.r_min_m) / settings.range_bins;
  std::vector<double> ratios;
  double squares = 0, total = 0, expected_total = 0;
  for (int r = 0; r < settings.range_bins; ++r) {
    const double r1 = settings.r_min_m + r * spacing;
    const double r2 = r1 + spacing;
    const double expected = k * width * 1000 * (1 / (r1 * r1 * r1) - 1 / (r2 * r2 * r2)) / 3;
    for (int a = 0; a < settings.azimuth_bins; ++a) {
      const double power =
          frame.bins.power_w[static_cast<std::size_t>(a) * 1024 + static_cast<std::size_t>(r)];
      ratios.push_back(std::abs(power / expected - 1));
      squares += (power / expected - 1) * (power / expected - 1);
      total += power;
      expected_total += expected;
    }
  }
  std::nth_element(ratios.begin(), ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2),
                   ratios.end());
  const Errors errors{ratios[ratios.size() / 2], std::sqrt(squares / static_cast<double>(ratios.size())),
                      total / expected_total - 1};
  std::printf("    median %.5f rms %.5f total %+.6f rays %llu\n", errors.median, errors.rms, errors.total,
              static_cast<unsigned long long>(frame.stats.rays));
  return errors;
}

TEST(FlatPlane, SweepBinsMatchTheClosedForm) {
  // Over level ground the range whose 1 / r^2 is a piece's mean is exact, so nothing but rounding is left:
  // 1e-16 of the coordinates (4e4 m) over a bin (32 m), times a few. With sqrt(r0 r1) in its place (the named
  // wrong version) the nearest bins are off by (dr / r)^2 / 12 of a piece: 5e-6.
  const Errors errors = errors_over_flat_ground(FrustumKind::sweep, 0);
  EXPECT_LT(errors.median, 1e-9);
  EXPECT_LT(errors.rms, 1e-9);
  EXPECT_LT(std::abs(errors.total), 1e-9);
}

TEST(FlatPlane, EchoesInFloatsMatchTheClosedForm) {
  // Ranges of 37 km are kept to 4 mm, of which a bin edge cuts off as much of a bin: 6e-5 of 32 m at most.
  const Errors errors = errors_over_flat_ground(FrustumKind::sweep);
  test::record_figure("sweep_median", errors.median);
  test::record_figure("sweep_rms", errors.rms);
  test::record_figure("sweep_total", errors.total);
  EXPECT_LT(errors.median, 3e-5);
  EXPECT_LT(errors.rms, 6e-5);
  EXPECT_LT(std::abs(errors.total), 1e-6);
}

TEST(FlatPlane, ObliqueTotalMatchesTheClosedForm) {
  const Errors errors = errors_over_flat_ground(FrustumKind::oblique);
  test::record_figure("oblique_median", errors.median);
  test::record_figure("oblique_rms", errors.rms);
  test::record_figure("oblique_total", errors.total);
  EXPECT_LT(std::abs(errors.total), 1e-3);
}

TEST(FlatPlane, SymmetricTotalMatchesTheClosedForm) {
  // Its far pixels are 162 m long, five range bins: the total still converges, to the pixel quantisation of
  // the edges.
  EXPECT_LT(std::abs(errors_over_flat_ground(FrustumKind::symmetric).total), 5e-3);
}

TEST(FlatPlane, ExactPlanesMatchTheClosedFormAroundTheNadir) {
  // An antenna 50 m up, ranges of 0 to 12 km all around; the first bin with ground ends nearly twice as far
  // as it begins. The range of the mean 1 / r^2 is exact over level ground. With a part's mean range in its
  // place (the named wrong version) the total is 8.6 % low and the first bin 8.8 %.
  RadarSettings settings = test::radar_settings(FrustumKind::sweep, {0, 12000, 360}, {256, 256}, {256});
  settings.sub_columns = 0;
  const double height_m = 50;
  const auto scene = test::make_scene(load_world(test::synthetic_spec(SyntheticKind::flat, 13000, 100)));
  const Frame frame = render(scene, test::snapshot(settings),
                             test::pose_over_origin(scene->world(), height_m), {0, settings.azimuth_bins});
  const double lambda = 299792458.0 / 10e9;
  const double k = lambda * lambda / std::pow(4 * std::numbers::pi, 3);
  const double spacing = settings.r_max_m / settings.range_bins;
  double total = 0, expected_total = 0, first = 0, expected_first = 0;
  for (int r = 0; r < settings.range_bins; ++r) {
    const double r1 = std::max(height_m, r * spacing);
    const double r2 = std::max(height_m, (r + 1) * spacing);
    const double expected =
        k * 2 * std::numbers::pi * height_m * (1 / (r1 * r1 * r1) - 1 / (r2 * r2 * r2)) / 3;
    double power = 0;
    for (int a = 0; a < settings.azimuth_bins; ++a)
      power += frame.bins.power_w[static_cast<std::size_t>(a * settings.range_bins + r)];
    total += power;
    expected_total += expected;
    if (expected > 0 && expected_first == 0) {
      first = power;
      expected_first = expected;
    }
  }
  std::printf("    total %.5g W, %+.2e; first bin %+.2e\n", total, total / expected_total - 1,
              first / expected_first - 1);
  EXPECT_NEAR(total / expected_total, 1, 1e-9);
  EXPECT_NEAR(first / expected_first, 1, 1e-9);
}

}  // namespace
}  // namespace obliq::flat_plane_test
