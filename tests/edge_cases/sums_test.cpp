// Sums in the bins: many equal contributions, contributions of very different size, opposite phases. The
// accumulators are fed by hand, so that every contribution is known to the last bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <random>

#include "server/radar/echo/echo_bins.h"
#include "server/radar/frame_plan.h"
#include "tests/support/made_worlds.h"
#include "tests/support/sane_frames.h"
#include "tests/support/scenes.h"

namespace obliq {
namespace {

constexpr int kMillion = 1000000;

/// One azimuth bin of four range bins, 1000 to 1400 m, over flat ground of gamma 1.
class HardSums : public testing::Test {
 protected:
  HardSums() : scene_(test::make_scene(test::made_world(2000, 100, [](double, double) { return 0.0; }))) {
    settings_.frustum = FrustumKind::oblique;
    settings_.r_min_m = 1000;
    settings_.r_max_m = 1400;
    settings_.azimuth_bins = 1;
    settings_.range_bins = 4;
  }

  struct Sample {
    double slant_range_m;
    double solid_angle_sr;
  };

  /// What the bins hold after n samples at one place of the ground.
  BinBlock binned(int n, const std::function<Sample(int)>& sample) const {
    const Pose pose = test::pose_at(scene_->world(), {0, 600, 0}, 0);
    const PlanResult planned = plan_frame(scene_, test::snapshot(settings_), pose);
    const ScenePlan& plan = planned.plan->looks_at();
    const ScatteringTable scattering(scene_->materials(), plan.wavelength_m());
    const SpeckleField speckle(scene_->world(), pose.antenna.m, plan.wavelength_m(),
                               plan.bins().range_spacing_m, plan.bins().azimuth_width_rad, 1);
    EchoBins bins(plan, scattering, speckle, {0, 1});
    const auto batch = std::make_unique<SampleBatch>();
    for (int k = 0; k < n;) {
      batch->n = 0;
      while (k < n && batch->n < kBatch) {
        const auto s = static_cast<std::size_t>(batch->n++);
        const Sample one = sample(k++);
        batch->azimuth_bin[s] = 0;
        batch->slant_range_m[s] = one.slant_range_m;
        batch->solid_angle_sr[s] = one.solid_angle_sr;
        batch->cos_incidence[s] = 0.5;
        batch->azimuth_offset_rad[s] = 0;
        batch->sin_elevation[s] = -0.5;
        batch->x_m[s] = 3;
        batch->z_m[s] = 870;
        batch->face[s] = kNoFace;
        batch->material[s] = 0;
      }
      bins.add(*batch);
    }
    BinBlock block(0, 1, 4);
    bins.write(block);
    return block;
  }

  /// The radar equation for gamma 1, in long double: K dOmega / r^2.
  long double power_w(const Sample& sample) const {
    const long double r = sample.slant_range_m;
    return static_cast<long double>(test::radar_constant(settings_)) * sample.solid_angle_sr / (r * r);
  }

  std::shared_ptr<const Scene> scene_;
  RadarSettings settings_;
};

/// Recursive summation of n positive terms errs by at most (n - 1) 2^-53 of their sum (Higham 2002, section
/// 4.2): 1.1e-10 for a million; the terms' own rounding adds under 1e-15. Accumulators in float err by
/// up to 6 %, here by 3.5e-4, and fail.
constexpr double kSumError = 1e-9;

TEST_F(HardSums, AMillionEqualContributionsAddUpInDouble) {
  const Sample one{1150.0625, 1.7e-9};
  const BinBlock bins = binned(kMillion, [&](int) { return one; });
  const double expected = static_cast<double>(kMillion * power_w(one));
  EXPECT_EQ(bins.count[1], static_cast<std::uint32_t>(kMillion));
  EXPECT_NEAR(bins.power_w[1] / expected, 1, kSumError);
  float in_float = 0;
  for (int k = 0; k < kMillion; ++k) in_float += static_cast<float>(power_w(one));
  std::printf("    relative error %.1e, in float %.1e\n", std::abs(bins.power_w[1] / expected - 1),
              std::abs(static_cast<double>(in_float) / expected - 1));
  EXPECT_GT(std::abs(static_cast<double>(in_float) / expected - 1), kSumError) << "the test cannot fail";
  for (const std::size_t other : {0u, 2u, 3u}) EXPECT_EQ(bins.count[other], 0u);
}

TEST_F(HardSums, ContributionsOverTwelveDecadesAddUpInAnyOrder) {
  std::mt19937_64 random(12);
  std::vector<Sample> samples;
  for (int k = 0; k < kMillion; ++k) {
    const double u = static_cast<double>(random() >> 11) * 0x1p-53;
    samples.push_back(
        {1101 + 98 * (static_cast<double>(random() >> 11) * 0x1p-53), std::pow(10.0, -3 - 12 * u)});
  }
  const auto check = [&](const char* order) {
    long double expected = 0;
    for (const Sample& sample : samples) expected += power_w(sample);
    const BinBlock bins = binned(kMillion, [&](int k) { return samples[static_cast<std::size_t>(k)]; });
    EXPECT_EQ(bins.count[1], static_cast<std::uint32_t>(kMillion)) << order;
    EXPECT_NEAR(bins.power_w[1] / static_cast<double>(expected), 1, kSumError) << order;
  };
  check("random");
  const auto larger = [](const Sample& a, const Sample& b) { return a.solid_angle_sr > b.solid_angle_sr; };
  std::sort(samples.begin(), samples.end(), larger);
  check("falling");  // the smallest are added to a large sum: each loses up to half a unit of it
  std::reverse(samples.begin(), samples.end());
  check("rising");
}

TEST_F(HardSums, AMillionContributionsOfOneScattererHaveItsAmplitude) {
  // The cell's samples add in power first: |v|^2 = n P |u|^2. The output is float32, 6e-8 of each part.
  const Sample one{1150.0625, 1.7e-9};
  const BinBlock bins = binned(kMillion, [&](int) { return one; });
  const BinBlock single = binned(1, [&](int) { return one; });
  const double ratio =
      std::norm(std::complex<double>(bins.iq[1])) / std::norm(std::complex<double>(single.iq[1]));
  EXPECT_NEAR(ratio / kMillion, 1, 4 * 6e-8);
}

TEST_F(HardSums, AMillionVoltagesInPhaseAddUp) {
  settings_.speckle = SpeckleKind::geometric;
  const Sample one{1150.0625, 1.7e-9};
  const BinBlock bins = binned(kMillion, [&](int) { return one; });
  const double expected = kMillion * std::sqrt(static_cast<double>(power_w(one)));
  // Float32 output of two parts; a float accumulator is off by 1e-4 and more.
  EXPECT_NEAR(std::abs(std::complex<double>(bins.iq[1])) / expected, 1, 2 * 6e-8);
}

TEST_F(HardSums, OppositePhasesCancel) {
  settings_.speckle = SpeckleKind::geometric;
  const double lambda = test::kSpeedOfLight_m_s / (settings_.frequency_ghz * 1e9);
  // r and r + lambda / 4 lie half a turn apart. r + lambda / 4 is rounded to 2^-43 m, 1.1e-13 / 2, which is
  // 4 pi / lambda x 5.7e-14 m = 2.4e-11 rad; 2 r / lambda, about 77,000 turns, to 7.3e-12 turns, 4.6e-11 rad
  // for each of the pair. All amplitudes are equal: what is left is below 1.2e-10 of their sum. Equal phases
  // (the printed -4 r / lambda, or one way instead of two) leave all of it.
  std::mt19937_64 random(3);
  std::vector<Sample> samples;
  double amplitudes = 0;
  for (int k = 0; k < kMillion / 2; ++k) {
    const double r = 1101 + 98 * (static_cast<double>(random() >> 11) * 0x1p-53);
    // The same power for both: P = K dOmega / r^2.
    const double far = r + lambda / 4;
    samples.push_back({r, 1e-9 * r * r});
    samples.push_back({far, 1e-9 * far * far});
    amplitudes += 2 * std::sqrt(static_cast<double>(power_w(samples.back())));
  }
  const BinBlock bins = binned(kMillion, [&](int k) { return samples[static_cast<std::size_t>(k)]; });
  const double left = std::abs(std::complex<double>(bins.iq[1])) / amplitudes;
  std::printf("    %.1e of the amplitudes' sum is left\n", left);
  EXPECT_LT(left, 1.2e-10);
  // Power knows no phase.
  EXPECT_NEAR(bins.power_w[1] / (kMillion * static_cast<double>(power_w(samples[0]))), 1, kSumError);
}

TEST_F(HardSums, PowersThatUnderflowAreZerosAndNotNaN) {
  // K is about 4e-507 W m^2, below the least double: every power underflows.
  settings_.power_w = 1e-300;
  settings_.gain_db = -100;
  const BinBlock bins = binned(1000, [&](int) { return Sample{1150, 1e-9}; });
  EXPECT_EQ(bins.count[1], 1000u);
  EXPECT_GE(bins.power_w[1], 0);
  EXPECT_TRUE(std::isfinite(bins.iq[1].real()) && std::isfinite(bins.iq[1].imag()));
}

}  // namespace
}  // namespace obliq
