// Two programs for the same planes: the sweep and the reference renderer, which share no code, agree on any
// scene: voids, antennas outside the grid and below peaks, 360 degree sectors, nested and tiny buildings,
// courtyards.
#include <gtest/gtest.h>

#include <cstdio>

#include "server/accuracy/bin_errors.h"
#include "tests/accuracy/reference_support.h"
#include "tests/support/random_scenes.h"
#include "tests/support/scenes.h"

namespace obliq {
namespace {

constexpr int kPlanesPerBin = 64;

std::vector<Material> materials(const World& world) {
  std::vector<Material> list = test::two_materials();
  list[1].rms_slope = 0.4;
  std::size_t most = 1;
  for (const std::uint8_t id : world.surface_material) most = std::max<std::size_t>(most, id);
  for (const Building& building : world.buildings.list) most = std::max<std::size_t>(most, building.material);
  list.resize(most + 1);
  return list;
}

std::vector<double> power_w(const ReferenceBins& bins) {
  std::vector<double> sum(bins.ground_w);
  for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += bins.building_w[k];
  return sum;
}

// Both are midpoint rules with 64 planes a bin, which leave about what the truth changes by when its planes
// are doubled; three times that, and 1 % for bins at the corners of buildings, which the truth's planes
// respect and the sweep's need not. With a wall's wrong normal, a hole forgotten, a roof that does not shade
// or a diagonal the other way in either of them, scenes are off by tens of percent.
TEST(SweepAndTruth, AgreeOnRandomScenes) {
  double worst = 0;
  int lit = 0, within_1_percent = 0;
  for (std::uint64_t seed = 1; seed <= 150; ++seed) {
    test::RandomScene random = test::random_scene(seed);
    RadarSettings& s = random.settings;
    s.frustum = FrustumKind::sweep;
    s.pixel_columns = kPlanesPerBin * s.azimuth_bins;
    s.sub_columns = 0;  // exact planes
    ReferenceView view = test::view_from(random.pose.antenna.m, random.pose.bearing_world_rad / kDegree_rad,
                                         s.sector_deg, s.azimuth_bins, s.r_min_m, s.r_max_m, s.range_bins);
    view.wavelength_m = 299792458.0 / (s.frequency_ghz * 1e9);
    view.power_w = s.power_w;
    view.gain = std::pow(10, s.gain_db / 10);
    view.range_normalisation = s.range_normalisation;
    const std::vector<Material> list = materials(random.world);
    const RangeBins ranges{s.r_min_m, (s.r_max_m - s.r_min_m) / s.range_bins, s.range_bins,
                           s.range_normalisation};
    const auto truth = power_w(test::integrate_all(random.world, list, view, {2 * kPlanesPerBin, 1, 0}));
    const auto coarse = power_w(test::integrate_all(random.world, list, view, {kPlanesPerBin, 2, 0}));
    const double own = bin_errors(coarse, truth, ranges).power_error;
    const auto scene = test::make_scene(std::move(random.world), list);
    RenderOptions options;
    options.states = false;
    const Frame frame = render(scene, test::snapshot(s), random.pose, {0, s.azimuth_bins}, options);
    const BinErrors e = bin_errors(frame.bins.power_w, truth, ranges);
    EXPECT_LE(e.power_error, 3 * own + 0.01) << "truth's own " << own << ", " << random.text;
    worst = std::max(worst, e.power_error - 3 * own);
    if (e.lit > 0) ++lit;
    if (e.lit > 0 && e.power_error < 0.01) ++within_1_percent;
  }
  std::printf(
      "    %d scenes with light, %d of them within 1 %%; worst beyond three times the truth's own %.4f\n",
      lit, within_1_percent, worst);
  EXPECT_GT(lit, 120);
}

}  // namespace
}  // namespace obliq
