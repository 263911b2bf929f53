// How far rays go before they can meet ground or a roof, and the walk of eight rays from there on.
#include "server/radar/rays/clearance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <glm/geometric.hpp>
#include <numbers>
#include <vector>

#include "server/radar/simd/kernels.h"
#include "server/scene/ray_answer.h"
#include "tests/support/random_scenes.h"
#include "tests/support/scenes.h"

namespace obliq::clearance_test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

SinCos bearing_at(double bearing_rad) { return sincos_turns(bearing_rad / (2 * std::numbers::pi)); }

/// A direction within a beam.
glm::dvec3 ray_of(test::Dice& dice, double from_rad, double width_rad, double lowest_rad,
                  double highest_rad) {
  const SinCos bearing = bearing_at(from_rad + dice.unit() * width_rad);
  const double elevation = dice.uniform(lowest_rad, highest_rad);
  return {bearing.sin * std::cos(elevation), std::sin(elevation), bearing.cos * std::cos(elevation)};
}

TEST(GroundClearance, NoRayMeetsGroundBeforeItsFreeRange) {
  int met = 0, free_and_met = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const test::RandomScene random = test::random_scene(seed);
    const glm::dvec3 antenna = random.pose.antenna.m;
    test::Dice dice(seed);
    for (int k = 0; k < 10; ++k) {
      const double from_rad =
          dice.chance(0.3) ? dice.integer(0, 7) * std::numbers::pi / 4 : dice.uniform(0, 7);
      const double width_rad = dice.chance(0.2) ? 0 : dice.logarithmic(1e-4, 0.125);
      GroundClearance beam(random.world.grid, antenna, bearing_at(from_rad),
                           bearing_at(from_rad + width_rad));
      for (int ray = 0; ray < 10; ++ray) {
        const glm::dvec3 direction = ray_of(dice, from_rad, width_rad, -1.57, 0.5);
        const double free_m = beam.free_range_m(direction);
        const auto hit = walk_ground(random.world, antenna, direction, 0, 1e6);
        if (!hit) continue;
        ++met;
        free_and_met += free_m > 0 ? 1 : 0;
        ASSERT_LE(free_m, hit->slant_range_m * (1 + 1e-9)) << random.text;
      }
    }
  }
  EXPECT_GT(met, 1500);
  EXPECT_GT(free_and_met, met / 3);
}

TEST(GroundClearance, RaysOverHillsBeginAFewCellsBeforeTheGround) {
  const World world = load_world(test::synthetic_spec(SyntheticKind::hills, 20000, 30));
  const glm::dvec3 antenna{11, 2500, -17};
  test::Dice dice(5);
  double cells = 0;
  int met = 0;
  for (int k = 0; k < 100; ++k) {
    const double from_rad = dice.uniform(0, 7);
    GroundClearance beam(world.grid, antenna, bearing_at(from_rad), bearing_at(from_rad + 0.002));
    for (int ray = 0; ray < 50; ++ray) {
      const glm::dvec3 direction = ray_of(dice, from_rad, 0.002, -0.3, -0.1);
      const auto hit = walk_ground(world, antenna, direction, 0, 1e6);
      if (!hit) continue;
      ++met;
      cells += (hit->slant_range_m - beam.free_range_m(direction)) / world.grid.cell_m;
    }
  }
  std::printf("    %d rays begin %.1f cells before the ground\n", met, cells / met);
  EXPECT_GT(met, 4000);
  EXPECT_LT(cells / met, 20);
}

TEST(RoofClearance, NoRayMeetsABuildingBeforeItsFreeRange) {
  int met = 0, free_and_met = 0, free_of_all = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    test::RandomScene random = test::random_scene(seed, {.most_prisms = 12});
    const Buildings& all = random.world.buildings;
    const glm::dvec3 antenna = random.pose.antenna.m;
    const Sector sector(random.settings, random.pose);
    std::vector<std::uint32_t> numbers;
    for (std::uint32_t b = 0; b < all.list.size(); ++b) numbers.push_back(b);
    const RoofClearance roofs(all, sector, numbers);
    test::Dice dice(seed);
    for (int ray = 0; ray < 300; ++ray) {
      const glm::dvec3 direction = ray_of(dice, 0, 7, -1.57, 0.5);
      const double free_m = roofs.free_range_m(direction);
      for (const std::uint32_t b : numbers) {
        const auto hit = cross_building(random.world, b, antenna, direction);
        if (!hit) continue;
        ++met;
        free_and_met += free_m > 0 ? 1 : 0;
        ASSERT_LE(free_m, hit->slant_range_m * (1 + 1e-9)) << random.text;
      }
      free_of_all += free_m == kInfinity ? 1 : 0;
    }
  }
  EXPECT_GT(met, 2000);
  EXPECT_GT(free_and_met, met / 3);
  EXPECT_GT(free_of_all, 5000);
}

/// Rays of an array of directions, all from the antenna on.
struct Rays {
  std::vector<double> x, y, z, from, range;
  std::vector<std::uint16_t> order;

  void add(const glm::dvec3& direction) {
    order.push_back(static_cast<std::uint16_t>(x.size()));
    x.push_back(direction.x);
    y.push_back(direction.y);
    z.push_back(direction.z);
    from.push_back(0);
    range.push_back(0);
  }
  void cast(const Kernels& kernels, const HeightGrid& grid, const glm::dvec3& antenna,
            int most_cells = 1 << 20) {
    float lowest_m = HUGE_VALF;
    for (const float height : grid.y_m) lowest_m = height < lowest_m ? height : lowest_m;
    kernels.first_hits_on_ground(
        ground_view(grid, antenna),
        {order.data(), static_cast<int>(order.size()), most_cells, 1e8,
         static_cast<double>(lowest_m) - antenna.y, x.data(), y.data(), z.data(), from.data(), range.data()});
  }
};

TEST(CastGround, GivesTheSameBitsInAllInstructionSetsAndMeetsWhatTheWalkMeets) {
  const World world = load_world(test::synthetic_spec(SyntheticKind::hills, 5000, 25));
  const glm::dvec3 antenna{10, 1500, -20};
  test::Dice dice(9);
  Rays rays;
  for (int k = 0; k < 997; ++k) rays.add(ray_of(dice, 0, 7, -1.57, 0.02));
  rays.add({0, -1, 0});
  rays.add(glm::normalize(glm::dvec3(1e-312, -0.4, 0.5)));
  std::vector<double> first;
  for (const Kernels& kernels : all_kernels()) {
    SCOPED_TRACE(kernels.name);
    std::fill(rays.from.begin(), rays.from.end(), 0.0);
    rays.cast(kernels, world.grid, antenna);
    for (std::size_t k = 0; k < rays.x.size(); ++k) {
      const auto hit = walk_ground(world, antenna, {rays.x[k], rays.y[k], rays.z[k]}, 0, 1e6);
      if (!hit) {
        EXPECT_TRUE(std::isnan(rays.range[k])) << k;
        rays.range[k] = 0;
      } else {
        EXPECT_NEAR(rays.range[k], hit->slant_range_m, 1e-7) << k;
      }
    }
    if (first.empty()) first = rays.range;
    EXPECT_EQ(rays.range, first);
  }
}

TEST(CastGround, ATiredRayGoesOnFromWhereItHasCome) {
  const World world = load_world(test::synthetic_spec(SyntheticKind::flat, 5000, 25));
  const glm::dvec3 antenna{10, 100, -20};
  for (const Kernels& kernels : all_kernels()) {
    Rays rays;
    rays.add(glm::normalize(glm::dvec3(0, -0.05, 1)));
    int turns = 0;
    do {
      rays.cast(kernels, world.grid, antenna, 24);
      ++turns;
    } while (rays.range[0] == FreeRays::kOutOfSteps);
    EXPECT_NEAR(rays.range[0], 100 / std::sin(std::atan(0.05)), 1e-7);
    EXPECT_EQ(turns, 4);  // 2000 m in cells of 25 m
  }
}

TEST(CastGround, ARayThatPassesUnderTheEdgeOfAVoidMeetsWhatItNextSeesFromAbove) {
  World world = load_world(test::synthetic_spec(SyntheticKind::flat, 2000, 50));
  HeightGrid& grid = world.grid;
  const int middle = grid.nz / 2;
  // Ahead of the antenna nothing is known; then ground that stands higher than the ray, a valley, a slope.
  for (int j = middle - 1; j < grid.nz; ++j) {
    const int row = j - middle;
    const float y = row < 6    ? std::numeric_limits<float>::quiet_NaN()
                    : row < 12 ? 400.0f
                    : row < 18 ? 100.0f
                               : 400.0f;
    for (int i = 0; i < grid.nx; ++i) grid.y_m[grid.index(i, j)] = y;
  }
  const glm::dvec3 antenna{0, 300, 0};
  const glm::dvec3 direction = glm::normalize(glm::dvec3(0.001, -0.01, 1));
  const auto expected = walk_ground(world, antenna, direction, 0, 1e6);
  ASSERT_TRUE(expected);
  EXPECT_GT(expected->slant_range_m, 800);
  for (const Kernels& kernels : all_kernels()) {
    Rays rays;
    rays.add(direction);
    rays.cast(kernels, grid, antenna);
    EXPECT_NEAR(rays.range[0], expected->slant_range_m, 1e-7) << kernels.name;
  }
}

}  // namespace
}  // namespace obliq::clearance_test
