// How fast the reference renderer converges, over hills with buildings: in step_m and in planes_per_bin.
#include <gtest/gtest.h>

#include <cstdio>

#include "server/accuracy/bin_errors.h"
#include "tests/accuracy/reference_support.h"
#include "tests/support/figures.h"
#include "tests/support/fitted_order.h"

namespace obliq::reference_order_test {
namespace {

using test::ErrorAtSize;
using test::fitted_order;
using test::made_world;

/// On 200 m cells, 1.2 to 6 km from the antenna.
World hills(bool built) {
  World world = made_world(7000, 200, test::hills_m);
  if (built) test::add_houses(world, 40, 1500, 100, 0.3);
  return world;
}

std::vector<double> truth_w(const World& world, const ReferenceView& view,
                            const ReferenceSampling& sampling) {
  std::vector<Material> materials{{"terrain"}, {"building"}};
  materials[1].model = ScatteringModel::geometric_optics;
  materials[1].rms_slope = 0.3;
  materials[1].gamma = 0.1;
  const ReferenceBins bins = test::integrate_all(world, materials, view, sampling);
  std::vector<double> sum(bins.ground_w);
  for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += bins.building_w[k];
  return sum;
}

double error(const std::vector<double>& power_w, const std::vector<double>& truth_w,
             const ReferenceView& view) {
  return bin_errors(power_w, truth_w,
                    {view.r_min_m, (view.r_max_m - view.r_min_m) / view.range_bins, view.range_bins, false})
      .power_error;
}

/// Errors of one scene at falling sizes, printed as a table.
struct Table {
  std::vector<ErrorAtSize> points;

  void add(const char* what, double size, double number, double error) {
    points.push_back({size, error});
    const std::size_t n = points.size();
    std::printf("    %s %7.4g: E = %.2e", what, number, error);
    if (n > 1) std::printf(", %.2f times less", points[n - 2].error / error);
    std::printf("\n");
  }
};

const ReferenceView kView = test::view_from({0, 500, 0}, 0, 18, 8, 1300, 5500, 40);

// Midpoint rule between exact cuts: the error of a stretch of length L in n = ceil(L / step) steps is
// proportional to (L / n)^2. Stretches are cut by cells, diagonals and range bins to about 70 m; at 8 m and
// below ceil() changes n by a ninth at most and n^2 by a fifth, so three halvings give an order of 2 +-
// log2(1.25) / 3 = 0.11. A version that bins whole steps without cutting them at the bins' edges, or the
// visible part by whole steps, has order 1.
TEST(ReferenceOrder, IsTwoInTheStep) {
  for (const bool built : {false, true}) {
    const World world = hills(built);
    const auto best = truth_w(world, kView, {4, 0.0625, 0});
    std::printf("  %s\n", built ? "hills with buildings" : "hills");
    Table table;
    for (const double step_m : {8.0, 4.0, 2.0, 1.0})
      table.add("step", step_m, step_m, error(truth_w(world, kView, {4, step_m, 0}), best, kView));
    const double order = fitted_order(table.points);
    std::printf("    order %.2f\n", order);
    test::record_figure(built ? "order_step_built" : "order_step", order);
    EXPECT_NEAR(order, 2, 0.15);
    // The default step of 2 m.
    EXPECT_LT(table.points[2].error, 1e-5);
  }
}

// Over bare ground a bin's power is a continuous function of azimuth with kinks (the surface is continuous,
// so the edges of shadows and bins move continuously): order 2; each kink's error has its own sign and size,
// which leaves the fit over five doublings some 0.2 of play. Between corners of buildings it is continuous as
// well, but a wall that is nearly in line with the sight passes from one range bin to the next within a
// fraction of the planes' spacing, in effect a jump, and jumps give order 1. A version whose planes straddle
// the corners has order 1 there too, and ten times the error.
TEST(ReferenceOrder, IsTwoInThePlanesOverGroundAndBetweenOneAndTwoWithBuildings) {
  for (const bool built : {false, true}) {
    const World world = hills(built);
    const auto best = truth_w(world, kView, {2048, 4, 0});
    std::printf("  %s\n", built ? "hills with buildings" : "hills");
    Table table;
    for (const int planes : {8, 16, 32, 64, 128, 256})
      table.add("planes", 1.0 / planes, planes, error(truth_w(world, kView, {planes, 4, 0}), best, kView));
    const double order = fitted_order(table.points);
    std::printf("    order %.2f\n", order);
    test::record_figure(built ? "order_planes_built" : "order_planes", order);
    EXPECT_GT(order, built ? 1.0 : 1.8);
    EXPECT_LT(order, 2.2);
    // The default of 32 planes.
    EXPECT_LT(table.points[2].error, 1e-3);
  }
}

}  // namespace
}  // namespace obliq::reference_order_test
