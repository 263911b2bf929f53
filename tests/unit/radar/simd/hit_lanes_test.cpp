// Rays that meet the ground eight at a time get the bits of refine_near, in every instruction set.
// Where samples fall and what they scatter, eight at a time.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <memory>
#include <numbers>
#include <vector>

#include "server/radar/echo/scattering.h"
#include "server/radar/echo/speckle.h"
#include "server/radar/frame_plan.h"
#include "server/radar/samples.h"
#include "server/radar/simd/kernels.h"
#include "server/radar/simd/lanes/exact_math.h"
#include "server/scene/exact_hit.h"
#include "terrain/base/hash.h"
#include "tests/support/scenes.h"

namespace obliq::hit_lanes_test {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Rays down to hills with a void in them, whose rough distances are wrong by up to 3 m, and some that met
/// nothing.
class HitLanes : public testing::Test {
 protected:
  static constexpr int kRays = 1003;

  HitLanes() {
    HeightGrid& grid = world_.grid;
    for (int j = 40; j < 60; ++j)
      for (int i = 30; i < 90; ++i) grid.y_m[grid.index(i, j)] = std::numeric_limits<float>::quiet_NaN();
    for (std::size_t k = 0; k < kRays; ++k) {
      const auto random = [&](std::uint64_t what) {
        return unit_from_hash(hash_cell(what, static_cast<int>(k), 0));
      };
      const glm::dvec3 to{10400 * random(1) - 5200, 300 * random(2), 10400 * random(3) - 5200};
      const glm::dvec3 direction = glm::normalize(to - antenna_m_);
      const auto met = walk_ground(world_, antenna_m_, direction, 0, 20000);
      dir_x_[k] = direction.x;
      dir_y_[k] = direction.y;
      dir_z_[k] = direction.z;
      rough_m_[k] = met && k % 50 != 0
                        ? static_cast<double>(static_cast<float>(met->slant_range_m + 6 * random(4) - 3))
                        : kNone;
    }
  }

  std::unique_ptr<GroundHits> answer(decltype(Kernels::refine_ground_hits) kernel) const {
    auto hits = std::make_unique<GroundHits>();
    kernel({ground_view(world_.grid, antenna_m_), kRays, dir_x_.data(), dir_y_.data(), dir_z_.data(),
            rough_m_.data()},
           *hits);
    return hits;
  }

  World world_ = load_world(test::synthetic_spec(SyntheticKind::hills, 5000, 50));
  glm::dvec3 antenna_m_{10, 1500, -20};
  std::vector<double> dir_x_ = std::vector<double>(kRays + 8, 0.0);
  std::vector<double> dir_y_ = dir_x_;
  std::vector<double> dir_z_ = dir_x_;
  std::vector<double> rough_m_ = std::vector<double>(kRays + 8, kNone);
};

TEST_F(HitLanes, GiveTheBitsOfOneRayAtATimeOrNoAnswer) {
  for (const Kernels& kernels : all_kernels()) {
    SCOPED_TRACE(kernels.name);
    const auto hits = answer(kernels.refine_ground_hits);
    int answered = 0;
    for (std::size_t k = 0; k < kRays; ++k) {
      if (std::isnan(hits->slant_range_m[k])) continue;
      ++answered;
      EXPECT_FALSE(std::isnan(rough_m_[k])) << k << ", a ray that has met nothing";
      const auto plain = refine_near(world_, antenna_m_, {dir_x_[k], dir_y_[k], dir_z_[k]},
                                     {static_cast<float>(rough_m_[k]), kNoFace, 0, RoughHit::Kind::ground});
      ASSERT_TRUE(plain) << k;
      EXPECT_EQ(hits->slant_range_m[k], plain->slant_range_m) << k;
      EXPECT_EQ(hits->cos_incidence[k], plain->cos_incidence) << k;
      EXPECT_EQ(hits->x_m[k], plain->position_m.x) << k;
      EXPECT_EQ(hits->z_m[k], plain->position_m.z) << k;
      const HeightGrid& grid = world_.grid;
      EXPECT_NEAR(plain->position_m.x, grid.node_x_m(hits->cell_x[k]) + grid.cell_m / 2,
                  grid.cell_m / 2 + 1e-6);
      EXPECT_NEAR(plain->position_m.z, grid.node_z_m(hits->cell_z[k]) + grid.cell_m / 2,
                  grid.cell_m / 2 + 1e-6);
    }
    // Those beside the grid and the void meet nothing; next to a silhouette the steps wander.
    EXPECT_GT(answered, kRays * 3 / 4);
  }
}

TEST(PlaceLanes, AreTheBitsOfOneSampleAtATimeInEveryInstructionSet) {
  const World world = load_world(test::synthetic_spec(SyntheticKind::hills, 5000, 50));
  const SpeckleField field(world, {10, 1500, -20}, 0.03, 32, 2e-3, 1);
  std::vector<Material> materials(3);
  materials[0].gamma = 0.03;
  materials[1].model = ScatteringModel::geometric_optics;
  materials[2].gamma = 7.5;
  const ScatteringTable scattering(materials, 0.03);
  BinGrid bins;
  bins.n_range = 100;
  bins.r_min_m = 1200;
  bins.r_max_m = 5200;
  bins.range_spacing_m = 40;
  SwathCells cells{};
  cells.axis = bins;
  field.describe_cells(cells);
  constexpr int kSamples = 1021;
  auto samples = std::make_unique<SampleBatch>();
  samples->n = kSamples;
  for (int s = 0; s < kSamples; ++s) {
    const auto k = static_cast<std::size_t>(s);
    const auto random = [&](std::uint64_t salt) { return unit_from_hash(hash_cell(salt, s, 0)); };
    samples->slant_range_m[k] = s == 0 ? bins.r_min_m : s == 1 ? bins.r_max_m : 1000 + 4500 * random(1);
    samples->x_m[k] = 9000 * random(2) - 4500;
    samples->z_m[k] = 9000 * random(3) - 4500;
    samples->solid_angle_sr[k] = 1e-6 * random(4);
    samples->material[k] = static_cast<std::uint8_t>(s % 3);
  }
  for (const bool normalised : {false, true}) {
    EchoFactors factors{};
    factors.range_normalisation = normalised;
    for (std::size_t m = 0; m < materials.size(); ++m) factors.gamma[m] = scattering.constant_gamma(m);
    for (const Kernels& kernels : all_kernels()) {
      auto placed = std::make_unique<BinnedSamples>();
      kernels.bin_samples(cells, factors, *samples, *placed);
      for (std::size_t k = 0; k < kSamples; ++k) {
        const double r = samples->slant_range_m[k];
        ASSERT_EQ(placed->range_bin[k], bins.range_bin(r)) << kernels.name << ' ' << k;
        ASSERT_EQ(placed->spreading[k], normalised ? 1.0 : (r * r) * (r * r)) << kernels.name << ' ' << k;
        const ScattererKey key(
            field.scatterer(r, {samples->x_m[k], 0, samples->z_m[k]}, kNoFace, samples->material[k]));
        ASSERT_EQ(placed->cell[k], key.place) << kernels.name << ' ' << k;
        if (samples->material[k] == 1) {
          ASSERT_TRUE(std::isnan(placed->sigma_m2[k])) << kernels.name << ' ' << k;
        } else {
          ASSERT_EQ(placed->sigma_m2[k], scattering.cross_section_m2(
                                             samples->material[k], samples->solid_angle_sr[k] * (r * r), 0.5))
              << kernels.name << ' ' << k;
        }
      }
    }
  }
}

constexpr long double kTwoPi = 2 * std::numbers::pi_v<long double>;

TEST(ExactMath, SineAndCosineOfTurnsAreWithin3e16) {
  for (int k = -200000; k <= 200000; ++k) {
    const double turns = k * 7.3e-6 + 1e-9;
    const SinCos got = sincos_turns(turns);
    EXPECT_NEAR(got.sin, static_cast<double>(std::sin(kTwoPi * static_cast<long double>(turns))), 3e-16)
        << turns;
    EXPECT_NEAR(got.cos, static_cast<double>(std::cos(kTwoPi * static_cast<long double>(turns))), 3e-16)
        << turns;
  }
}

TEST(ExactMath, QuarterTurnsAreExact) {
  EXPECT_EQ(sincos_turns(0.25).sin, 1.0);
  EXPECT_EQ(sincos_turns(0.25).cos, -0.0);
  EXPECT_EQ(sincos_turns(-0.5).cos, -1.0);
  EXPECT_EQ(sincos_turns(1e15).cos, 1.0);
}

TEST(ExactMath, ExponentialOfNegativesIsWithin4e16Relative) {
  for (double x = 0; x > -699; x -= 0.00371) {
    const auto expected = static_cast<double>(std::exp(static_cast<long double>(x)));
    EXPECT_NEAR(exp_of_negative(x) / expected, 1, 4.5e-16) << x;
  }
  EXPECT_EQ(exp_of_negative(-701.0), 0);
  EXPECT_EQ(exp_of_negative(-HUGE_VAL), 0);
  EXPECT_EQ(exp_of_negative(std::nan("")), 0);
}

TEST(ExactMath, LogarithmIsWithin1e15OfTheLongDoubleOne) {
  for (double x = 1e-9; x <= 1; x *= 1.00037) {
    const auto expected = static_cast<double>(std::log(static_cast<long double>(x)));
    EXPECT_NEAR(log_of_positive(x), expected, 1e-15 + 4e-16 * std::abs(expected)) << x;
  }
  EXPECT_EQ(log_of_positive(1.0), 0);
}

}  // namespace
}  // namespace obliq::hit_lanes_test
