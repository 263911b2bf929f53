// Ground speckle of whole frames: bin intensities are exponential whatever the sampling, bins covary by the
// ground they share and by nothing else.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>

#include "server/radar/frame_plan.h"
#include "server/radar/render.h"
#include "terrain/buildings/footprints.h"
#include "tests/support/scatterer_shares.h"
#include "tests/support/scenes.h"
#include "tests/support/sources.h"

namespace obliq::speckle_statistics_test {
namespace {

Frame frame_of(const std::shared_ptr<const Scene>& scene, const RadarSettings& settings, double height_m) {
  RenderOptions options;
  options.threads = 1;
  options.states = false;
  return render(scene, test::snapshot(settings), test::pose_over_origin(scene->world(), height_m),
                {0, settings.azimuth_bins}, options);
}

struct Moments {
  double mean = 0, contrast = 0;
};

Moments moments(const std::vector<double>& values) {
  double sum = 0, squares = 0;
  for (const double v : values) sum += v, squares += v * v;
  const double n = static_cast<double>(values.size());
  const double mean = sum / n;
  return {mean, std::sqrt(std::max(0.0, squares / n - mean * mean)) / mean};
}

/// Greatest distance between the empirical distribution and 1 - exp(-x) (Kolmogorov and Smirnov).
double distance_from_exponential(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const double n = static_cast<double>(values.size());
  double distance = 0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    const double expected = -std::expm1(-values[k]);
    const double below = static_cast<double>(k) / n;
    distance = std::max({distance, expected - below, below + 1 / n - expected});
  }
  return distance;
}

class SpeckleOfEverySource : public testing::TestWithParam<test::NamedSource> {
 protected:
  static std::shared_ptr<const Scene> flat() {
    static const auto scene = test::make_scene(
        load_world(test::synthetic_spec(SyntheticKind::flat, 11000, 100)), test::constant_gamma_materials());
    return scene;
  }

  static constexpr int kBins = 320;
  static constexpr std::size_t kIndependent = 100000;

  static RadarSettings settings(double pixels_a_bin, SpeckleKind speckle = SpeckleKind::ground) {
    RadarSettings s = test::radar_settings(
        GetParam().kind, {2000, 10000, 60}, {kBins, kBins},
        {static_cast<int>(pixels_a_bin * kBins), static_cast<int>(pixels_a_bin * kBins)});
    s.speckle = speckle;
    return s;
  }

  struct Intensities {
    std::vector<double> all[3];       ///< |v|^2 / power of every sampled bin, by thirds of the swath
    std::vector<double> independent;  ///< of bins that share no cell
    double samples_a_bin = 0;
  };

  /// At least kIndependent bins, from as many seeds as it takes. A cell is at most half a bin wide and so
  /// never reaches past its neighbour: bins of the same parity in azimuth and in range share none.
  static Intensities intensities(RadarSettings s) {
    Intensities result;
    double samples = 0, sampled = 0;
    for (s.speckle_seed = 1; result.independent.size() < kIndependent && s.speckle_seed < 200;
         ++s.speckle_seed) {
      const BinBlock bins = frame_of(flat(), s, 1500).bins;
      std::vector<double> by_parity[4];
      for (std::size_t n = 0; n < bins.count.size(); ++n) {
        const double norm_w = std::norm(std::complex<double>(bins.iq[n]));
        if (bins.power_w[n] == 0) {
          EXPECT_EQ(norm_w, 0);
          continue;
        }
        const double intensity = norm_w / bins.power_w[n];
        result.all[3 * (n % kBins) / kBins].push_back(intensity);
        by_parity[n / kBins % 2 * 2 + n % kBins % 2].push_back(intensity);
        samples += bins.count[n];
        sampled += 1;
      }
      const auto& most =
          *std::ranges::max_element(by_parity, {}, [](const auto& list) { return list.size(); });
      result.independent.insert(result.independent.end(), most.begin(), most.end());
    }
    result.samples_a_bin = samples / sampled;
    return result;
  }
};

TEST_P(SpeckleOfEverySource, IsExponentialWithAContrastOfOneAtAnySampling) {
  for (const double pixels_a_bin : {0.25, 0.5, 1.0, 4.0}) {
    const Intensities found = intensities(settings(pixels_a_bin));
    ASSERT_GE(found.independent.size(), kIndependent);
    const double distance = distance_from_exponential(found.independent);
    const double n = static_cast<double>(found.independent.size());
    std::printf("    %g pixels a bin and side (%.2f samples a sampled bin): D %.5f on %.0f\n", pixels_a_bin,
                found.samples_a_bin, distance, n);
    for (const std::vector<double>& third : found.all) {
      const Moments all = moments(third);
      const double bins = static_cast<double>(third.size());
      std::printf("      contrast %.4f, mean %.4f of %.0f bins: %+.1f and %+.1f / sqrt(N)\n", all.contrast,
                  all.mean, bins, (all.contrast - 1) * std::sqrt(bins), (all.mean - 1) * std::sqrt(bins));
      // Of N exponentials both have a standard error of 1 / sqrt(N).
      EXPECT_NEAR(all.contrast, 1, 5 / std::sqrt(bins));
      EXPECT_NEAR(all.mean, 1, 5 / std::sqrt(bins));
    }
    EXPECT_NEAR(moments(found.independent).contrast, 1, 5 / std::sqrt(n));
    // Mean of n exponentials: standard error 1 / sqrt(n).
    EXPECT_NEAR(moments(found.independent).mean, 1, 5 / std::sqrt(n));
    // Smirnov's limit: P(D > 2.4 / sqrt(n)) = 2 exp(-2 2.4^2) = 2e-5.
    EXPECT_LT(distance, 2.4 / std::sqrt(n));
  }
}

TEST_P(SpeckleOfEverySource, WouldFailTheTestWithThePapersPhases) {
  // The check can fail: with the paper's own phases a bin of one sample has |v|^2 = power exactly.
  if (GetParam().kind == FrustumKind::sweep) GTEST_SKIP() << "the sweep has no speckle from samples";
  const Intensities found = intensities(settings(0.5, SpeckleKind::geometric));
  std::printf("    contrast %.4f, D %.4f\n", moments(found.independent).contrast,
              distance_from_exponential(found.independent));
  EXPECT_GT(distance_from_exponential(found.independent),
            10 * 2.4 / std::sqrt(static_cast<double>(found.independent.size())));
}

/// A flat roof and a wall of many cells, or posts no larger than a cell, on ground that reflects nothing.
std::shared_ptr<const Scene> faces_alone(bool posts) {
  World world = load_world(test::synthetic_spec(SyntheticKind::flat, 11000, 100));
  OutlineShaper shaper;
  const auto stand = [&](double x_m, double z_m, double width_m, double depth_m, double height_m) {
    const Polygon outline{
        {{{x_m, z_m}, {x_m + width_m, z_m}, {x_m + width_m, z_m + depth_m}, {x_m, z_m + depth_m}}}};
    stand_outline(world, shaper, outline, {height_m, 1, static_cast<std::uint64_t>(x_m + 1e6 * z_m)});
  };
  if (posts) {
    for (int n = 0; n < 1000; ++n) stand(57.0 * (n % 50) - 1400, 4500 + 190.0 * (n / 50), 3.5, 3.5, 3.5);
  } else {
    stand(-1500, 3000, 3000, 1500, 30);
    stand(-2500, 6000, 5000, 20, 300);
  }
  std::vector<Material> materials = test::constant_gamma_materials();
  materials[0].gamma = 0;
  return test::make_scene(std::move(world), materials);
}

TEST_P(SpeckleOfEverySource, OfRoofsAndWallsOfManyCellsIsThatOfGround) {
  RadarSettings s = settings(1);
  s.sub_columns = 0;  // the shares below are of samples
  s.pixel_columns *= 3;
  std::vector<double> roofs, walls;
  const auto scene = faces_alone(false);
  const Buildings& buildings = scene->world().buildings;
  const auto shares =
      test::shares_of_bins(*test::plan_or_throw(scene, s, test::pose_over_origin(scene->world(), 1500)));
  for (s.speckle_seed = 1; s.speckle_seed <= 8; ++s.speckle_seed) {
    const BinBlock bins = frame_of(scene, s, 1500).bins;
    for (std::size_t n = 0; n < bins.count.size(); ++n) {
      if (!(bins.power_w[n] > 0)) continue;
      const auto of_most =
          std::ranges::max_element(shares[n], {}, [](const auto& share) { return share.second; });
      const bool wall = buildings.face(of_most->first.face).wall;
      (wall ? walls : roofs).push_back(std::norm(std::complex<double>(bins.iq[n])) / bins.power_w[n]);
    }
  }
  for (const auto& [name, values] : {std::pair("roofs", roofs), {"walls", walls}}) {
    const Moments found = moments(values);
    std::printf("    %s: contrast %.4f, mean %.4f of %zu\n", name, found.contrast, found.mean, values.size());
    ASSERT_GE(values.size(), 4000u) << name;
    // Neighbours share cells, a quarter of the bins may be independent: 5 / sqrt(n / 4).
    EXPECT_NEAR(found.mean, 1, 10 / std::sqrt(static_cast<double>(values.size()))) << name;
    EXPECT_NEAR(found.contrast, 1, 0.02 + 15 / std::sqrt(static_cast<double>(values.size()))) << name;
  }
}

TEST_P(SpeckleOfEverySource, OfAFaceNoLargerThanACellIsOnePhasor) {
  RadarSettings s = settings(1.5);
  s.sub_columns = 0;  // the shares below are of samples
  s.r_min_m = 4100;   // cells of 4 m, and 8 beyond 8192
  s.azimuth_bins = s.range_bins = 200;
  const auto scene = faces_alone(true);
  const auto shares =
      test::shares_of_bins(*test::plan_or_throw(scene, s, test::pose_over_origin(scene->world(), 1500)));
  const BinBlock bins = frame_of(scene, s, 1500).bins;
  int alone = 0;
  for (std::size_t n = 0; n < shares.size(); ++n) {
    int faces = 0;
    for (const auto& [cell, power] : shares[n]) faces += power > 0 ? 1 : 0;
    if (faces != 1) continue;
    ++alone;
    EXPECT_NEAR(std::norm(std::complex<double>(bins.iq[n])) / bins.power_w[n], 1, 1e-6);
  }
  std::printf("    %d bins of one face\n", alone);
  EXPECT_GE(alone, 20);
}

/// Flat ground with two houses whose walls and roofs lie across several bins.
std::shared_ptr<const Scene> ground_with_houses() {
  World world = load_world(test::synthetic_spec(SyntheticKind::flat, 6000, 100));
  OutlineShaper shaper;
  for (const double x_m : {-70.0, 60.0}) {
    const double z_m = 3800;
    const Polygon outline{
        {{{x_m - 45, z_m - 20}, {x_m + 45, z_m - 25}, {x_m + 40, z_m + 30}, {x_m - 45, z_m + 30}}}};
    stand_outline(world, shaper, outline, {35, 1, static_cast<std::uint64_t>(1000 + x_m)});
  }
  return test::make_scene(std::move(world), test::constant_gamma_materials());
}

TEST_P(SpeckleOfEverySource, CovariesByTheGroundThatBinsShare) {
  const auto scene = ground_with_houses();
  RadarSettings s;
  s.frustum = GetParam().kind;
  // Across 4096 m, where cells go from 8 to 16 m.
  s.r_min_m = 3950;
  s.r_max_m = 4250;
  s.range_bins = 8;
  s.azimuth_bins = 6;
  s.sector_deg = 6 * 0.54;
  s.pixel_columns = 42;
  s.pixel_rows = 56;
  s.sub_columns = 0;  // whose samples are known
  const auto plan = test::plan_or_throw(scene, s, test::pose_over_origin(scene->world(), 1500));
  const std::vector<test::BinShares> shares = test::shares_of_bins(*plan);
  const std::size_t n = shares.size();

  constexpr int kSeeds = 5000;
  std::vector<std::complex<double>> products(n * n);
  std::vector<double> power(n);
  for (int seed = 1; seed <= kSeeds; ++seed) {
    s.speckle_seed = seed;
    const BinBlock bins = frame_of(scene, s, 1500).bins;
    for (std::size_t a = 0; a < n; ++a)
      for (std::size_t b = 0; b < n; ++b)
        products[a * n + b] += std::complex<double>(bins.iq[a]) * std::conj(std::complex<double>(bins.iq[b]));
    power = bins.power_w;
  }

  // For circular Gaussian v_a, v_b the mean of N products misses by E|error|^2 = P_a P_b / N, and |error|^2
  // is exponential: over M pairs the chance that any misses by more than sqrt((ln M + ln 1e6) / N) is 1e-6.
  const double pairs = static_cast<double>(n) * static_cast<double>(n + 1) / 2;
  const double tolerance = std::sqrt((std::log(pairs) + std::log(1e6)) / kSeeds);
  int sharing = 0, apart = 0, strongly = 0, by_a_face = 0;
  double worst_sharing = 0, worst_apart = 0;
  for (std::size_t a = 0; a < n; ++a) {
    double own = 0;
    for (const auto& [cell, p] : shares[a]) own += p;
    // Sums of a few dozen doubles in another order.
    EXPECT_NEAR(own, power[a], 1e-12 * power[a]);
    for (std::size_t b = a; b < n; ++b) {
      if (shares[a].empty() || shares[b].empty()) continue;
      const double scale = std::sqrt(power[a] * power[b]);
      double expected = 0, turned = 0;
      bool face = false;
      for (const auto& [cell, p] : shares[a]) {
        const auto other = shares[b].find(cell);
        if (other == shares[b].end()) continue;
        // In the sweep a face has a quarter of a turn beside its own bin, forwards or back by its hash.
        const bool turns = s.frustum == FrustumKind::sweep && cell.face != kNoFace && a != b;
        (turns ? turned : expected) += std::sqrt(p * other->second);
        face |= cell.face != kNoFace;
      }
      const std::complex<double> measured = products[a * n + b] / (kSeeds * scale);
      const double error = std::max(0.0, std::abs(measured - expected / scale) - turned / scale);
      expected += turned;
      EXPECT_LT(error, tolerance) << "bins " << a << " and " << b << ": expected " << expected / scale;
      if (a == b) continue;
      (expected > 0 ? sharing : apart) += 1;
      strongly += expected / scale > 3 * tolerance ? 1 : 0;
      by_a_face += face ? 1 : 0;
      double& worst = expected > 0 ? worst_sharing : worst_apart;
      worst = std::max(worst, error);
    }
  }
  std::printf(
      "    %d pairs share ground (%d of them above %.3f, %d a face), worst error %.4f; %d do not, worst "
      "%.4f\n",
      sharing, strongly, 3 * tolerance, by_a_face, worst_sharing, apart, worst_apart);
  // Neighbours share the cells that their edge cuts, of faces as of ground.
  EXPECT_GE(strongly, 3);
  EXPECT_GE(by_a_face, 5);
  EXPECT_GE(sharing - by_a_face, 15);
  EXPECT_GE(apart, 300);
}

INSTANTIATE_TEST_SUITE_P(Sources, SpeckleOfEverySource, testing::ValuesIn(test::kEverySource),
                         test::source_name<testing::TestParamInfo<test::NamedSource>>);

}  // namespace
}  // namespace obliq::speckle_statistics_test
