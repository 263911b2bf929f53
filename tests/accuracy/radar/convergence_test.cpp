// Every source of samples converges to the reference renderer as its sampling grows: for terrain alone,
// buildings alone, and both.
//
// The order. A pixel whose plate is not spread lies in one bin whole, so a bin's power is a count of lattice
// points in a region of the sphere, weighted smoothly. Across boundaries at any angle to the lattice the
// count of N^2 points is off by O(N^1/2) (Kendall, "On the number of lattice points inside a random oval", Q.
// J. Math. 1948): a relative error of O(N^-3/2). Boundaries along the lattice (walls' edges
// and shadows) take or leave whole rows or columns: O(N^-1). Spread
// plates leave the second kind at the sides of buildings, and nothing but the midpoint rule's O(N^-2) where
// ground alone is in sight. The sweep is exact along range and a midpoint rule across azimuth: O(N^-2) over
// ground, O(N^-1) and more where walls meet range-bin edges. So E falls at least like 1 / N: by 2^3 over
// three doublings, less a quarter for how the edges of the few bins that weigh most happen to fall on the
// lattices at both ends. Anything that the source and the truth do not agree on leaves an E that does not
// fall: a building's wall without its own normal, cells split along the other diagonal (the cells are coarse
// for that), shadows by a horizon that starts at r_min, a solid angle off by a percent.
// What holds for the reference renderer on any scene: voids, antennas outside the grid and below peaks, 360
// degree sectors, nested and tiny buildings.
#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "server/accuracy/bin_errors.h"
#include "tests/accuracy/reference_support.h"
#include "tests/support/figures.h"
#include "tests/support/fitted_order.h"
#include "tests/support/random_scenes.h"
#include "tests/support/samplings.h"
#include "tests/support/scenes.h"

namespace obliq::convergence_test {
namespace {

using test::ErrorAtSize;

constexpr int kSizes[] = {128, 256, 512, 1024};
// 1 to 8 planes an azimuth bin; more would meet the truth's own error.
constexpr int kSweepSizes[] = {64, 128, 256, 512};
constexpr double kLeastFall = 6;

RadarSettings small_sector() {
  return test::radar_settings(FrustumKind::oblique, {2000, 6000, 20}, {64, 64});
}

std::vector<Material> materials() {
  std::vector<Material> list = test::two_materials();
  list[1].rms_slope = 0.3;  // a lobe wide enough that many walls return
  return list;
}

/// The truth of the surfaces that a frame bins.
std::vector<double> truth_w(const World& world, const ReferenceView& view, const ReferenceSampling& sampling,
                            Surfaces surfaces) {
  const ReferenceBins bins = test::integrate_all(world, materials(), view, sampling);
  std::vector<double> sum(bins.ground_w.size());
  for (std::size_t k = 0; k < sum.size(); ++k) {
    if (surfaces != Surfaces::buildings) sum[k] += bins.ground_w[k];
    if (surfaces != Surfaces::ground) sum[k] += bins.building_w[k];
  }
  return sum;
}

/// A sampling, its plates, and how it is printed.
struct Source {
  test::Sampling sampling;
  PlateKind plates;
  std::string name;
};

std::vector<Source> every_source() {
  std::vector<Source> sources;
  for (const test::Sampling& sampling : test::kSamplings) {
    sources.push_back({sampling, PlateKind::spread, sampling.name});
    if (sampling.rays())
      sources.push_back({sampling, PlateKind::nearest, std::string(sampling.name) + ", nearest"});
  }
  return sources;
}

void expect_every_source_converges(World world, Surfaces surfaces) {
  const RadarSettings settings = small_sector();
  const glm::dvec3 antenna_m(0, 900, 0);
  ReferenceView view = test::view_from(antenna_m, 0, settings.sector_deg, settings.azimuth_bins,
                                       settings.r_min_m, settings.r_max_m, settings.range_bins);
  view.wavelength_m = 299792458.0 / (settings.frequency_ghz * 1e9);
  const RangeBins ranges{settings.r_min_m, (settings.r_max_m - settings.r_min_m) / settings.range_bins,
                         settings.range_bins, false};
  const std::vector<double> truth = truth_w(world, view, {256, 0.5, 0}, surfaces);
  const BinErrors own = bin_errors(truth_w(world, view, {128, 1, 0}, surfaces), truth, ranges);
  std::printf("    truth's own E with half the planes and twice the step: %.1e; %d bins lit, %d dark\n",
              own.power_error, static_cast<int>(own.lit), static_cast<int>(own.dark));

  const auto scene = test::make_scene(std::move(world), materials());
  const Pose pose = test::pose_at(scene->world(), antenna_m, 0);
  RenderOptions options;
  options.states = false;
  options.surfaces = surfaces;
  std::vector<double> ray_orders, sweep_orders;
  for (const Source& source : every_source()) {
    std::vector<ErrorAtSize> errors;
    std::printf("    %-18s N: E (gaps, false light)", source.name.c_str());
    for (const int n : source.sampling.frustum == FrustumKind::sweep ? kSweepSizes : kSizes) {
      RadarSettings s = test::sampled(settings, source.sampling);
      s.plates = source.plates;
      s.pixel_columns = s.pixel_rows = n;
      s.sub_columns = 0;  // with more planes only exact ones converge
      const Frame frame = render(scene, test::snapshot(s), pose, {0, s.azimuth_bins}, options);
      const BinErrors e = bin_errors(frame.bins.power_w, truth, ranges);
      errors.push_back({1.0 / n, e.power_error});
      std::printf("  %d: %.2e (%.1f %%, %.1f %%)", n, e.power_error, 100 * e.gap_fraction(),
                  100 * e.false_light_fraction());
      EXPECT_LE(own.power_error, e.power_error / 10) << source.name << ", N = " << n;
      if (source.plates == PlateKind::nearest) {  // what a ray meets is lit
        EXPECT_EQ(e.false_light, 0u) << source.name << ", N = " << n;
      }
    }
    const double order = test::fitted_order(errors);
    std::printf("  order %.2f\n", order);
    const bool swept = source.sampling.frustum == FrustumKind::sweep;
    (swept ? sweep_orders : ray_orders).push_back(order);
    EXPECT_GT(errors.front().error / errors.back().error, kLeastFall) << source.name;
  }
  for (const auto& [what, orders] : {std::pair{"rays", &ray_orders}, std::pair{"sweep", &sweep_orders}}) {
    const auto [least, most] = std::ranges::minmax(*orders);
    test::record_figure(std::string("converge_") + what + "_least", least);
    test::record_figure(std::string("converge_") + what + "_most", most);
  }
}

TEST(Convergence, OfTerrainAlone) {
  expect_every_source_converges(test::made_world(7000, 350, test::hills_m), Surfaces::ground);
}

TEST(Convergence, OfBuildingsAlone) {
  World world = test::made_world(7000, 100, [](double, double) { return 0; });
  test::add_houses(world, 60, 2100, 62, 0.33);
  expect_every_source_converges(std::move(world), Surfaces::buildings);
}

TEST(Convergence, OfTerrainWithBuildings) {
  World world = test::made_world(7000, 350, test::hills_m);
  test::add_houses(world, 60, 2100, 62, 0.33);
  expect_every_source_converges(std::move(world), Surfaces::all);
}

/// Constant gamma of 1 everywhere, so that a bin's power is K times the integral of its solid angle over r^2.
const std::vector<Material> kDiffuse(256, Material{});

ReferenceView view_of(const test::RandomScene& scene) {
  const RadarSettings& s = scene.settings;
  return test::view_from(scene.pose.antenna.m, scene.pose.bearing_world_rad / kDegree_rad, s.sector_deg,
                         s.azimuth_bins, s.r_min_m, s.r_max_m, s.range_bins);
}

TEST(ReferenceScenes, PowersAreFiniteAndNoMoreThanTheWholeSphereReturns) {
  // All directions of a sector are 2 S steradians; power times r^2, r at least the bin's near edge, is K
  // gamma times the solid angle. A version that integrates what is hidden as well, or a wall edge-on by its
  // own area, goes beyond.
  int lit = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    const test::RandomScene scene = test::random_scene(seed);
    const ReferenceView view = view_of(scene);
    const ReferenceBins bins = test::integrate_all(scene.world, kDiffuse, view, {4, 2, 0});
    double weighted = 0;
    for (int a = 0; a < bins.n_azimuth; ++a) {
      for (int r = 0; r < bins.n_range; ++r) {
        const std::size_t k = test::bin_index(bins, a, r);
        ASSERT_TRUE(bins.ground_w[k] >= 0 && std::isfinite(bins.ground_w[k])) << scene.text;
        ASSERT_TRUE(bins.building_w[k] >= 0 && std::isfinite(bins.building_w[k])) << scene.text;
        weighted += (bins.ground_w[k] + bins.building_w[k]) * std::pow(test::range_edge_m(view, r), 2);
      }
    }
    EXPECT_LE(weighted, test::range_constant(view) * 2 * view.sector_rad * 1.001) << scene.text;
    if (weighted > 0) ++lit;
  }
  std::printf("    %d of 400 scenes with light\n", lit);
  EXPECT_GT(lit, 200);
}

TEST(ReferenceScenes, ABuildingIsNeverSeenBetterThanAlone) {
  // What is lit among others is a part of what is lit alone, cut at other places: the quadratures differ by
  // their error, a thousandth at 2 m (step_m r / 200 m is a hundredth of the range).
  int partly = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    const test::RandomScene scene = test::random_scene(seed);
    const ReferenceBins bins = test::integrate_all(scene.world, kDiffuse, view_of(scene), {4, 2, 0});
    ASSERT_EQ(bins.buildings.size(), scene.world.buildings.list.size());
    for (const BuildingTruth& building : bins.buildings) {
      EXPECT_LE(building.visible_sr, building.unoccluded_sr * 1.001) << scene.text;
      EXPECT_GE(building.visible_sr, 0) << scene.text;
      EXPECT_EQ(building.largest_share > 0, building.visible_sr > 0) << scene.text;
      EXPECT_LE(building.largest_share, 1 + 1e-12) << scene.text;
      if (building.visible_sr > 0 && building.visible_sr < 0.9 * building.unoccluded_sr) ++partly;
    }
  }
  std::printf("    %d buildings partly hidden by others or by ground\n", partly);
  EXPECT_GT(partly, 20);
}

TEST(ReferenceScenes, BitsDoNotDependOnThreadsOrOnWhichAzimuthsAreAskedFor) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const test::RandomScene scene = test::random_scene(seed);
    const ReferenceView view = view_of(scene);
    const ReferenceBins one = test::integrate_all(scene.world, kDiffuse, view, {4, 2, 1});
    const ReferenceBins three = test::integrate_all(scene.world, kDiffuse, view, {4, 2, 3});
    EXPECT_EQ(one.ground_w, three.ground_w) << scene.text;
    EXPECT_EQ(one.building_w, three.building_w) << scene.text;
    for (std::size_t b = 0; b < one.buildings.size(); ++b) {
      EXPECT_EQ(one.buildings[b].visible_sr, three.buildings[b].visible_sr) << scene.text;
      EXPECT_EQ(one.buildings[b].unoccluded_sr, three.buildings[b].unoccluded_sr) << scene.text;
    }
    const int last = view.azimuth_bins - 1;
    const ReferenceBins part = integrate_reference(scene.world, kDiffuse, view, {4, 2, 1}, last, 1);
    for (int r = 0; r < view.range_bins; ++r)
      EXPECT_EQ(part.ground_w[static_cast<std::size_t>(r)], one.ground_w[test::bin_index(one, last, r)])
          << scene.text;
  }
}

}  // namespace
}  // namespace obliq::convergence_test
