// What bins hold in I&Q they hold in power: |v|^2 / power is 1 in the mean over speckle, within 0.2 %. Two
// planes of a bin that see one ground cell and answer twice with its one phase would be too bright there, by
// up to twice; few bins have such cells, and no test of a few bins sees it.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstdio>
#include <numbers>

#include "server/radar/render.h"
#include "tests/support/scenes.h"

namespace obliq::test::speckle_mean_test {
namespace {

constexpr double kTolerance = 0.002;
/// Neighbours share cells: about one bin in three is independent. The mean over all bins then has a standard
/// error of a fifth of the tolerance.
constexpr double kBins = 20e6;

/// Planes stand as close as cells are wide, from 4096 m on, and look along the cells' diagonals.
RadarSettings close_planes(int azimuth_bins) {
  RadarSettings s;
  s.frustum = FrustumKind::sweep;
  s.sector_deg = azimuth_bins * std::ldexp(180 / std::numbers::pi, -9);
  s.r_min_m = 4000;
  s.r_max_m = 8100;
  s.azimuth_bins = azimuth_bins;
  s.pixel_columns = 2 * azimuth_bins;
  s.range_bins = 400;
  return s;
}

/// The mean of |v|^2 / power over kBins bins, from as many seeds as it takes.
double mean_intensity(const std::shared_ptr<const Scene>& scene, RadarSettings s) {
  double sum = 0, bins = 0, faint = 0;
  RenderOptions options;
  options.states = false;
  for (s.speckle_seed = 1; bins < kBins; ++s.speckle_seed) {
    const BinBlock block =
        render(scene, snapshot(s), pose_over_origin(scene->world(), 900, 45), {0, s.azimuth_bins}, options)
            .bins;
    for (std::size_t k = 0; k < block.iq.size(); ++k) {
      if (!(block.power_w[k] > 0)) {
        ++faint;
        continue;
      }
      sum += std::norm(std::complex<double>(block.iq[k])) / block.power_w[k];
      ++bins;
    }
  }
  std::printf("    mean of |v|^2 / power %.5f over %.0f bins, %.0f without power\n", sum / bins, bins, faint);
  return sum / bins;
}

TEST(SpeckleMean, OverHillsIsThePower) {
  EXPECT_NEAR(mean_intensity(hills_with_houses(0), close_planes(512)), 1, kTolerance);
}

TEST(SpeckleMean, OverATownIsThePower) {
  EXPECT_NEAR(mean_intensity(hills_with_houses(150), close_planes(512)), 1, kTolerance);
}

TEST(SpeckleMean, AtTheEdgesOfASectorIsThePower) {
  // A single wedge.
  EXPECT_NEAR(mean_intensity(hills_with_houses(0), close_planes(8)), 1, kTolerance);
}

}  // namespace
}  // namespace obliq::test::speckle_mean_test
