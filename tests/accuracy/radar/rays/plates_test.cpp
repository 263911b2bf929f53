// Plates spread over the range bins that their pixels cover: energy conserved, nothing in the dark, closer to
// the truth than the nearest bin.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <map>
#include <mutex>

#include "server/accuracy/bin_errors.h"
#include "server/radar/frame_plan.h"
#include "server/radar/rays/ray_samples.h"
#include "server/radar/render.h"
#include "server/radar/samples.h"
#include "server/radar/visibility/wedge_visibility.h"
#include "server/truth/reference.h"
#include "tests/support/made_worlds.h"
#include "tests/support/scenes.h"

namespace obliq::plates_test {
namespace {

constexpr FrustumKind kKinds[] = {FrustumKind::symmetric, FrustumKind::oblique};
constexpr const char* kNames[] = {"symmetric", "oblique"};

/// Hills 300 m high with prisms all over, seen from 900 m.
std::shared_ptr<const Scene> hills_with_prisms() {
  WorldSpec spec = test::synthetic_spec(SyntheticKind::hills, 6500, 25);
  spec.terrain.shape.height_m = 300;
  spec.radius_factor = 4.0 / 3;
  spec.prisms.emplace_back();
  spec.prisms[0].per_km2 = 40;
  return test::make_scene(load_world(spec));
}

RadarSettings settings_of(FrustumKind kind, PlateKind plates, int columns, int rows) {
  RadarSettings s = test::radar_settings(kind, {1200, 6000, 60}, {64, 128}, {columns, rows});
  s.plates = plates;
  return s;
}

std::shared_ptr<const FramePlan> plan_of(const std::shared_ptr<const Scene>& scene, const RadarSettings& s) {
  const PlanResult planned =
      plan_frame(scene, test::snapshot(s), test::pose_over_origin(scene->world(), 900, 30));
  if (!planned.plan) throw std::runtime_error(planned.errors.front().text());
  return planned.plan;
}

class HitPixels : public HitObserver {
 public:
  void on_hit(std::uint32_t pixel, double, const ExactHit&) override { ++hits_[pixel]; }
  bool has(std::uint32_t pixel) const { return hits_.contains(pixel); }
  std::size_t size() const { return hits_.size(); }

 private:
  std::map<std::uint32_t, int> hits_;
};

TEST(Plates, SolidAnglesOfAPlateAddUpToThePixels) {
  // Every pixel whose ray meets something gives its whole solid angle, whatever it covers. Sums of a few ten
  // thousand doubles: 1e-12 is thousands of roundings. A version that drops what lies beyond a crest, or
  // outside the swath, or counts a strand of a building twice, is off by more than 1e-4.
  const auto scene = hills_with_prisms();
  for (const FrustumKind kind : kKinds) {
    const auto plan = plan_of(scene, settings_of(kind, PlateKind::spread, 128, 96));
    const AzimuthRange range{8, 24};
    HitPixels pixels;
    const auto samples = std::make_unique<SampleBatch>();
    const auto source = make_sample_source(plan->looks_at(), range, &pixels);
    FrameStats stats;
    double sum_sr = 0;
    std::uint64_t n = 0;
    while (source->fill(*samples, stats)) {
      for (std::size_t k = 0; k < static_cast<std::size_t>(samples->n); ++k) {
        EXPECT_GT(samples->solid_angle_sr[k], 0);
        EXPECT_TRUE(std::isfinite(samples->slant_range_m[k]));
        EXPECT_LE(samples->cos_incidence[k], 1);
        sum_sr += samples->solid_angle_sr[k];
        ++n;
      }
    }
    double expected_sr = 0;
    const auto rays = std::make_unique<RayBatch>();
    const auto ray_source = make_ray_source(plan->looks_at(), range);
    while (ray_source->generate(*rays))
      for (std::size_t k = 0; k < static_cast<std::size_t>(rays->n); ++k)
        if (pixels.has(rays->pixel[k])) expected_sr += rays->solid_angle_sr[k];
    std::printf("    %s: %zu pixels hit, %llu samples, %.3g sr, off by %.2g\n",
                kNames[static_cast<int>(kind)], pixels.size(), static_cast<unsigned long long>(n),
                expected_sr, sum_sr / expected_sr - 1);
    EXPECT_GT(pixels.size(), 2000u);
    EXPECT_GT(n, pixels.size() * 5 / 4) << "plates are spread";
    EXPECT_NEAR(sum_sr / expected_sr, 1, 1e-12) << kNames[static_cast<int>(kind)];
  }
}

TEST(Plates, NoLightFallsIntoBinsThatEveryProfileCallsHidden) {
  // The profiles of an azimuth bin stand no farther apart than grid nodes here. A ray between two of them may
  // see what they do not, and that it does with nearest plates too.
  for (const SyntheticKind shape : {SyntheticKind::wall, SyntheticKind::ridge, SyntheticKind::cone}) {
    WorldSpec spec = test::synthetic_spec(shape, 6500, 25);
    spec.terrain.shape.height_m = 150;
    spec.terrain.shape.distance_m = 3000;
    spec.terrain.shape.width_m = 300;
    const auto scene = test::make_scene(load_world(spec));
    for (const FrustumKind kind : kKinds) {
      int lit[2] = {0, 0};
      int dark = 0;
      for (const PlateKind plates : {PlateKind::spread, PlateKind::nearest}) {
        const auto plan = plan_of(scene, settings_of(kind, plates, 256, 192));
        WedgeVisibility profile(plan->looks_at(), {0, 64});
        const Frame frame =
            render(scene, test::snapshot(plan->settings()), plan->pose(), {0, 64}, RenderOptions{});
        dark = 0;
        for (int a = 0; a < 64; ++a) {
          for (std::size_t r = 0; r < 128; ++r) {
            if (profile.whole_marks(a).visible[r]) continue;
            ++dark;
            lit[static_cast<int>(plates)] += frame.bins.power_w[static_cast<std::size_t>(a) * 128 + r] > 0;
          }
        }
      }
      std::printf("    shape %d, %s: %d hidden bins, %d lit with spread plates, %d with nearest\n",
                  static_cast<int>(shape), kNames[static_cast<int>(kind)], dark, lit[0], lit[1]);
      EXPECT_GT(dark, 20);
      EXPECT_LE(lit[0], lit[1] + dark / 200) << "half a percent";
    }
  }
}

TEST(Plates, AreCloserToTheTruthThanTheNearestBin) {
  // Hills and prisms, 1024 bins of them against the reference. As many pixels a bin as the paper's 2048 x
  // 2048 have over 1024 x 1024 bins.
  const auto scene = hills_with_prisms();
  BinErrors errors[2];
  for (const PlateKind plates : {PlateKind::nearest, PlateKind::spread}) {
    const auto plan = plan_of(scene, settings_of(FrustumKind::oblique, plates, 128, 256));
    ReferenceView view;
    view.antenna_m = plan->sector().antenna_m;
    view.bearing_rad = plan->sector().bearing_rad;
    view.sector_rad = plan->sector().width_rad;
    view.azimuth_bins = 64;
    view.r_min_m = plan->bins().r_min_m;
    view.r_max_m = plan->bins().r_max_m;
    view.range_bins = 128;
    view.wavelength_m = plan->looks_at().wavelength_m();
    ReferenceSampling sampling;
    sampling.planes_per_bin = 16;
    const ReferenceBins truth =
        integrate_reference(scene->world(), scene->materials(), view, sampling, 16, 8);
    std::vector<double> truth_w;
    for (std::size_t k = 0; k < truth.ground_w.size(); ++k)
      truth_w.push_back(truth.ground_w[k] + truth.building_w[k]);
    const Frame frame = render(scene, test::snapshot(plan->settings()), plan->pose(), {16, 8});
    BinErrors& e = errors[static_cast<int>(plates)];
    e = bin_errors(frame.bins.power_w, truth_w,
                   {view.r_min_m, plan->bins().range_spacing_m, view.range_bins, false});
    std::printf("    %s: E %.3f, gaps %.2f %%, false light %.2f %%, energy %+.4f\n",
                plates_name(plates).c_str(), e.power_error, 100 * e.gap_fraction(),
                100 * e.false_light_fraction(), e.energy_error());
  }
  const BinErrors& spread = errors[static_cast<int>(PlateKind::spread)];
  const BinErrors& nearest = errors[static_cast<int>(PlateKind::nearest)];
  EXPECT_LT(spread.power_error, nearest.power_error);
  EXPECT_LT(spread.gap_fraction(), 0.8 * nearest.gap_fraction());
}

}  // namespace
}  // namespace obliq::plates_test
