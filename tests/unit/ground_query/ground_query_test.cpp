// Ground queries against closed forms: heights, slopes, the horizon of a round earth, voids, ranges.
#include "server/ground_query/ground_query.h"

#include <gtest/gtest.h>

#include <cmath>

#include "server/ground_query/query_thread.h"
#include "server/radar/profile/plumb_line.h"
#include "tests/support/made_worlds.h"
#include "tests/support/scenes.h"

namespace obliq::ground_query_test {
namespace {

using wire::GroundState;
using wire::Sight;

/// A scene and a query of it.
struct Asked {
  std::shared_ptr<const Scene> scene;
  GroundQuery query;

  explicit Asked(World world) : scene(test::make_scene(std::move(world))), query(*scene) {}

  /// The place under a point of the world frame.
  wire::GroundRecord at(double x_m, double z_m, const PointHeight& height = {},
                        const Pose* antenna = nullptr) {
    double y = scene->world().grid.height_at_m(x_m, z_m);
    if (std::isnan(y)) y = 0;
    const Geodetic place = scene->world().frame.geodetic_from_world({glm::dvec3(x_m, y, z_m)});
    return query.answer(place.latitude_rad / kDegree_rad, place.longitude_rad / kDegree_rad, height, antenna);
  }
};

WorldSpec ramp(double bearing_deg, double radius_factor) {
  WorldSpec spec = test::synthetic_spec(SyntheticKind::ramp, 60000, 100);
  spec.terrain.shape.slope = 0.05;
  spec.terrain.shape.bearing_deg = bearing_deg;
  spec.radius_factor = radius_factor;
  return spec;
}

TEST(GroundQueries, OfARampGiveItsSlopeAndItsDownhillBearingWhateverTheCurvature) {
  for (const double radius_factor : {1.0, 4.0 / 3, HUGE_VAL}) {
    for (const double bearing : {0.0, 70.0, 200.0}) {
      Asked asked(load_world(ramp(bearing, radius_factor)));
      for (const double x : {-40000.0, 0.0, 30000.0}) {
        const wire::GroundRecord got = asked.at(x, 25000);
        ASSERT_EQ(got.state, GroundState::known);
        // Without the curvature taken out 40 km would add atan(40 / 6371) = 0.36 degrees. Cells of 100 m
        // leave steps of the rounded posts: 2^-10 m over 100 m is 6e-4 degrees.
        EXPECT_NEAR(got.slope_deg, std::atan(0.05) / kDegree_rad, 2e-3) << radius_factor << ' ' << bearing;
        const Geodetic place{got.latitude_deg * kDegree_rad, got.longitude_deg * kDegree_rad, 0};
        const double north_deg = asked.scene->world().frame.north_rad(place) / kDegree_rad;
        const double uphill = bearing - north_deg;
        EXPECT_NEAR(std::remainder(got.downhill_deg - uphill - 180, 360.0), 0, 0.03) << bearing;
        EXPECT_EQ(got.building, 0u);
        EXPECT_EQ(got.sight, Sight::not_asked);
        EXPECT_EQ(got.surface_height_m, got.height_m);
      }
    }
  }
}

TEST(GroundQueries, HeightsAreThoseThatAntennasAreCountedFrom) {
  Asked asked(load_world(ramp(30, 4.0 / 3)));
  for (const double x : {-50000.0, 10.0, 44000.0}) {
    const wire::GroundRecord got = asked.at(x, -x / 2);
    PoseSettings over;
    over.latitude_deg = got.latitude_deg;
    over.longitude_deg = got.longitude_deg;
    over.height_m = 10;
    over.height_reference = HeightReference::ground;
    std::vector<FieldError> errors;
    const auto pose = place_antenna(asked.scene->world(), over, errors);
    ASSERT_TRUE(pose);
    const double there = asked.scene->world().frame.geodetic_from_world(pose->antenna).height_m;
    EXPECT_NEAR(got.height_m + 10, there, 2e-3);  // place_antenna takes three steps
  }
}

TEST(GroundQueries, PlumbLinesAreThoseOfGeographicLib) {
  const WorldFrame frame(33 * kDegree_rad, -99.5 * kDegree_rad, 4.0 / 3);
  for (const double latitude : {31.0, 33.0, 35.5}) {
    for (const double longitude : {-102.0, -99.5, -97.25}) {
      const PlumbLine line(frame, latitude * kDegree_rad, longitude * kDegree_rad);
      for (const double height : {-100.0, 0.0, 9000.0}) {
        const Geodetic at{latitude * kDegree_rad, longitude * kDegree_rad, height};
        const glm::dvec3 expected = frame.world_from_geodetic(at).m;
        const glm::dvec3 got = line.at_height(height);
        EXPECT_NEAR(got.x, expected.x, 1e-6);
        EXPECT_NEAR(got.y, expected.y, 1e-6);
        EXPECT_NEAR(got.z, expected.z, 1e-6);
        EXPECT_NEAR(line.north_rad(), frame.north_rad(at), 1e-12);
      }
    }
  }
}

TEST(GroundQueries, TheHorizonOfARoundEarthLiesWhereItsTangentsMeet) {
  WorldSpec spec = test::synthetic_spec(SyntheticKind::flat, 70000, 100);
  spec.terrain.shape.base_m = 0;
  spec.radius_factor = 4.0 / 3;
  Asked asked(load_world(spec));
  const double antenna_m = 50, target_m = 20;
  const Pose pose = test::pose_over_origin(asked.scene->world(), antenna_m);
  // The earth's radius in the meridian at 33 N (Torge and Mueller, Geodesy, 4.13), times k.
  const double e2 = 0.00669437999014;
  const double sine = std::sin(33 * kDegree_rad);
  const double radius_m = 6378137 * (1 - e2) / std::pow(1 - e2 * sine * sine, 1.5) * 4 / 3;
  const double expected_m = std::sqrt(2 * radius_m * antenna_m) + std::sqrt(2 * radius_m * target_m);
  double seen = 1000, hidden = 60000;
  while (hidden - seen > 1) {
    const double middle = (seen + hidden) / 2;
    const auto got = asked.at(0, middle, {target_m, HeightReference::ground, 0}, &pose);
    (got.sight == Sight::visible ? seen : hidden) = middle;
    EXPECT_EQ(got.clearance_deg >= 0, got.sight == Sight::visible);
  }
  // Chords of 100 m cut the sphere by 0.15 mm; what less than a millimetre hides counts as seen: 1e-3 m over
  // the slope of 0.0047 there is 0.3 m. Without refraction it would be 13 % nearer.
  EXPECT_NEAR(seen, expected_m, 0.001 * expected_m);
  EXPECT_GT(expected_m, 45000);
}

TEST(GroundQueries, ClearanceIsTheAngleFromTheEdgeInTheWay) {
  // A block 30 m high and 100 m thick from 1000 m on; the antenna 10 m over flat ground.
  Asked asked(
      test::made_world(4000, 10, [](double, double z) { return z >= 1000 && z <= 1100 ? 30.0 : 0.0; }));
  const Pose pose = test::pose_at(asked.scene->world(), {0.0, 10.0, 0.0}, 0);
  const double edge = std::atan2(20.0, 1000.0);
  for (const double z : {1500.0, 3000.0}) {
    for (const double height : {5.0, 20.0, 45.0, 300.0}) {
      const auto got = asked.at(0, z, {height, HeightReference::ground, 0}, &pose);
      const double expected = std::atan2(height - 10, z) - edge;
      // Heights over the datum are counted along plumb lines, 3 km from the origin 5e-4 rad off.
      EXPECT_NEAR(got.clearance_deg, expected / kDegree_rad, 1e-4 * height / 45);
      EXPECT_EQ(got.sight, expected < 0 ? Sight::behind_ground : Sight::visible);
      EXPECT_NEAR(got.obstacle_range_m, 1000, 0.01);
    }
  }
}

TEST(GroundQueries, PointsInAndOnAndBehindABuildingAreToldApart) {
  World world = test::made_world(2000, 10, [](double, double) { return 100.0; });
  test::add_prism(world, test::rectangle(0, 500, 40, 20), 25);
  Asked asked(std::move(world));
  const Pose pose = test::pose_at(asked.scene->world(), {0.0, 110.0, 0.0}, 0);
  const auto in = asked.at(0, 500, {10, HeightReference::ground, 0}, &pose);
  EXPECT_EQ(in.sight, Sight::inside_building);
  EXPECT_EQ(in.building, 1u);
  EXPECT_EQ(in.material, 1);
  EXPECT_NEAR(in.surface_height_m - in.height_m, 25, 1e-3);
  // On the roof's far part: its near edge hides what an antenna below it looks at.
  EXPECT_EQ(asked.at(0, 505, {25, HeightReference::ground, 0}, &pose).sight, Sight::behind_building);
  const Pose above = test::pose_at(asked.scene->world(), {0.0, 400.0, 0.0}, 0);
  EXPECT_EQ(asked.at(0, 505, {25, HeightReference::ground, 0}, &above).sight, Sight::visible);
  EXPECT_EQ(asked.at(0, 600, {}, &pose).sight, Sight::behind_building);
  EXPECT_EQ(asked.at(100, 600, {}, &pose).sight, Sight::visible);
  EXPECT_EQ(asked.at(100, 600, {-1, HeightReference::ground, 0}, &pose).sight, Sight::below_ground);
}

TEST(GroundQueries, VoidsAndPlacesOffTheModelAreSaid) {
  Asked asked(test::made_world(2000, 10, [](double x, double z) {
    return x > 200 && x < 600 && std::abs(z) < 300 ? test::kUnknown : 50.0;
  }));
  const Pose pose = test::pose_at(asked.scene->world(), {0.0, 150.0, 0.0}, 0);
  const auto hole = asked.at(400, 0, {}, &pose);
  EXPECT_EQ(hole.state, GroundState::unknown);
  EXPECT_EQ(hole.sight, Sight::no_height);
  EXPECT_EQ(hole.height_m, 0);
  const auto over_hole = asked.at(400, 0, {60, HeightReference::datum, 0}, &pose);
  EXPECT_EQ(over_hole.sight, Sight::visible_over_unknown);
  EXPECT_EQ(over_hole.point_height_m, 60);
  EXPECT_EQ(asked.at(1000, 0, {}, &pose).sight, Sight::visible_over_unknown);
  EXPECT_EQ(asked.at(-1000, 0, {}, &pose).sight, Sight::visible);
  EXPECT_EQ(asked.at(9000, 0, {}, &pose).state, GroundState::outside);
  EXPECT_EQ(asked.at(9000, 0, {60, HeightReference::datum, 0}, &pose).sight, Sight::visible_over_unknown);
  // The other side of the earth.
  const auto far = asked.query.answer(-33, 80.5, {60, HeightReference::datum, 0}, &pose);
  EXPECT_EQ(far.state, GroundState::outside);
  EXPECT_TRUE(std::isfinite(far.clearance_deg));
}

TEST(GroundQueries, BearingAndRangeFindTheNearestGroundThatIsSoFarAway) {
  Asked asked(test::made_world(
      5000, 10, [](double x, double z) { return 100 + 40 * std::sin(x / 130) * std::cos(z / 170); }));
  const World& world = asked.scene->world();
  const Pose pose = test::pose_at(world, {35.0, 700.0, -20.0}, 0);
  int found = 0;
  for (double bearing = -350; bearing < 360; bearing += 17) {
    for (double range = 300; range < 4500; range *= 1.13) {
      const auto got = asked.query.answer_at_range(bearing, range, {}, pose);
      if (got.state != GroundState::known) {
        EXPECT_EQ(got.state, GroundState::too_near) << range;
        EXPECT_LT(range, 700);
        continue;
      }
      ++found;
      const glm::dvec3 place = world.frame
                                   .world_from_geodetic({got.latitude_deg * kDegree_rad,
                                                         got.longitude_deg * kDegree_rad, got.height_m})
                                   .m;
      EXPECT_NEAR(std::hypot(place.x - 35, place.y - 700, place.z + 20), range, 1e-3);
      const double angle = std::atan2(place.x - 35, place.z + 20) - pose.north_rad;
      EXPECT_NEAR(std::remainder(angle / kDegree_rad - bearing, 360.0), 0, 1e-5);
      // None nearer: by steps along the same line.
      const double d = std::hypot(place.x - 35, place.z + 20);
      for (double nearer = 1; nearer < d - 1; nearer += 7) {
        const double x = 35 + (place.x - 35) * nearer / d, z = -20 + (place.z + 20) * nearer / d;
        EXPECT_LT(std::hypot(nearer, world.grid.height_at_m(x, z) - 700), range + 1e-3);
      }
    }
  }
  EXPECT_GT(found, 500);
  EXPECT_EQ(asked.query.answer_at_range(0, 9000, {}, pose).state, GroundState::outside);
}

TEST(GroundQueries, WhatCannotBeAnsweredIsRefusedByName) {
  const auto first_fault = [](const GroundQuestion& question) {
    const auto faults = faults_of(question);
    return faults.empty() ? std::string() : faults.front().text();
  };
  GroundQuestion good;
  good.latitude_deg = {33, 34};
  good.longitude_deg = {-99, -98};
  EXPECT_EQ(first_fault(good), "");
  EXPECT_NE(first_fault({}).find("no point"), std::string::npos);
  GroundQuestion q = good;
  q.latitude_deg[1] = NAN;
  EXPECT_EQ(first_fault(q), "latitude_deg[1]: found nan; allowed: -90 to 90");
  q = good;
  q.longitude_deg[0] = HUGE_VAL;
  EXPECT_EQ(first_fault(q), "longitude_deg[0]: found inf; allowed: -180 to 180");
  q = good;
  q.longitude_deg.pop_back();
  EXPECT_EQ(first_fault(q),
            "longitude_deg: found 1 values; allowed: as many as there are points, which is 2");
  q = good;
  q.height_m = {1, 2, 3};
  EXPECT_EQ(first_fault(q), "height_m: found 3 values; allowed: as many as there are points, which is 2");
  q = good;
  q.range_m = {5};
  EXPECT_NE(first_fault(q).find("one of the two"), std::string::npos);
  q = {};
  q.bearing_deg = {10};
  q.range_m = {0};
  EXPECT_EQ(faults_of(q).size(), 2u);  // the range, and that there is no antenna
  q = good;
  q.geoid_undulation_m = NAN;
  EXPECT_NE(first_fault(q).find("geoid_undulation_m"), std::string::npos);
}

TEST(GroundQueries, ClientsTakeTurnsAndOneThatLeavesIsForgotten) {
  QueryThread thread;
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<std::uint64_t> order;
  bool open = false, stopped = false;
  thread.enqueue(1, [&](const std::stop_token&) {
    std::unique_lock lock(mutex);
    changed.wait(lock, [&] { return open; });
  });
  const auto note = [&](std::uint64_t client) {
    return [&, client](const std::stop_token&) {
      const std::lock_guard lock(mutex);
      order.push_back(client);
      changed.notify_all();
    };
  };
  for (const std::uint64_t client : {1u, 1u, 1u, 2u, 3u, 3u, 4u}) thread.enqueue(client, note(client));
  thread.forget(4);
  {
    std::unique_lock lock(mutex);
    open = true;
    changed.notify_all();
    changed.wait(lock, [&] { return order.size() == 6; });
  }
  EXPECT_EQ(order, (std::vector<std::uint64_t>{2, 3, 1, 3, 1, 1}));
  thread.enqueue(5, [&](const std::stop_token& stop) {
    {
      const std::lock_guard lock(mutex);
      open = false;
      changed.notify_all();
    }
    while (!stop.stop_requested()) std::this_thread::yield();
    stopped = true;
  });
  {
    std::unique_lock lock(mutex);
    changed.wait(lock, [&] { return !open; });
  }
  thread.forget(5);
  thread.end();
  EXPECT_TRUE(stopped);
}

}  // namespace
}  // namespace obliq::ground_query_test
