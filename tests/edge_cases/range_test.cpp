// Slant range at 40 km and 35 GHz against a multiple-precision closed form, and what Embree's own float
// distance would give.
// Sums in the bins: many equal contributions, contributions of very different size, opposite phases. The
// accumulators are fed by hand, so that every contribution is known to the last bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <cstdio>
#include <functional>
#include <random>

#include "server/radar/echo/echo_bins.h"
#include "server/radar/frame_plan.h"
#include "server/radar/render.h"
#include "server/scene/exact_hit.h"
#include "tests/support/figures.h"
#include "tests/support/made_worlds.h"
#include "tests/support/refine_hit.h"
#include "tests/support/samplings.h"
#include "tests/support/sane_frames.h"
#include "tests/support/scenes.h"

namespace obliq::range_test {
namespace {

using Exact = boost::multiprecision::cpp_bin_float_100;  // 100 decimal digits

constexpr double kLambda_m = test::kSpeedOfLight_m_s / 35e9;

/// The bound of the hard case. It leaves 4 pi / lambda x 1e-6 m = 1.5 mrad of phase. What double arithmetic
/// needs: coordinates of 40 km are kept to 2^-37 m = 7e-12 m; the plane is met under a grazing angle whose
/// sine is at least 0.02 here, which makes that 4e-10 m; a dozen operations stay below 1e-8 m.
constexpr double kBound_m = 1e-6;

/// y = x / 16 + z / 64 on 64 m cells: multiples of one metre at the nodes, exact in float32, so that the mesh
/// IS the plane.
constexpr double kSlopeX = 1.0 / 16, kSlopeZ = 1.0 / 64;

struct Ray {
  glm::dvec3 origin;
  glm::dvec3 direction;
};

/// Distance along a ray, whose doubles are taken as exact, to the plane.
Exact exact_range_m(const Ray& ray) {
  const Exact dx = ray.direction.x, dy = ray.direction.y, dz = ray.direction.z;
  const Exact height = Exact(ray.origin.y) - kSlopeX * Exact(ray.origin.x) - kSlopeZ * Exact(ray.origin.z);
  const Exact descent = kSlopeX * dx + kSlopeZ * dz - dy;
  return height / descent * sqrt(dx * dx + dy * dy + dz * dz);
}

/// Rays from one antenna to random places of the plane, half of them between 39.5 and 40.5 km away.
std::vector<Ray> rays_at_forty_kilometres(const glm::dvec3& antenna, int n) {
  std::mt19937_64 random(40);
  const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  std::vector<Ray> rays;
  for (int k = 0; k < n; ++k) {
    const double bearing = 2 * test::kPi * uniform();
    const double ground = k % 2 == 0 ? 39500 + 1000 * uniform() : 500 + 39000 * uniform();
    const glm::dvec3 target(antenna.x + ground * std::sin(bearing), 0,
                            antenna.z + ground * std::cos(bearing));
    glm::dvec3 d = target - antenna;
    d.y = kSlopeX * target.x + kSlopeZ * target.z - antenna.y;
    const double length = std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
    rays.push_back({antenna, d / length});
  }
  return rays;
}

TEST(HardRange, AtFortyKilometresIsWithinAMicrometreOfTheClosedFormAndEmbreesFloatIsNot) {
  const auto scene = test::make_scene(
      test::made_world(44000, 64, [](double x, double z) { return kSlopeX * x + kSlopeZ * z; }));
  double worst_m = 0, float_worst_m = 0, float_squares = 0;
  int hits = 0, float_beyond = 0, at_forty = 0;
  for (const glm::dvec3& antenna : {glm::dvec3(12.345678901, 4000.987654321, -7.654321),
                                    glm::dvec3(0, 3500, 0), glm::dvec3(1000.1, 9000.7, 1234.567)}) {
    const std::vector<Ray> rays = rays_at_forty_kilometres(antenna, 20000);
    for (const Ray& ray : rays) {
      RoughHit rough;
      scene->tracer().trace(antenna, &ray.direction.x, &ray.direction.y, &ray.direction.z, 1, &rough);
      const auto hit = test::refine_hit(scene->world(), antenna, ray.direction, rough);
      if (!hit) continue;
      ++hits;
      const Exact truth = exact_range_m(ray);
      const double off_m = std::abs(static_cast<double>(Exact(hit->slant_range_m) - truth));
      const double float_off_m =
          std::abs(static_cast<double>(Exact(static_cast<double>(rough.distance_m)) - truth));
      worst_m = std::max(worst_m, off_m);
      float_worst_m = std::max(float_worst_m, float_off_m);
      float_squares += float_off_m * float_off_m;
      float_beyond += float_off_m >= kBound_m ? 1 : 0;
      at_forty += truth > 39500 ? 1 : 0;
    }
  }
  std::printf(
      "    %d hits, %d beyond 39.5 km: worst %.1e m, %.1e rad at 35 GHz; Embree's float %.2e m rms, worst "
      "%.2e "
      "m, %.1f rad, %.1f %% of its ranges beyond the bound\n",
      hits, at_forty, worst_m, 4 * test::kPi / kLambda_m * worst_m, std::sqrt(float_squares / hits),
      float_worst_m, 4 * test::kPi / kLambda_m * float_worst_m, 100.0 * float_beyond / hits);
  test::record_figure("range_worst_m", worst_m);
  test::record_figure("range_float_rms_m", std::sqrt(float_squares / hits));
  // The plane's own border cuts some far rays off.
  EXPECT_GT(hits, 50000);
  EXPECT_GT(at_forty, 25000);
  EXPECT_LT(worst_m, kBound_m);
  EXPECT_LT(4 * test::kPi / kLambda_m * worst_m, 1.5e-3);
  // The named wrong version fails the same bound: float32 steps by 3.9 mm at 40 km.
  EXPECT_GT(float_worst_m, 1000 * kBound_m);
  EXPECT_GT(float_beyond, hits / 2);
}

TEST(HardRange, EverySourcesSamplesLieOnThePlaneAtTheirRange) {
  // Whatever finds them: a sample's position is on the plane and as far from the antenna as it says. Only x
  // and z are given; the plane gives y. A sample that stands for one point is exact. One that stands for a
  // stretch of length L within a range bin has its middle for a place and a mean for a range: of r, which
  // departs by the curvature of range over ground, at most (1 / r) (L / 2)^2 / 2 = L^2 / 8r, or of 1 / r^2,
  // which lies nearer by 7 L^2 / 24 r besides.
  const auto scene = test::make_scene(
      test::made_world(44000, 64, [](double x, double z) { return kSlopeX * x + kSlopeZ * z; }));
  const glm::dvec3 antenna(12.345678901, 3500.987654321, -7.654321);
  for (const test::Sampling& sampling : test::kSamplings) {
    RadarSettings s = test::sampled(RadarSettings{}, sampling);
    s.r_min_m = 5000;
    s.r_max_m = 40500;
    s.sector_deg = 50;
    s.frequency_ghz = 35;
    s.azimuth_bins = 8;
    s.range_bins = 512;
    s.pixel_columns = 64;
    s.pixel_rows = 512;
    const Pose pose = test::pose_at(scene->world(), antenna, 200);  // downhill
    const PlanResult planned = plan_frame(scene, test::snapshot(s), pose);
    ASSERT_TRUE(planned.plan) << sampling.name << planned.errors.front().text();
    const auto source = make_sample_source(planned.plan->looks_at(), {0, 8}, nullptr);
    const auto batch = std::make_unique<SampleBatch>();
    FrameStats stats;
    double worst_m = 0, farthest_m = 0;
    int n = 0, beyond = 0;
    while (source->fill(*batch, stats)) {
      for (std::size_t k = 0; k < static_cast<std::size_t>(batch->n); ++k) {
        if (planned.plan->bins().range_bin(batch->slant_range_m[k]) < 0) continue;
        const Exact x = batch->x_m[k], z = batch->z_m[k];
        const Exact dx = x - Exact(antenna.x), dz = z - Exact(antenna.z);
        const Exact dy = kSlopeX * x + kSlopeZ * z - Exact(antenna.y);
        const Exact range = sqrt(dx * dx + dy * dy + dz * dz);
        const double off_m = std::abs(static_cast<double>(range - Exact(batch->slant_range_m[k])));
        const double bin_m = planned.plan->bins().range_spacing_m;
        const double bound_m = sampling.one_sample_a_ray()
                                   ? kBound_m
                                   : kBound_m + 0.42 * bin_m * bin_m / batch->slant_range_m[k];
        worst_m = std::max(worst_m, off_m);
        beyond += off_m < bound_m ? 0 : 1;
        farthest_m = std::max(farthest_m, batch->slant_range_m[k]);
        ++n;
      }
    }
    std::printf("    %s: %d samples to %.0f m, worst %.1e m\n", sampling.name, n, farthest_m, worst_m);
    EXPECT_GT(n, 1000) << sampling.name;
    EXPECT_GT(farthest_m, 40000) << sampling.name;
    EXPECT_EQ(beyond, 0) << sampling.name;
  }
}

TEST(HardRange, PhaseAtFortyKilometresAndThirtyFiveGigahertzIsThatOfTheRange) {
  // One sample a bin, fed by hand, with any double as its range: the bin's phase is -4 pi r / lambda.
  // Rounding: 2 r / lambda, 9.4 million turns, to 9e-10 turns of double, twice (product and
  // wavelength): 1.2e-8 rad; the float32 output 6e-8. Reduction in float, or the printed -4 r / lambda, is
  // off by radians.
  const auto scene = test::make_scene(test::made_world(2000, 100, [](double, double) { return 0.0; }));
  RadarSettings settings;
  settings.frustum = FrustumKind::oblique;
  settings.frequency_ghz = 35;
  settings.speckle = SpeckleKind::geometric;
  settings.r_min_m = 100;
  settings.r_max_m = 41000;
  settings.azimuth_bins = 1;
  settings.range_bins = 4090;  // of 10 m
  const Pose pose = test::pose_at(scene->world(), {0, 100, 0}, 0);
  const PlanResult planned = plan_frame(scene, test::snapshot(settings), pose);
  ASSERT_TRUE(planned.plan);
  const ScatteringTable scattering(scene->materials(), planned.plan->looks_at().wavelength_m());
  const SpeckleField speckle(scene->world(), pose.antenna.m, kLambda_m, 10, 2, 1);
  EchoBins bins(planned.plan->looks_at(), scattering, speckle, {0, 1});
  std::mt19937_64 random(35);
  const auto batch = std::make_unique<SampleBatch>();
  std::vector<double> range_m(4090);
  for (std::size_t bin = 0; bin < range_m.size(); ++bin) {
    range_m[bin] = 100 + 10 * (static_cast<double>(bin) + static_cast<double>(random() >> 11) * 0x1p-53);
    batch->n = 1;
    batch->azimuth_bin[0] = 0;
    batch->slant_range_m[0] = range_m[bin];
    batch->solid_angle_sr[0] = 1e-6;
    batch->cos_incidence[0] = 0.3;
    batch->azimuth_offset_rad[0] = 0;
    batch->sin_elevation[0] = -0.1;
    batch->x_m[0] = batch->z_m[0] = 0;
    batch->face[0] = kNoFace;
    batch->material[0] = 0;
    ASSERT_EQ(bins.add(*batch), 1u);
  }
  BinBlock block(0, 1, 4090);
  bins.write(block);
  double worst_rad = 0, float_worst_rad = 0;
  const Exact lambda = Exact(299792458) / Exact(35000000000);
  for (std::size_t bin = 0; bin < range_m.size(); ++bin) {
    const auto error_rad = [&](double range) {
      Exact turns = -2 * Exact(range) / lambda;
      turns -= floor(turns);
      const double phase = 2 * test::kPi * static_cast<double>(turns);
      return std::abs(std::arg(std::complex<double>(block.iq[bin]) * std::polar(1.0, -phase)));
    };
    worst_rad = std::max(worst_rad, error_rad(range_m[bin]));
    float_worst_rad =
        std::max(float_worst_rad, error_rad(static_cast<double>(static_cast<float>(range_m[bin]))));
  }
  std::printf("    worst %.1e rad; from ranges rounded to float %.1f rad\n", worst_rad, float_worst_rad);
  EXPECT_LT(worst_rad, 1e-7);
  EXPECT_GT(float_worst_rad, 1);
}

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
}  // namespace obliq::range_test
