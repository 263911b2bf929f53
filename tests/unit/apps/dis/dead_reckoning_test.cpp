// Where entities are between their PDUs.
#include "server/apps/dis/dead_reckoning.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include "server/apps/dis/ownship.h"
#include "tests/unit/apps/dis/dis_fixture.h"

namespace obliq::test::dead_reckoning_test {
namespace {

constexpr double kSpeed_m_s = 250;
constexpr double kTurn_rad_s = 6 * kDegree;

/// Level flight that turns to the right.
EntityState turning(std::uint8_t algorithm) {
  EntityState state = entity();
  state.dead_reckoning = algorithm;
  state.velocity_m_s = kSpeed_m_s * state.body.nose;
  state.turn_rad_s = kTurn_rad_s * state.body.below;
  return state;
}

/// On a circle, along nose and right.
glm::dvec3 on_circle(const EntityState& state, double t) {
  const double radius = kSpeed_m_s / kTurn_rad_s;
  return state.location_m + radius * std::sin(kTurn_rad_s * t) * state.body.nose +
         radius * (1 - std::cos(kTurn_rad_s * t)) * state.body.right;
}

TEST(DeadReckoning, GoesRoundInTheBodysAxes) {
  for (const std::uint8_t algorithm : {std::uint8_t{7}, std::uint8_t{8}})
    for (const double t : {-3.0, 0.0, 1e-3, 0.2, 1.0, 5.0, 9.5, 9.6, 60.0, 144.0}) {
      const EntityState state = turning(algorithm);
      const EntityMotion motion = reckoned(state, t);
      EXPECT_LT(glm::distance(motion.location_m, on_circle(state, t)), 1e-6) << t;
      EXPECT_NEAR(glm::dot(motion.velocity_m_s, motion.body.nose), kSpeed_m_s, 1e-9) << t;
      EXPECT_NEAR(glm::dot(motion.acceleration_m_s2, motion.body.right), kSpeed_m_s * kTurn_rad_s, 1e-9) << t;
    }
}

TEST(DeadReckoning, MetresThatATurnCostsWithoutIt) {
  const EntityState state = turning(7);
  const glm::dvec3 push = glm::cross(state.turn_rad_s, state.velocity_m_s);
  const auto by_velocity = [&](double t) { return state.location_m + state.velocity_m_s * t; };
  const auto error = [&](const glm::dvec3& place, double t) {
    return glm::distance(place, reckoned(state, t).location_m);
  };
  EXPECT_NEAR(error(by_velocity(5), 5), 324.8, 0.05);
  EXPECT_NEAR(error(by_velocity(5) + 12.5 * push, 5), 56.8, 0.05);
  EXPECT_NEAR(error(by_velocity(1), 1), 13.1, 0.05);
  EXPECT_NEAR(error(by_velocity(1) + 0.5 * push, 1), 0.46, 0.005);
}

TEST(DeadReckoning, SentAnewFiveTimesASecondATurnLeavesFourMillimetres) {
  const EntityState state = turning(7);
  double worst_m = 0;
  for (int k = 0; k < 25; ++k) {
    const EntityMotion sent = reckoned(state, 0.2 * k);
    for (const double t : {0.05, 0.1, 0.15, 0.2}) {
      const glm::dvec3 shown =
          sent.location_m + sent.velocity_m_s * t + sent.acceleration_m_s2 * (0.5 * t * t);
      worst_m = std::max(worst_m, glm::distance(shown, reckoned(state, 0.2 * k + t).location_m));
    }
  }
  EXPECT_GT(worst_m, 3e-3);
  EXPECT_LT(worst_m, 4e-3);
}

TEST(DeadReckoning, IsTheIntegralOfItsVelocityAboutAnyAxis) {
  EntityState state = turning(8);
  state.body = body_axes(0.4, -0.3, 1.1);
  state.velocity_m_s = {120, -40, 15};
  state.acceleration_m_s2 = {3, 5, -2};
  for (const glm::dvec3& turn :
       {glm::dvec3(0.3, -0.2, 0.5), glm::dvec3(1e-5, 2e-5, 0), glm::dvec3(0, 0, 1.9)}) {
    state.turn_rad_s = turn;
    const double t = 4;
    constexpr int kSteps = 4000;  // of Simpson's rule: 1e-9 m
    const double h = t / kSteps;
    glm::dvec3 way{0.0};
    for (int k = 0; k <= kSteps; ++k) {
      const double weight = k == 0 || k == kSteps ? 1 : k % 2 == 1 ? 4 : 2;
      way += weight * h / 3 * reckoned(state, k * h).velocity_m_s;
    }
    EXPECT_LT(glm::distance(reckoned(state, t).location_m, state.location_m + way), 1e-6);
    // And the acceleration is the velocity's slope.
    const glm::dvec3 slope =
        (reckoned(state, t + 1e-4).velocity_m_s - reckoned(state, t - 1e-4).velocity_m_s) / 2e-4;
    EXPECT_LT(glm::distance(slope, reckoned(state, t).acceleration_m_s2), 1e-4);
  }
}

TEST(DeadReckoning, OfEachAlgorithm) {
  for (int algorithm = 0; algorithm <= 11; ++algorithm) {
    SCOPED_TRACE(algorithm);
    EntityState state = turning(static_cast<std::uint8_t>(algorithm));
    state.acceleration_m_s2 = 2.0 * state.body.below;
    const EntityMotion motion = reckoned(state, 2);
    const glm::dvec3 by_velocity = state.location_m + 2.0 * state.velocity_m_s;
    glm::dvec3 expected = state.location_m;
    if (algorithm == 2 || algorithm == 3 || algorithm == 6) expected = by_velocity;
    if (algorithm == 4 || algorithm == 5 || algorithm == 9) expected = by_velocity + 4.0 * state.body.below;
    if (algorithm == 7) expected = on_circle(state, 2);
    if (algorithm == 8) expected = on_circle(state, 2) + 4.0 * state.body.below;  // it turns about that axis
    EXPECT_LT(glm::distance(motion.location_m, expected), 1e-6);
    const bool turns = algorithm == 3 || algorithm == 4 || algorithm == 7 || algorithm == 8;
    EXPECT_NEAR(glm::dot(motion.body.nose, state.body.nose), turns ? std::cos(2 * kTurn_rad_s) : 1, 1e-12);
    EXPECT_EQ(is_curved(state), algorithm == 7 || algorithm == 8);
    state.frozen = true;
    EXPECT_EQ(reckoned(state, 2).location_m, state.location_m);
    EXPECT_EQ(reckoned(state, 2).velocity_m_s, glm::dvec3(0.0));
  }
}

TEST(DeadReckoning, OfAnOwnshipFollowsItsTurn) {
  const EntityState state = turning(7);
  const Place expected = place_of(on_circle(state, 5));
  const OwnshipPose pose = dead_reckoned(state, 5);
  EXPECT_NEAR(pose.latitude_deg, expected.latitude_deg, 1e-11);
  EXPECT_NEAR(pose.longitude_deg, expected.longitude_deg, 1e-11);
  EXPECT_NEAR(pose.height_m, expected.height_m, 1e-6);
}

}  // namespace
}  // namespace obliq::test::dead_reckoning_test
