// The sea's texture by itself: its distribution, its law by a piece's size, its correlation.
#include "server/radar/echo/sea_texture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "server/radar/simd/kernels.h"
#include "tests/support/same_bits.h"

namespace obliq::sea_texture_test {
namespace {

SeaTexture texture_of(double shape, std::uint32_t seed = 1) {
  SeaTexture texture{};
  fill_texture(shape, texture.tau);
  texture.nodes_per_m = static_cast<float>(1 / kTextureSide_m);
  texture.seed = seed;
  return texture;
}

void put(SeaPieces& pieces, std::size_t k, double x_m, double z_m) {
  const double distance_m = std::hypot(x_m, z_m);
  pieces.distance_m[k] = static_cast<float>(distance_m);
  pieces.sine[k] = static_cast<float>(distance_m > 0 ? x_m / distance_m : 0);
  pieces.cosine[k] = static_cast<float>(distance_m > 0 ? z_m / distance_m : 1);
}

/// tau of points: of pieces without size, a golden ratio of a lattice's side and more apart.
std::vector<double> points_of(const SeaTexture& texture, int rows, double shift_m = 0, double piece_m = 0) {
  std::vector<double> tau;
  const auto pieces = std::make_unique<SeaPieces>();
  pieces->n = SeaPieces::kMost;
  const double apart_m = 618.03 + 2 * piece_m;
  for (int row = 0; row < rows; ++row) {
    for (int k = 0; k < SeaPieces::kMost; ++k) {
      const auto at = static_cast<std::size_t>(k);
      put(*pieces, at, (k - 512) * apart_m / 10 + shift_m, (row + 1) * apart_m / 7);
      pieces->along_m[at] = pieces->across_m[at] = static_cast<float>(piece_m);
    }
    active_kernels().sea_texture(texture, *pieces);
    tau.insert(tau.end(), pieces->tau, pieces->tau + pieces->n);
  }
  return tau;
}

double mean_of(const std::vector<double>& values, double power = 1) {
  double sum = 0;
  for (const double v : values) sum += std::pow(v, power);
  return sum / static_cast<double>(values.size());
}

TEST(SeaTexture, IsGammaDistributed) {
  // Quantiles of Gamma(nu) / nu by scipy.stats.gamma.ppf at 0.1, 0.5, 0.9, 0.99; moments in closed form:
  // <tau^2> = 1 + 1/nu, <tau^3> = (1 + 1/nu)(1 + 2/nu). A field that is
  // not divided by its deviation between nodes has too little of both.
  struct Case {
    double shape, quantiles[4];
  };
  for (const Case& c : {Case{0.5, {0.015791, 0.454936, 2.705543, 6.634897}},
                        Case{1, {0.105361, 0.693147, 2.302585, 4.605170}},
                        Case{5, {0.486518, 0.934182, 1.598718, 2.320925}}}) {
    std::vector<double> tau = points_of(texture_of(c.shape), 1000);
    EXPECT_NEAR(mean_of(tau), 1, 0.01);
    EXPECT_NEAR(mean_of(tau, 2) / (1 + 1 / c.shape), 1, 0.02) << c.shape;
    EXPECT_NEAR(mean_of(tau, 3) / ((1 + 1 / c.shape) * (1 + 2 / c.shape)), 1, 0.06) << c.shape;
    std::ranges::sort(tau);
    const double shares[] = {0.1, 0.5, 0.9, 0.99};
    for (std::size_t q = 0; q < 4; ++q) {
      const double found = tau[static_cast<std::size_t>(shares[q] * static_cast<double>(tau.size()))];
      EXPECT_NEAR(found / c.quantiles[q], 1, 0.03) << c.shape << " at " << shares[q];
    }
    std::printf("    shape %g: <tau^2> %.4f, <tau^3> %.3f\n", c.shape, mean_of(tau, 2), mean_of(tau, 3));
  }
}

TEST(SeaTexture, TablesOfAllShapesAreFiniteAndRise) {
  std::vector<float> tau(SeaTexture::kSteps + 1);
  for (const double shape : {0.001, 0.1, 0.3, 1.0, 3.0, 20.0}) {
    fill_texture(shape, tau.data());
    EXPECT_TRUE(std::ranges::is_sorted(tau)) << shape;
    EXPECT_GE(tau.front(), 0);
    EXPECT_TRUE(std::isfinite(tau.back())) << shape;
    EXPECT_GT(tau.back(), 1) << shape;
  }
}

TEST(SeaTexture, OfACellHasTheShapeThatItsSizeMakes) {
  // The mean over squares anywhere in the lattice, 80,000 of each (20,000 of 90 m), integrated at 8 points a
  // lattice side with numpy (normal numbers by its own generator, scipy's Gamma quantiles). What points half
  // a side apart leave is below a tenth.
  struct Case {
    double shape, of_10_m, of_30_m, of_90_m;
  };
  for (const Case& c : {Case{0.2, 0.218, 0.313, 1.234}, Case{0.5, 0.525, 0.738, 2.717},
                        Case{1, 1.051, 1.406, 5.163}, Case{5, 5.257, 6.987, 23.871}}) {
    std::printf("    shape %g: %.3f, %.3f, %.3f\n", c.shape, shape_of_cell(c.shape, 10, 10),
                shape_of_cell(c.shape, 30, 30), shape_of_cell(c.shape, 90, 90));
    EXPECT_NEAR(shape_of_cell(c.shape, 10, 10) / c.of_10_m, 1, 0.15) << c.shape;
    EXPECT_NEAR(shape_of_cell(c.shape, 30, 30) / c.of_30_m, 1, 0.15) << c.shape;
    EXPECT_NEAR(shape_of_cell(c.shape, 90, 90) / c.of_90_m, 1, 0.15) << c.shape;
  }
}

TEST(SeaTexture, IsCorrelatedOverItsLattice) {
  // Two points apart along an axis, anywhere in the lattice: two million pairs with numpy, of shape 1.
  const SeaTexture texture = texture_of(1);
  const std::vector<double> here = points_of(texture, 400);
  const auto correlation = [&](double apart_m) {
    const std::vector<double> there = points_of(texture, 400, apart_m);
    double sum = 0;
    for (std::size_t k = 0; k < here.size(); ++k) sum += here[k] * there[k];
    const double mean = mean_of(here);
    return (sum / static_cast<double>(here.size()) - mean * mean) / (mean_of(here, 2) - mean * mean);
  };
  const double expected[][2] = {{3, 0.986},    {7.5, 0.920}, {15, 0.728},
                                {22.5, 0.501}, {30, 0.295},  {45, 0.048}};
  for (const auto& [apart_m, of_numpy] : expected)
    EXPECT_NEAR(correlation(apart_m), of_numpy, 0.02) << apart_m;
  EXPECT_NEAR(correlation(60), 0, 0.01);
  EXPECT_NEAR(correlation(300), 0, 0.01);
}

TEST(SeaTexture, HasTheSameBitsInAllInstructionSetsAndInAnyList) {
  const SeaTexture texture = texture_of(0.3);
  std::vector<std::vector<float>> all;
  for (const Kernels& kernels : all_kernels()) {
    const auto pieces = std::make_unique<SeaPieces>();
    pieces->n = 1000;
    for (int k = 0; k < pieces->n; ++k) {
      const auto at = static_cast<std::size_t>(k);
      put(*pieces, at, k * 37.1 - 15000, k * k % 1009 * 11.3 - 4000);
      pieces->along_m[at] = static_cast<float>(k % 23) * 13;
      pieces->across_m[at] = static_cast<float>(k % 7) * 40;
    }
    put(*pieces, 5, 0, 0);
    kernels.sea_texture(texture, *pieces);
    all.emplace_back(pieces->tau, pieces->tau + pieces->n);
    // Alone.
    for (const std::size_t k : {std::size_t{5}, std::size_t{77}, std::size_t{999}}) {
      SeaPieces& one = *pieces;
      const float before = one.tau[k];
      one.distance_m[0] = one.distance_m[k], one.sine[0] = one.sine[k], one.cosine[0] = one.cosine[k];
      one.along_m[0] = one.along_m[k], one.across_m[0] = one.across_m[k];
      one.n = 1;
      kernels.sea_texture(texture, one);
      EXPECT_EQ(one.tau[0], before) << kernels.name;
    }
    for (const float tau : all.back()) EXPECT_TRUE(std::isfinite(tau) && tau >= 0);
    EXPECT_TRUE(test::same_bits(all.front(), all.back())) << kernels.name;
  }
}

}  // namespace
}  // namespace obliq::sea_texture_test
