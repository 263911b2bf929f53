// The sea's texture in bins: its law by the size of a bin, whatever the ground's grid and the frustum; I&Q
// with the K distribution's moments and tails; its mean; its drift.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/support/made_worlds.h"
#include "tests/support/same_bits.h"
#include "tests/support/scenes.h"

namespace obliq::sea_texture_test {
namespace {

std::shared_ptr<const Scene> level_sea(double half_m, double cell_m) {
  std::vector<Material> materials = test::two_materials();
  materials[0].model = ScatteringModel::sea;
  materials[0].gamma = 1e-4;
  return test::make_scene(test::made_world(half_m, cell_m, [](double, double) { return 0.0; }), materials);
}

/// 200 m above it, of bins so many metres long and, in the nearest, as wide.
RadarSettings radar(FrustumKind kind, double shape, double side_m, double r_min_m = 3000,
                    int range_bins = 64) {
  RadarSettings s = test::radar_settings(kind, {r_min_m, r_min_m + range_bins * side_m, 60}, {}, {});
  s.range_bins = range_bins;
  s.azimuth_bins = static_cast<int>(std::numbers::pi / 3 * r_min_m / side_m / 8) * 8;
  s.pixel_columns = s.azimuth_bins;
  s.pixel_rows = 1024;
  s.sea.state = 3;
  s.sea.shape = shape;
  return s;
}

BinBlock frame_of(const std::shared_ptr<const Scene>& scene, const RadarSettings& s,
                  std::int64_t sim_time_ns = 0, const glm::dvec3& at_m = {0, 200, 0}) {
  Pose pose = test::pose_at(scene->world(), at_m, 0);
  pose.settings.sim_time_ns = sim_time_ns;
  return render(scene, test::snapshot(s), pose, {0, s.azimuth_bins}).bins;
}

/// Of each bin what the texture makes of its power.
std::vector<double> texture_of(const std::shared_ptr<const Scene>& scene, const RadarSettings& s,
                               std::int64_t sim_time_ns = 0, const glm::dvec3& at_m = {0, 200, 0}) {
  RadarSettings smooth = s;
  smooth.sea.shape = 0;
  const BinBlock with = frame_of(scene, s, sim_time_ns, at_m), without = frame_of(scene, smooth, 0, at_m);
  std::vector<double> tau;
  for (std::size_t k = 0; k < with.power_w.size(); ++k)
    if (without.power_w[k] > 0) tau.push_back(with.power_w[k] / without.power_w[k]);
  return tau;
}

double mean_of(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

/// 1 over the variance, over the squared mean, of several draws.
double shape_of(const std::shared_ptr<const Scene>& scene, RadarSettings s, int draws) {
  double sum = 0, squares = 0, n = 0;
  for (int draw = 1; draw <= draws; ++draw) {
    s.speckle_seed = draw;
    for (const double tau : texture_of(scene, s)) {
      sum += tau;
      squares += tau * tau;
      ++n;
    }
  }
  const double mean = sum / n;
  return mean * mean / (squares / n - mean * mean);
}

TEST(SeaTextureInBins, FollowsTheSizeOfABinAndNotTheGridNorTheFrustum) {
  // Shapes of the mean over squares of 10 and 90 m of a field of shape 0.5: 0.525 and 2.717, integrated with
  // numpy (tests/unit/radar/echo/sea_texture_test.cpp). Grids of 10 and of 90 m agree to chance, although
  // exact planes and rays cut the ground at each cell; a texture taken at the middles of a grid's cells would
  // have 0.5 to 0.6 with cells of 90 m whatever the bin.
  struct Case {
    double side_m, shape, r_min_m;
    int range_bins, draws;
  };
  for (const Case& c : {Case{10, 0.525, 3000, 32, 16}, Case{90, 2.717, 9000, 8, 60}}) {
    const double half_m = c.r_min_m + 1000;
    const auto fine = level_sea(half_m, c.side_m > 50 ? 30 : 10), coarse = level_sea(half_m, 90);
    RadarSettings sweep = radar(FrustumKind::sweep, 0.5, c.side_m, c.r_min_m, c.range_bins);
    RadarSettings exact = sweep;
    exact.sub_columns = 0;
    const double shapes[] = {shape_of(fine, sweep, c.draws), shape_of(coarse, sweep, c.draws),
                             shape_of(fine, exact, c.draws), shape_of(coarse, exact, c.draws)};
    std::printf("    bins of %g m: sweep %.3f and %.3f, exact planes %.3f and %.3f\n", c.side_m, shapes[0],
                shapes[1], shapes[2], shapes[3]);
    for (const double shape : shapes) EXPECT_NEAR(shape / c.shape, 1, 0.15) << c.side_m;
    EXPECT_NEAR(shapes[0] / shapes[1], 1, 0.02);
    EXPECT_NEAR(shapes[2] / shapes[3], 1, 0.1);
    RadarSettings rays = radar(FrustumKind::oblique, 0.5, c.side_m, c.r_min_m, c.range_bins);
    rays.pixel_columns = rays.pixel_rows = 1024;
    if (c.side_m > 50) {
      const double of_rays = shape_of(coarse, rays, 20);
      std::printf("    rays %.3f\n", of_rays);
      EXPECT_NEAR(of_rays / c.shape, 1, 0.15);
    }
  }
}

TEST(SeaTextureInBins, MakesIqKDistributed) {
  // Bins of 3 m, a tenth of the lattice: shape 1 within 1 %. <I^2>/<I>^2 = 2 (1 + 1/nu) = 4, <I^3>/<I>^3 =
  // 6 (1 + 1/nu)(1 + 2/nu) = 36; exceeded by a tenth, a thousandth: 4.12, 12.29 dB over the mean (K
  // distribution of shape 1, numerically). Rayleigh clutter has 2, 6, 3.62, 8.39.
  RadarSettings s = radar(FrustumKind::sweep, 1, 3);
  const auto scene = level_sea(3600, 60);
  std::vector<double> intensity;
  for (int draw = 1; draw <= 60; ++draw) {
    s.speckle_seed = draw;
    const BinBlock bins = frame_of(scene, s);
    RadarSettings smooth = s;
    smooth.sea.shape = 0;
    const BinBlock level = frame_of(scene, smooth);
    for (std::size_t k = 0; k < bins.iq.size(); ++k)
      if (level.power_w[k] > 0)
        intensity.push_back(static_cast<double>(std::norm(bins.iq[k])) / level.power_w[k]);
  }
  const double mean = mean_of(intensity);
  double second = 0, third = 0;
  for (double& i : intensity) {
    i /= mean;
    second += i * i;
    third += i * i * i;
  }
  const auto n = static_cast<double>(intensity.size());
  std::ranges::sort(intensity);
  const auto exceeded_db = [&](double share) {
    return 10 * std::log10(intensity[static_cast<std::size_t>((1 - share) * n)]);
  };
  std::printf("    mean %.4f, moments %.3f, %.2f; 0.1: %.2f dB, 0.001: %.2f dB\n", mean, second / n,
              third / n, exceeded_db(0.1), exceeded_db(1e-3));
  EXPECT_NEAR(mean, 1, 0.02);
  EXPECT_NEAR(second / n, 4, 0.15);
  EXPECT_NEAR(third / n, 36, 5);
  EXPECT_NEAR(exceeded_db(0.1), 4.12, 0.05);
  EXPECT_NEAR(exceeded_db(1e-3), 12.29, 0.2);
}

TEST(SeaTextureInBins, HasTheModelsMeanOverRealisations) {
  // Of each bin, over 400 draws: 1, by chance within 1 / sqrt(400 nu), nu = 1 at the least, and five of
  // those.
  RadarSettings s = radar(FrustumKind::sweep, 1, 40);
  const auto scene = level_sea(6500, 90);
  std::vector<double> sum;
  constexpr int kDraws = 400;
  for (int draw = 1; draw <= kDraws; ++draw) {
    s.speckle_seed = draw;
    const std::vector<double> tau = texture_of(scene, s);
    sum.resize(tau.size());
    for (std::size_t k = 0; k < tau.size(); ++k) sum[k] += tau[k] / kDraws;
  }
  for (const double mean : sum) ASSERT_NEAR(mean, 1, 5 / std::sqrt(kDraws));
  EXPECT_NEAR(mean_of(sum), 1, 2e-3);
}

TEST(SeaTextureInBins, RepeatsWithItsSimTimeAndDriftsWithTheWind) {
  RadarSettings s = radar(FrustumKind::sweep, 0.5, 20);
  const auto scene = level_sea(6000, 60);
  constexpr std::int64_t kTime_ns = 1'700'000'000'000'000'000, kMinute_ns = 60'000'000'000;
  // Of wind from nowhere it stands still.
  test::expect_same_bits(frame_of(scene, s, kTime_ns), frame_of(scene, s, 0));
  s.atmosphere.wind_m_s = 10;
  s.atmosphere.wind_from_deg = 300;
  test::expect_same_bits(frame_of(scene, s, kTime_ns), frame_of(scene, s, kTime_ns));
  const std::vector<double> before = texture_of(scene, s, kTime_ns);
  const std::vector<double> after = texture_of(scene, s, kTime_ns + kMinute_ns);
  const auto difference = [&](const std::vector<double>& of) {
    double sum = 0;
    for (std::size_t k = 0; k < of.size(); ++k) sum += std::abs(of[k] - before[k]);
    return sum / static_cast<double>(of.size());
  };
  EXPECT_GT(difference(after), 0.1);
  // An antenna that drifts with it sees the same: 3 % of 10 m/s, from 300 degrees, a minute long.
  // Along the antenna's own north (the named wrong version) it would be elsewhere: 500,000 km have passed
  // since 1970.
  const double to_rad = 120 * std::numbers::pi / 180;
  const glm::dvec3 drifted(18 * std::sin(to_rad), 200, 18 * std::cos(to_rad));
  EXPECT_LT(difference(texture_of(scene, s, kTime_ns + kMinute_ns, drifted)), 0.02);
  EXPECT_GT(difference(texture_of(scene, s, kTime_ns + kMinute_ns, {-drifted.x, 200, -drifted.z})), 0.1);
  // So a radar that stands still sees another sea each time, and with a smooth one the same.
  PoseSettings a = test::settings_over_origin(200), b = a;
  b.sim_time_ns = kMinute_ns;
  EXPECT_FALSE(same_antenna(s, a, b));
  s.sea.shape = 0;
  EXPECT_TRUE(same_antenna(s, a, b));
}

TEST(SeaTextureInBins, IsThereInAllFrustaAndOnAnyNumberOfThreads) {
  const auto scene = level_sea(6000, 60);
  for (const FrustumKind kind : {FrustumKind::sweep, FrustumKind::oblique, FrustumKind::symmetric}) {
    RadarSettings s = radar(kind, 0.1, 40);
    const std::vector<double> tau = texture_of(scene, s);
    double squares = 0;
    for (const double t : tau) {
      ASSERT_TRUE(std::isfinite(t) && t >= 0);
      squares += t * t / static_cast<double>(tau.size());
    }
    EXPECT_GT(squares, 1.5) << frustum_name(kind);
    EXPECT_NEAR(mean_of(tau), 1, 0.25) << frustum_name(kind);
    RenderOptions one, two;
    one.threads = 1;
    two.threads = 2;
    const Pose pose = test::pose_at(scene->world(), {0, 200, 0}, 0);
    test::expect_same_bits(render(scene, test::snapshot(s), pose, {0, s.azimuth_bins}, one).bins,
                           render(scene, test::snapshot(s), pose, {0, s.azimuth_bins}, two).bins);
  }
}

}  // namespace
}  // namespace obliq::sea_texture_test
