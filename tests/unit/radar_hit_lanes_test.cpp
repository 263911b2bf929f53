// Rays that meet the ground eight at a time get the bits of refine_near, in every instruction set.
#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <limits>
#include <memory>
#include <vector>

#include "server/radar/simd/kernels.h"
#include "server/scene/exact_hit.h"
#include "terrain/base/hash.h"
#include "tests/support/scenes.h"

namespace obliq {
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

TEST_F(HitLanes, LeaveWhatMetNoGround) {
  for (const Kernels& kernels : all_kernels()) {
    SCOPED_TRACE(kernels.name);
    const auto hits = answer(kernels.refine_ground_hits);
    for (std::size_t k = 0; k < kRays; ++k) {
      if (std::isnan(rough_m_[k])) {
        EXPECT_TRUE(std::isnan(hits->slant_range_m[k])) << k;
      }
    }
  }
}

}  // namespace
}  // namespace obliq
