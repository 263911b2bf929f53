// Convex parts of footprints: they are the footprint, and their outer edges are its walls.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "terrain/buildings/footprints.h"
#include "tests/support/made_worlds.h"
#include "tests/support/parts_check.h"

namespace obliq {
namespace {

World flat() {
  return test::made_world(50000, 1000, [](double, double) { return 0.0; });
}

void stand(World& world, const Polygon& polygon) {
  OutlineShaper shaper;
  stand_outline(world, shaper, polygon, {10, 1, world.buildings.list.size()});
}

/// Checks them all; the number of buildings that have parts of their own.
int expect_all_whole(const World& world) {
  int cut = 0;
  for (std::uint32_t b = 0; b < world.buildings.list.size(); ++b)
    cut += test::expect_parts_make_up(world.buildings, b, "building " + std::to_string(b)) > 0;
  return cut;
}

/// A ring that no edge of its own crosses: distances from a centre, at rising angles.
Ring star(std::mt19937_64& random, glm::dvec2 centre, std::size_t corners, double least_m, double most_m) {
  std::uniform_real_distribution<double> unit(0, 1);
  Ring ring;
  for (std::size_t k = 0; k < corners; ++k) {
    const double angle =
        2 * std::numbers::pi * (static_cast<double>(k) + 0.9 * unit(random)) / static_cast<double>(corners);
    ring.push_back(centre + (least_m + (most_m - least_m) * unit(random)) *
                                glm::dvec2(std::cos(angle), std::sin(angle)));
  }
  return ring;
}

TEST(ConvexParts, ConvexFootprintsHaveNone) {
  World world = flat();
  stand(world, {{test::rectangle(100, 200, 30, 12)}});
  // A corner in the middle of a wall leaves the footprint convex.
  stand(world, {{{{0, 0}, {5, 0}, {10, 0}, {10, 10}, {0, 10}}}});
  ASSERT_EQ(world.buildings.list.size(), 2u);
  EXPECT_EQ(expect_all_whole(world), 0);
  EXPECT_TRUE(world.buildings.parts.empty());
}

TEST(ConvexParts, AnLIsTwoAndACourtyardFour) {
  World world = flat();
  stand(world, {{{{0, 0}, {20, 0}, {20, 10}, {10, 10}, {10, 30}, {0, 30}}}});
  stand(world, {{{{0, 100}, {20, 100}, {20, 120}, {0, 120}}, {{5, 105}, {15, 105}, {15, 115}, {5, 115}}}});
  EXPECT_EQ(expect_all_whole(world), 2);
  EXPECT_EQ(world.buildings.list[0].n_parts, 2u);
  EXPECT_EQ(world.buildings.list[1].n_parts, 4u);
}

TEST(ConvexParts, ARoundTowerOfManyCornersIsCutToThirtyTwo) {
  World world = flat();
  stand(world, {{test::ellipse(100, 100, 1000)}});
  EXPECT_EQ(expect_all_whole(world), 1);
  // A thousand edges need at least 1000 / 30 parts, each of which has two edges or more within.
  EXPECT_LE(world.buildings.parts.size(), 100u);
}

TEST(ConvexParts, ThousandsOfRandomConcaveFootprintsAreTheSumOfTheirParts) {
  std::mt19937_64 random(31);
  World world = flat();
  std::uniform_real_distribution<double> place(-40000, 40000);
  for (int n = 0; n < 6000; ++n) {
    const glm::dvec2 centre(place(random), place(random));
    Polygon polygon{{star(random, centre, 5 + random() % 40, n % 2 ? 2 : 9, 10)}};
    // Courtyards: one in the middle, or small ones beside each other.
    if (n % 3 == 0) polygon.rings.push_back(star(random, centre, 3 + random() % 8, 0.5, 1.5));
    stand(world, polygon);
  }
  ASSERT_GT(world.buildings.list.size(), 5900u);
  EXPECT_GT(expect_all_whole(world), 5000);
}

TEST(ConvexParts, TangledOutlinesLoseNoWall) {
  std::mt19937_64 random(5);
  World world = flat();
  std::uniform_real_distribution<double> place(-20, 20);
  for (int round = 0; round < 4000; ++round) {
    // Whole metres make corners on edges, rings that touch and straight corners common.
    const bool coarse = round % 2 == 0;
    Polygon polygon;
    const std::size_t rings = 1 + random() % 4;
    for (std::size_t r = 0; r < rings; ++r) {
      Ring ring(3 + random() % 12);
      for (glm::dvec2& p : ring) {
        p = {place(random) / static_cast<double>(r + 1), place(random) / static_cast<double>(r + 1)};
        if (coarse) p = {std::round(p.x), std::round(p.y)};
        p += glm::dvec2(1, -1) * (round % 3 == 0 ? 40000.0 : 100.0);
      }
      polygon.rings.push_back(ring);
    }
    stand(world, polygon);
  }
  ASSERT_GT(world.buildings.list.size(), 4000u);
  EXPECT_GT(expect_all_whole(world), 3000);
}

}  // namespace
}  // namespace obliq
