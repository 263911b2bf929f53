// Bins of the sweep wider than half a degree, which are sums of narrower ones: against closed forms, against
// the narrow bins by themselves, and by their speckle.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "server/radar/beam/echo_rows.h"
#include "server/radar/frame_plan.h"
#include "server/radar/wedge_memory.h"
#include "tests/support/same_bits.h"
#include "tests/support/scenes.h"

namespace obliq::test::wide_bins_test {
namespace {

/// Twelve bins of 5 degrees, ten narrow ones each.
constexpr int kNarrow = 10;
RadarSettings wide_bins() {
  RadarSettings s;
  s.frustum = FrustumKind::sweep;
  s.sector_deg = 60;
  s.r_min_m = 100;
  s.r_max_m = 7100;
  s.azimuth_bins = s.pixel_columns = 12;
  s.range_bins = 100;
  return s;
}

Frame frame_of(const RadarSettings& s, AzimuthRange azimuths, const RenderOptions& options = {}) {
  const auto scene = hills_with_houses(30);
  return render(scene, snapshot(s), pose_over_origin(scene->world(), 250, 20), azimuths, options);
}
Frame frame_of(const RadarSettings& s, const RenderOptions& options = {}) {
  return frame_of(s, {0, s.azimuth_bins}, options);
}

TEST(WideBins, OfAWholeCircleMatchTheClosedFormOverLevelGround) {
  RadarSettings s = wide_bins();
  s.sector_deg = 360;
  s.azimuth_bins = s.pixel_columns = 1;
  s.r_min_m = 0;
  s.r_max_m = 8000;
  s.range_bins = 1000;
  const double height_m = 400;
  const auto scene = level_ground();
  const Frame frame = render(scene, snapshot(s), pose_over_origin(scene->world(), height_m), {0, 1});
  const double lambda = 299792458.0 / 10e9;
  const double k = lambda * lambda / std::pow(4 * std::numbers::pi, 3);
  double total = 0, expected_total = 0, worst = 0;
  for (int r = 0; r < s.range_bins; ++r) {
    const double r1 = std::max(height_m, r * 8.0);
    const double r2 = std::max(height_m, (r + 1) * 8.0);
    const double expected =
        k * 2 * std::numbers::pi * height_m * (1 / (r1 * r1 * r1) - 1 / (r2 * r2 * r2)) / 3;
    const double power_w = frame.bins.power_w[static_cast<std::size_t>(r)];
    total += power_w;
    expected_total += expected;
    if (expected > 0) worst = std::max(worst, std::abs(power_w / expected - 1));
  }
  std::printf("    total %+.2e, worst bin %.2e\n", total / expected_total - 1, worst);
  EXPECT_NEAR(total / expected_total, 1, 1e-6);
  EXPECT_LT(worst, 3e-4) << "floats keep a range of 8 km to 1 mm, of which a bin edge cuts off as much";
}

TEST(WideBins, HaveThePowersCountsAndStatesOfTheirNarrowOnes) {
  const RadarSettings s = wide_bins();
  RadarSettings narrow = s;
  narrow.azimuth_bins = narrow.pixel_columns = kNarrow * s.azimuth_bins;
  const Frame wide = frame_of(s);
  const Frame parts = frame_of(narrow);
  EXPECT_EQ(wide.stats.rays, parts.stats.rays);
  EXPECT_EQ(wide.stats.samples, parts.stats.samples);
  std::uint64_t lit = 0, mixed = 0, nearer = 0;
  const auto n_range = static_cast<std::size_t>(s.range_bins);
  for (std::size_t bin = 0; bin < wide.bins.power_w.size(); ++bin) {
    double power_w = 0;
    std::uint32_t count = 0;
    bool any_sampled = false, alike = true;
    for (std::size_t k = 0; k < kNarrow; ++k) {
      const std::size_t part = (bin / n_range * kNarrow + k) * n_range + bin % n_range;
      power_w += parts.bins.power_w[part];
      count += parts.bins.count[part];
      const auto state = static_cast<BinState>(parts.bins.state[part]);
      any_sampled |= state == BinState::sampled;
      alike &= parts.bins.state[part] == parts.bins.state[bin / n_range * kNarrow * n_range + bin % n_range];
    }
    ASSERT_EQ(wide.bins.power_w[bin], power_w) << bin;
    ASSERT_EQ(wide.bins.count[bin], count) << bin;
    const auto state = static_cast<BinState>(wide.bins.state[bin]);
    ASSERT_EQ(state == BinState::sampled, any_sampled) << bin;
    lit += any_sampled ? 1 : 0;
    mixed += any_sampled && !alike ? 1 : 0;
    nearer += state == BinState::nearer_than_ground ? 1 : 0;
  }
  EXPECT_EQ(wide.stats.lit_bins, lit + wide.stats.unsampled_bins);
  EXPECT_GT(lit, 500u);
  EXPECT_GT(mixed, 0u);
  EXPECT_GT(nearer, 0u);
}

/// Four planes a narrow bin: cells lie across its edges, and answer with one phase on both sides unless each
/// belongs to one bin.
TEST(WideBins, HaveSpeckleOfTheirPower) {
  RadarSettings s = wide_bins();
  s.pixel_columns = 4 * kNarrow * s.azimuth_bins;
  double sum = 0, squares = 0;
  int n = 0;
  for (s.speckle_seed = 1; s.speckle_seed <= 40; ++s.speckle_seed) {
    const Frame frame = frame_of(s);
    for (std::size_t bin = 0; bin < frame.bins.power_w.size(); ++bin) {
      if (!(frame.bins.power_w[bin] > 0)) continue;
      const double ratio = static_cast<double>(std::norm(frame.bins.iq[bin])) / frame.bins.power_w[bin];
      sum += ratio;
      squares += ratio * ratio;
      ++n;
    }
  }
  const double mean = sum / n;
  const double chance = std::sqrt((squares / n - mean * mean) / n);
  std::printf("    mean |iq|^2 / power %.4f, by chance within %.4f, of %d bins\n", mean, chance, n);
  EXPECT_NEAR(mean, 1, 4 * chance);
  EXPECT_LT(chance, 0.01);
}

TEST(WideBins, HaveTheSameBitsInAnyWindowByAnyThreads) {
  const RadarSettings s = wide_bins();
  RenderOptions one, two;
  one.threads = 1;
  two.threads = 2;
  const Frame whole = frame_of(s, one);
  expect_same_bits(whole.bins, frame_of(s, two).bins);
  BinBlock windows(0, s.azimuth_bins, s.range_bins);
  for (const AzimuthRange window : {AzimuthRange{8, 4}, AzimuthRange{0, 8}})
    copy_azimuths(frame_of(s, window, two).bins, windows);
  expect_same_bits(whole.bins, windows);
}

/// A beam of 12 degrees has sharp bins of 5.
TEST(WideBins, BehindABeamAreSumsTooDwellByDwell) {
  RadarSettings s = wide_bins();
  s.beam.pattern = BeamPattern::gaussian;
  s.beam.width_deg = 12;
  s.pulse.kind = PulseKind::rectangular;
  const auto scene = hills_with_houses(30);
  const Pose pose = pose_over_origin(scene->world(), 250, 20);
  const PlanResult planned = plan_frame(scene, snapshot(s), pose);
  ASSERT_TRUE(planned.plan);
  EXPECT_EQ(planned.plan->narrow_bins(), kNarrow);
  const BinGrid& looked_at = planned.plan->looks_at().bins();
  EXPECT_LE(looked_at.azimuth_width_rad, 0.5000001 * std::numbers::pi / 180);
  const Frame whole = frame_of(s);
  SharpStore store;
  RenderOptions dwell;
  dwell.sharp = &store;
  BinBlock dwells(0, s.azimuth_bins, s.range_bins);
  for (const AzimuthRange window : {AzimuthRange{0, 8}, AzimuthRange{8, 4}})
    copy_azimuths(frame_of(s, window, dwell).bins, dwells);
  expect_same_bits(whole.bins, dwells);
}

TEST(WideBins, BehindAPulseAloneHaveThePowersOfTheirNarrowOnes) {
  RadarSettings s = wide_bins();
  s.pulse.kind = PulseKind::rectangular;
  RadarSettings narrow = s;
  narrow.azimuth_bins = narrow.pixel_columns = kNarrow * s.azimuth_bins;
  const Frame wide = frame_of(s);
  const Frame parts = frame_of(narrow);
  const auto n_range = static_cast<std::size_t>(s.range_bins);
  for (std::size_t bin = 0; bin < wide.bins.power_w.size(); ++bin) {
    double power_w = 0;
    for (std::size_t k = 0; k < kNarrow; ++k)
      power_w += parts.bins.power_w[(bin / n_range * kNarrow + k) * n_range + bin % n_range];
    ASSERT_NEAR(wide.bins.power_w[bin], power_w, 1e-5 * power_w) << bin;
  }
}

TEST(WideBins, OfExactPlanesAndCamerasAreNotDivided) {
  const auto scene = level_ground();
  const auto divided = [&](const RadarSettings& s) {
    return plan_frame(scene, snapshot(s), pose_over_origin(scene->world(), 400)).plan->narrow_bins();
  };
  RadarSettings s = wide_bins();
  s.r_min_m = 1000;  // a camera's nearest ground
  EXPECT_EQ(divided(s), kNarrow);
  s.sub_columns = 0;
  EXPECT_EQ(divided(s), 1);
  s.sub_columns = 64;
  s.frustum = FrustumKind::oblique;
  EXPECT_EQ(divided(s), 1);
  s.frustum = FrustumKind::sweep;
  s.azimuth_bins = 120;
  EXPECT_EQ(divided(s), 1) << "half a degree is not wide";
  s.azimuth_bins = 119;
  EXPECT_EQ(divided(s), 2);
}

}  // namespace
}  // namespace obliq::test::wide_bins_test
