// Convex parts of footprints: they are the footprint, and their outer edges are its walls.
#include "terrain/buildings/outline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "terrain/buildings/clip_ears.h"
#include "terrain/buildings/footprints.h"
#include "tests/support/made_worlds.h"
#include "tests/support/parts_check.h"

namespace obliq::outline_test {
namespace {

double ring_area(const std::vector<glm::vec2>& ring) {
  double twice = 0;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const glm::dvec2 a(ring[k]), b(ring[(k + 1) % ring.size()]);
    twice += a.x * b.y - b.x * a.y;
  }
  return twice / 2;
}

/// Rings the right way round, and roof triangles that are clockwise and add up to the area between the rings.
void expect_sound(const Outline& outline) {
  std::vector<glm::dvec2> points;
  double between = 0;
  for (std::size_t r = 0; r < outline.rings_m.size(); ++r) {
    ASSERT_GE(outline.rings_m[r].size(), 3u);
    const double area = ring_area(outline.rings_m[r]);
    EXPECT_EQ(area > 0, r == 0);
    between += area;
    for (glm::vec2 p : outline.rings_m[r]) points.emplace_back(p);
  }
  double roof = 0;
  for (glm::uvec3 t : outline.roof) {
    const glm::dvec2 u = points[t.y] - points[t.x], v = points[t.z] - points[t.x];
    const double area = -(u.x * v.y - u.y * v.x) / 2;
    EXPECT_GE(area, 0);
    roof += area;
  }
  EXPECT_NEAR(roof, between, 1e-6 * between + 1e-9);
  EXPECT_GT(between, 0);
}

/// Rings whose whole metres make corners on edges, edges on edges, rings that touch and straight corners
/// common; far coordinates are coarse in float32.
Polygon tangled(std::mt19937_64& random, int round, std::size_t most_rings) {
  std::uniform_real_distribution<double> place(-20, 20);
  Polygon polygon;
  polygon.rings.resize(1 + random() % most_rings);
  for (std::size_t r = 0; r < polygon.rings.size(); ++r) {
    polygon.rings[r].resize(3 + random() % 12);
    for (glm::dvec2& p : polygon.rings[r]) {
      p = {place(random) / static_cast<double>(r + 1), place(random) / static_cast<double>(r + 1)};
      if (round % 2 == 0) p = {std::round(p.x), std::round(p.y)};
      p += glm::dvec2(1, -1) * (round % 3 == 0 ? 40000.0 : 100.0);
    }
  }
  return polygon;
}

TEST(Outline, RandomTangledRingsBecomeSoundOnesOrNone) {
  std::mt19937_64 random(5);
  OutlineShaper shaper;
  int repaired = 0;
  for (int round = 0; round < 3000; ++round) {
    const ShapedOutline shaped = shaper.shape(tangled(random, round, 3));
    EXPECT_EQ(shaped.parts.empty(),
              shaped.state == OutlineState::zero_area || shaped.state == OutlineState::unusable);
    if (shaped.state == OutlineState::repaired) ++repaired;
    for (const Outline& part : shaped.parts) expect_sound(part);
  }
  EXPECT_GT(repaired, 2000);
}

TEST(Outline, LShapeWithTwoHolesIsCutExactly) {
  OutlineShaper shaper;
  const Polygon polygon{{{{0, 0}, {40, 0}, {40, 20}, {20, 20}, {20, 60}, {0, 60}},
                         {{2, 2}, {8, 2}, {8, 8}, {2, 8}},
                         {{2, 40}, {2, 50}, {10, 50}, {10, 40}}}};
  const ShapedOutline shaped = shaper.shape(polygon);
  ASSERT_EQ(shaped.state, OutlineState::good);
  ASSERT_EQ(shaped.parts.size(), 1u);
  expect_sound(shaped.parts[0]);
  EXPECT_DOUBLE_EQ(shaped.parts[0].area_m2, 40 * 20 + 20 * 40 - 36 - 80);
  // n corners and h holes make n + 2 h - 2 triangles.
  EXPECT_EQ(shaped.parts[0].roof.size(), 14u + 4u - 2u);
}

/// A strip that winds from the middle outwards, its two sides of n corners each.
Ring spiral(int n) {
  Ring ring;
  const auto add = [&](double k) { ring.emplace_back(0.1 * k * std::cos(k / 5), 0.1 * k * std::sin(k / 5)); };
  const double width = 10;  // of a turn's 31
  for (int k = 0; k < n; ++k) add(k);
  for (int k = n - 1; k >= 0; --k) {
    add(k);
    ring.back() *= (k + width) / std::max(k, 1);
  }
  return ring;
}

TEST(Outline, ASpiralOfAsManyCornersAsAreAllowedIsCutWithWorkOfTheirSquare) {
  OutlineShaper shaper;
  Ring strip = spiral(static_cast<int>(OutlineShaper::kMostCorners / 2));
  const ShapedOutline shaped = shaper.shape({{strip}});
  ASSERT_EQ(shaped.state, OutlineState::good);
  ASSERT_EQ(shaped.parts.size(), 1u);
  const Outline& outline = shaped.parts[0];
  expect_sound(outline);
  const std::size_t n = outline.rings_m[0].size();
  EXPECT_GT(n, OutlineShaper::kMostCorners - 5);
  EXPECT_EQ(outline.roof.size(), n - 2);
  std::uint64_t looks = 0;
  EXPECT_EQ(clip_ears(outline.rings_m, &looks).size(), n - 2);
  EXPECT_LT(looks, 3 * n * n) << "a corner is looked at anew though none of its neighbours has gone";
}

TEST(Outline, ManyCornersWithManyHolesAreCutIntoTheTrianglesOfTheirCount) {
  OutlineShaper shaper;
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> part(0, 1);
  for (int round = 0; round < 40; ++round) {
    Polygon polygon;
    const int n = 300 + static_cast<int>(random() % 600);
    Ring& star = polygon.rings.emplace_back();
    for (int k = 0; k < n; ++k) {
      const double turns = 2 * std::numbers::pi * k / n, r = k % 2 == 0 ? 300 : 100 + 150 * part(random);
      star.emplace_back(r * std::cos(turns), r * std::sin(turns));
    }
    const int side = 7 + static_cast<int>(random() % 6);
    for (int i = 0; i < side * side; ++i) {
      const double step = 100.0 / side;
      const glm::dvec2 centre(-50 + step * (i % side + 0.5), -50 + step * (i / side + 0.5));
      Ring& hole = polygon.rings.emplace_back();
      const int corners = 3 + static_cast<int>(random() % 6);
      const double r = step * (0.1 + 0.3 * part(random)), first = part(random);
      for (int k = 0; k < corners; ++k)
        hole.push_back(centre + r * glm::dvec2(std::cos(first + 2 * std::numbers::pi * k / corners),
                                               std::sin(first + 2 * std::numbers::pi * k / corners)));
    }
    const ShapedOutline shaped = shaper.shape(polygon);
    ASSERT_EQ(shaped.parts.size(), 1u);
    const Outline& outline = shaped.parts[0];
    expect_sound(outline);
    std::size_t corners = 0;
    for (const FloatRing& ring : outline.rings_m) corners += ring.size();
    ASSERT_GT(corners, 512u);
    // n corners and h holes make n + 2 h - 2 triangles.
    const std::size_t wanted = corners + 2 * (outline.rings_m.size() - 1) - 2;
    EXPECT_EQ(outline.roof.size(), wanted);
    EXPECT_EQ(clip_ears(outline.rings_m).size(), wanted) << "it was left to GEOS";
  }
}

TEST(Outline, OverlappingRingsAreUnitedRatherThanCutOut) {
  OutlineShaper shaper;
  // The line runs around the same square twice: still one house.
  const Polygon twice{{{{0, 0}, {10, 0}, {10, 10}, {0, 10}, {0, 0}, {10, 0}, {10, 10}, {0, 10}}}};
  const ShapedOutline shaped = shaper.shape(twice);
  ASSERT_EQ(shaped.parts.size(), 1u);
  EXPECT_DOUBLE_EQ(shaped.parts[0].area_m2, 100);
}

TEST(Outline, NumbersThatAreNoneAreUnusable) {
  OutlineShaper shaper;
  for (double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e300}) {
    EXPECT_EQ(shaper.shape({{{{0, 0}, {bad, 0}, {1, 1}}}}).state, OutlineState::unusable);
  }
  EXPECT_EQ(shaper.shape({}).state, OutlineState::unusable);
  EXPECT_EQ(shaper.shape({{{}}}).state, OutlineState::unusable);
  EXPECT_EQ(shaper.shape({{{{0, 0}, {1, 1}}}}).state, OutlineState::unusable);
  EXPECT_EQ(shaper.shape({{{{0, 0}, {1, 1}, {2, 2}}}}).state, OutlineState::zero_area);
}

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
  for (int round = 0; round < 4000; ++round) stand(world, tangled(random, round, 4));
  ASSERT_GT(world.buildings.list.size(), 4000u);
  EXPECT_GT(expect_all_whole(world), 3000);
}

}  // namespace
}  // namespace obliq::outline_test
