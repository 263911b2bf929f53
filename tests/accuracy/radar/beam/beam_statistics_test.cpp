// I&Q behind beam and pulse: the power of coherent sums, their statistics, and the same bits whatever the
// threads, the wedges and the instruction set.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>

#include "server/radar/beam/echo_sums.h"
#include "server/radar/frame_plan.h"
#include "server/radar/simd/kernels.h"
#include "tests/support/same_bits.h"
#include "tests/support/scenes.h"

namespace obliq::beam_statistics_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kSpeedOfLight_m_s = 299792458.0;

/// Six bins a beamwidth, 0.1 deg and 15 m each.
RadarSettings blurred(FrustumKind kind) {
  RadarSettings s;
  s.frustum = kind;
  s.sector_deg = 12;
  s.azimuth_bins = 120;
  s.range_bins = 200;
  s.r_min_m = 3000;
  s.r_max_m = 6000;
  s.pixel_columns = 240;
  s.pixel_rows = 800;
  s.speckle = SpeckleKind::ground;
  s.beam.pattern = BeamPattern::gaussian;
  s.beam.width_deg = 0.6;
  s.pulse.kind = PulseKind::compressed;
  s.pulse.window = PulseWindow::hamming;
  return s;
}

struct Sampling {
  std::string name;
  FrustumKind kind;
  int columns;
  int sub_columns;
};

class CoherentSums : public testing::TestWithParam<Sampling> {};

TEST_P(CoherentSums, HaveTheMeanPowerThatThePowerPlaneSays) {
  for (const auto& scene : {test::level_ground(), test::hills_with_houses(150)}) {
    RadarSettings s = blurred(GetParam().kind);
    s.pixel_columns = GetParam().columns;
    s.sub_columns = GetParam().sub_columns;
    double sum = 0;
    double squares = 0;
    double n = 0;
    for (int seed = 1; seed <= 6; ++seed) {
      s.speckle_seed = seed;
      const Frame frame =
          render(scene, test::snapshot(s), test::pose_over_origin(scene->world(), 1000), {0, s.azimuth_bins});
      for (std::size_t k = 0; k < frame.bins.iq.size(); ++k) {
        if (!(frame.bins.power_w[k] > 0)) continue;
        const double ratio = static_cast<double>(std::norm(frame.bins.iq[k])) / frame.bins.power_w[k];
        sum += ratio;
        squares += ratio * ratio;
        ++n;
      }
    }
    // Neighbours share: a beam of 6 bins sees 6 x 0.753, a Hamming response 1.36, so many are one draw of
    // |g|^4.
    const double independent = n / (6 * 0.753 * 1.36);
    const double mean = sum / n;
    EXPECT_NEAR(mean, 1, 5 / std::sqrt(independent)) << GetParam().name;
    // Contrast 1: the mean square of an exponential law is 2. Its variance is 20 - 4.
    if (scene == test::level_ground()) {
      EXPECT_NEAR(squares / n / (mean * mean), 2, 5 * 4 / std::sqrt(independent));
    }
  }
}
INSTANTIATE_TEST_SUITE_P(AllFrusta, CoherentSums,
                         testing::Values(Sampling{"fast1", FrustumKind::sweep, 120, 64},
                                         Sampling{"fast2", FrustumKind::sweep, 240, 64},
                                         Sampling{"fast8", FrustumKind::sweep, 960, 64},
                                         Sampling{"exact1", FrustumKind::sweep, 120, 0},
                                         Sampling{"exact2", FrustumKind::sweep, 240, 0},
                                         Sampling{"exact8", FrustumKind::sweep, 960, 0},
                                         Sampling{"symmetric", FrustumKind::symmetric, 480, 64},
                                         Sampling{"oblique", FrustumKind::oblique, 480, 64}),
                         [](const auto& test) { return test.param.name; });

/// Mean of v[a][r] conj(v[a + da][r + dr]) over the frame, over the mean power.
std::complex<double> correlation(const BinBlock& bins, int da, int dr) {
  std::complex<double> sum = 0;
  double power = 0;
  const auto at = [&](int a, int r) {
    const auto k =
        static_cast<std::size_t>(a) * static_cast<std::size_t>(bins.n_range) + static_cast<std::size_t>(r);
    return std::complex<double>(bins.iq[k]) / std::sqrt(bins.power_w[k]);
  };
  for (int a = 0; a + da < bins.n_azimuth; ++a)
    for (int r = 0; r + dr < bins.n_range; ++r) {
      sum += at(a, r) * std::conj(at(a + da, r + dr));
      power += std::norm(at(a, r));
    }
  return sum / power;
}

Frame level_frame(const RadarSettings& s, std::uint64_t draw = 0) {
  RenderOptions options;
  options.draw = draw;
  return render(test::level_ground(), test::snapshot(s),
                test::pose_over_origin(test::level_ground()->world(), 1000), {0, s.azimuth_bins}, options);
}

/// Of white noise through a Hamming response whose resolution is a bin: (h * h)_j / sum h^2, h = {.., F, 1,
/// F, ..}.
double hamming_correlation(int lag) {
  constexpr double kF = 0.46 / 1.08;
  const double h[] = {0, 0, kF, 1, kF, 0, 0};
  double sum = 0, power = 0;
  for (int j = 0; j < 7; ++j) {
    power += h[j] * h[j];
    if (j + lag < 7) sum += h[j] * h[j + lag];
  }
  return sum / power;
}

TEST(BeamStatistics, BearingsAreAsAlikeAsTheBeamsOverlap) {
  RadarSettings s = blurred(FrustumKind::sweep);
  s.azimuth_bins = 240;
  s.sector_deg = 24;
  s.pixel_columns = 480;
  const Frame frame = level_frame(s);
  const double n = 240 * 200 / (6 * 0.753 * 1.36);
  // exp(-(j w)^2 / 4 s^2), s = theta3 / 2.3548, 2 % wider on the ground, where e is 10 to 20 degrees.
  const double sigma_bins = 6 / 2.3548 * 1.02;
  for (const int j : {1, 3, 6, 10}) {
    EXPECT_NEAR(correlation(frame.bins, j, 0).real(), std::exp(-j * j / (4 * sigma_bins * sigma_bins)),
                5 / std::sqrt(n))
        << j;
    EXPECT_NEAR(correlation(frame.bins, j, 0).imag(), 0, 5 / std::sqrt(n)) << j;
  }
  for (const int j : {1, 2, 3})
    EXPECT_NEAR(correlation(frame.bins, 0, j).real(), hamming_correlation(j), 5 / std::sqrt(n));
}

/// Largest distance between the values' distribution and 1 - exp(-x) (Kolmogorov 1933).
double distance_from_exponential(std::vector<double> values) {
  std::ranges::sort(values);
  const auto n = static_cast<double>(values.size());
  double farthest = 0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    const double law = 1 - std::exp(-values[k]);
    farthest = std::max({farthest, law - static_cast<double>(k) / n, static_cast<double>(k + 1) / n - law});
  }
  return farthest;
}

TEST(BeamStatistics, BeamsFourWidthsApartAreDrawsOfTheirOwnFromAnExponentialLaw) {
  constexpr int kApart = 24;  // four widths of six bins
  constexpr int kGates = 4;   // a Hamming response is gone
  RadarSettings s = blurred(FrustumKind::sweep);
  s.azimuth_bins = 240;
  s.sector_deg = 24;
  s.pixel_columns = 480;
  std::vector<double> powers;
  std::complex<double> alike = 0;
  for (int seed = 1; seed <= 6; ++seed) {
    s.speckle_seed = seed;
    const Frame frame = level_frame(s);
    const auto value = [&](int a, int r) {
      const auto k = static_cast<std::size_t>(a * s.range_bins + r);
      return std::complex<double>(frame.bins.iq[k]) / std::sqrt(frame.bins.power_w[k]);
    };
    for (int a = 0; a < s.azimuth_bins; a += kApart)
      for (int r = 0; r < s.range_bins; r += kGates) {
        powers.push_back(std::norm(value(a, r)));
        if (a >= kApart) alike += value(a, r) * std::conj(value(a - kApart, r));
      }
  }
  const double root = std::sqrt(static_cast<double>(powers.size()));
  // Exceeded by chance once in a thousand times: 1.95 / sqrt(n).
  EXPECT_LT(distance_from_exponential(powers), 1.95 / root);
  EXPECT_LT(std::abs(alike) / static_cast<double>(powers.size()), 5 / root);
  for (double& x : powers) x *= 1.2;
  EXPECT_GT(distance_from_exponential(powers), 1.95 / root);
}

TEST(BeamStatistics, SharpBinsAddUpTooBrightForACellInTwoBinsHasOnePhase) {
  // What the rule of owners is for: the same beam over bins that were made to stand alone. Eight planes a
  // bin, so that a scatterer's cell lies across many of them.
  RadarSettings s = blurred(FrustumKind::sweep);
  s.pulse.kind = PulseKind::off;
  s.pixel_columns = 960;
  s.sub_columns = 0;
  double by_hand = 0, by_owners = 0, n = 0;
  for (int seed = 1; seed <= 6; ++seed) {
    s.speckle_seed = seed;
    RadarSettings sharp = s;
    sharp.beam.pattern = BeamPattern::off;
    const Frame alone = level_frame(sharp);
    const Frame blurred_frame = level_frame(s);
    for (int a = 12; a < s.azimuth_bins - 12; ++a)
      for (int r = 0; r < s.range_bins; ++r) {
        std::complex<double> voltage = 0;
        double power = 0;
        for (int j = -12; j <= 12; ++j) {
          const double g = std::exp(-4 * std::numbers::ln2 * (j / 6.0) * (j / 6.0));
          const auto k = static_cast<std::size_t>((a + j) * s.range_bins + r);
          voltage += g * std::complex<double>(alone.bins.iq[k]);
          power += g * g * alone.bins.power_w[k];
        }
        const auto k = static_cast<std::size_t>(a * s.range_bins + r);
        by_hand += std::norm(voltage) / power;
        by_owners += static_cast<double>(std::norm(blurred_frame.bins.iq[k])) / blurred_frame.bins.power_w[k];
        ++n;
      }
  }
  EXPECT_GT(10 * std::log10(by_hand / n), 0.2);
  EXPECT_NEAR(10 * std::log10(by_owners / n), 0, 0.15);
}

TEST(IndependentSpeckle, IsWhiteOverAzimuthAndThePulseOverRange) {
  RadarSettings s = blurred(FrustumKind::sweep);
  s.speckle = SpeckleKind::independent;
  const Frame frame = level_frame(s, 7);
  const double n = 120 * 200 / 1.36;
  for (const int j : {1, 2, 5}) EXPECT_LT(std::abs(correlation(frame.bins, j, 0)), 5 / std::sqrt(n));
  for (const int j : {1, 2, 3})
    EXPECT_NEAR(correlation(frame.bins, 0, j).real(), hamming_correlation(j), 5 / std::sqrt(n));
  double mean = 0, square = 0;
  for (std::size_t k = 0; k < frame.bins.iq.size(); ++k) {
    const double ratio = static_cast<double>(std::norm(frame.bins.iq[k])) / frame.bins.power_w[k];
    mean += ratio / static_cast<double>(frame.bins.iq.size());
    square += ratio * ratio / static_cast<double>(frame.bins.iq.size());
  }
  EXPECT_NEAR(mean, 1, 5 / std::sqrt(n));
  EXPECT_NEAR(square, 2, 5 * 4 / std::sqrt(n));
}

TEST(IndependentSpeckle, RepeatsWithItsDrawAndHasThePowerOfTheGroundsOwn) {
  RadarSettings s = blurred(FrustumKind::sweep);
  const Frame ground = level_frame(s);
  s.speckle = SpeckleKind::independent;
  const Frame one = level_frame(s, 1);
  const Frame again = level_frame(s, 1);
  const Frame other = level_frame(s, 2);
  EXPECT_TRUE(test::same_bits(one.bins.iq, again.bins.iq));
  EXPECT_TRUE(test::same_bits(one.bins.power_w, ground.bins.power_w));
  std::complex<double> alike = 0;
  double power = 0;
  for (std::size_t k = 0; k < one.bins.iq.size(); ++k) {
    alike += std::complex<double>(one.bins.iq[k]) * std::conj(std::complex<double>(other.bins.iq[k])) /
             one.bins.power_w[k];
    power += 1;
  }
  EXPECT_LT(std::abs(alike) / power, 5 / std::sqrt(power / 1.36));
}

TEST(NoSpeckle, IsTheRootOfThePowerWithThePhaseOfTheBinsMiddle) {
  for (const bool sharp : {true, false}) {
    RadarSettings s = blurred(FrustumKind::sweep);
    s.speckle = SpeckleKind::none;
    if (sharp) {
      s.beam.pattern = BeamPattern::off;
      s.pulse.kind = PulseKind::off;
    }
    const Frame frame = level_frame(s);
    for (const int r : {0, 63, 199}) {
      const std::complex<double> iq(frame.bins.iq[static_cast<std::size_t>(r)]);
      const double power = frame.bins.power_w[static_cast<std::size_t>(r)];
      EXPECT_NEAR(std::norm(iq) / power, 1, 1e-6);
      const double range_m = 3000 + (r + 0.5) * 15;
      const double turned = std::arg(iq * std::polar(1.0, 4 * kPi * range_m / (kSpeedOfLight_m_s / 10e9)));
      EXPECT_NEAR(turned, 0, 1e-4) << r;
    }
  }
}

void expect_part(const Frame& whole, const RadarSettings& s, const Pose& pose, AzimuthRange azimuths,
                 const RenderOptions& options) {
  const Frame part = render(test::hills_with_houses(150), test::snapshot(s), pose, azimuths, options);
  BinBlock same(azimuths.first, azimuths.count, s.range_bins);
  copy_azimuths(whole.bins, same);
  EXPECT_TRUE(test::same_bits(same.iq, part.bins.iq)) << azimuths.first;
  EXPECT_TRUE(test::same_bits(same.power_w, part.bins.power_w)) << azimuths.first;
}

class SameBitsBehindABeam : public testing::TestWithParam<SpeckleKind> {};

TEST_P(SameBitsBehindABeam, ForAnyThreadsAndParts) {
  RadarSettings s = blurred(GetParam() == SpeckleKind::geometric ? FrustumKind::oblique : FrustumKind::sweep);
  s.speckle = GetParam();
  s.azimuth_bins = 100;  // the last wedge is half one
  const auto scene = test::hills_with_houses(150);
  const Pose pose = test::pose_over_origin(scene->world(), 1000);
  RenderOptions options;
  options.threads = 1;
  options.draw = 5;
  const Frame one = render(scene, test::snapshot(s), pose, {0, s.azimuth_bins}, options);
  for (const int threads : {2, 8}) {
    options.threads = threads;
    const Frame several = render(scene, test::snapshot(s), pose, {0, s.azimuth_bins}, options);
    EXPECT_TRUE(test::same_bits(one.bins.iq, several.bins.iq)) << threads;
    EXPECT_TRUE(test::same_bits(one.bins.power_w, several.bins.power_w)) << threads;
    EXPECT_EQ(one.bins.state, several.bins.state);
    EXPECT_EQ(one.stats.samples, several.stats.samples);
  }
  expect_part(one, s, pose, {0, 8}, options);
  expect_part(one, s, pose, {48, 16}, options);
  expect_part(one, s, pose, {96, 4}, options);
}

TEST(BeamLookingDown, WhereOuterSharpWedgesSeeTheNearGroundAlone) {
  RadarSettings s = blurred(FrustumKind::sweep);
  s.sub_columns = 64;
  s.r_min_m = 1030;
  s.r_max_m = s.r_min_m + 15 * s.range_bins;
  const Pose pose = test::pose_over_origin(test::hills_with_houses(150)->world(), 1000);
  const EchoPlan echo = *plan_frame(test::hills_with_houses(150), test::snapshot(s), pose).plan->sum();
  const AzimuthRange part{48, 8};
  EXPECT_LT(needed_range_m(echo, echo.first_row(part.first) / kWedgeAzimuthBins, part), s.r_max_m - 500);
  expect_part(render(test::hills_with_houses(150), test::snapshot(s), pose, {0, s.azimuth_bins}), s, pose,
              part, {});
}

INSTANTIATE_TEST_SUITE_P(Kinds, SameBitsBehindABeam,
                         testing::Values(SpeckleKind::ground, SpeckleKind::independent, SpeckleKind::none,
                                         SpeckleKind::geometric));

TEST(EchoSums, HasTheSameBitsWithAllInstructionSets) {
  RadarSettings s = blurred(FrustumKind::sweep);
  for (const SpeckleKind kind : {SpeckleKind::ground, SpeckleKind::independent}) {
    s.speckle = kind;
    std::vector<FieldError> errors;
    const auto plan = plan_echo(s, {1000, 0}, errors);
    ASSERT_TRUE(plan);
    BinBlock sharp(0, 8, plan->sharp.range_bins);
    for (std::size_t k = 0; k < sharp.iq.size(); ++k) {
      const auto x = static_cast<double>(k * 2654435761u % 1000) + 1;
      sharp.power_w[k] = x * 1e-12;
      sharp.iq[k] = {static_cast<float>(std::sqrt(x)), static_cast<float>(-x)};
      sharp.sin_elevation.push_back(static_cast<float>(-0.4 * x / 1000));
    }
    const SharpWedge wedge(*plan, std::move(sharp), {}, {.iq = true});
    // Every row of the output's is one of these eight.
    std::vector<SharpWedge> rows(static_cast<std::size_t>(plan->sharp.azimuth_bins), wedge);
    std::vector<const SharpWedge*> pointers;
    EchoSums widest(*plan);
    for (int k = 0; k < plan->rows_of(8); ++k) {
      rows[static_cast<std::size_t>(k)].first_azimuth = (plan->first_row(0) + k) / 8 * 8;
      pointers.push_back(&rows[static_cast<std::size_t>(k)]);
    }
    BinBlock expected(0, 8, s.range_bins);
    widest.sum(pointers, 3, true, false, expected);
    EXPECT_GT(expected.power_w[17], 0);
    for (const Kernels& kernels : all_kernels()) {
      BinBlock got(0, 8, s.range_bins);
      use_kernels(kernels);
      EchoSums(*plan).sum(pointers, 3, true, false, got);
      EXPECT_TRUE(test::same_bits(expected.iq, got.iq)) << kernels.name;
      EXPECT_TRUE(test::same_bits(expected.power_w, got.power_w)) << kernels.name;
    }
  }
}

}  // namespace
}  // namespace obliq::beam_statistics_test
