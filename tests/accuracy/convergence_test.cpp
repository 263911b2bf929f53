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
#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "server/accuracy/bin_errors.h"
#include "tests/accuracy/reference_support.h"
#include "tests/support/figures.h"
#include "tests/support/fitted_order.h"
#include "tests/support/samplings.h"
#include "tests/support/scenes.h"

namespace obliq {
namespace {

using test::ErrorAtSize;

constexpr int kSizes[] = {128, 256, 512, 1024};
// 1 to 8 planes an azimuth bin; more would meet the truth's own error.
constexpr int kSweepSizes[] = {64, 128, 256, 512};
constexpr double kLeastFall = 6;

RadarSettings small_sector() {
  RadarSettings s;
  s.sector_deg = 20;
  s.r_min_m = 2000;
  s.r_max_m = 6000;
  s.azimuth_bins = 64;
  s.range_bins = 64;
  return s;
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

}  // namespace
}  // namespace obliq
