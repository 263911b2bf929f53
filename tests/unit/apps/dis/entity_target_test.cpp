// What entities of DIS are as targets: their type, their place and motion.
#include "server/apps/dis/entity_target.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "proto/obliq.pb.h"
#include "server/control/config_tree.h"
#include "server/control/sections/targets.h"
#include "server/control/target_message.h"
#include "server/radar/targets/target_motion.h"
#include "tests/unit/apps/dis/dis_fixture.h"

namespace obliq::test::entity_target_test {
namespace {

TEST(DisPattern, MatchesPartByPart) {
  const DisEntityType type{1, 1, 225, 7, 2, 3, 4};
  const auto matches = [&](const char* text) {
    const auto pattern = DisPattern::parse(text);
    EXPECT_TRUE(pattern) << text;
    return pattern && pattern->matches(type);
  };
  for (const char* text :
       {"1", "1.1", "1.1.225.7", "*.1.225", "1.1.*.7", "1.1.225.7.2.3.4", "*.*.*.*.*.*.*", "*"})
    EXPECT_TRUE(matches(text)) << text;
  for (const char* text : {"2", "1.2", "1.1.225.8", "*.2", "1.1.225.7.2.3.5", "1.1.*.81"})
    EXPECT_FALSE(matches(text)) << text;
  EXPECT_EQ(DisPattern::parse("1.1.*.7")->said(), 3);
  EXPECT_EQ(DisPattern::parse("1.1.*.7.*.*")->said(), 3);
}

TEST(DisPattern, TextsThatAreNoneAreRefused) {
  for (const char* text : {"", ".", "1.", ".1", "1..2", "a", "1.-1", "256", "1.256", "1.1.65536",
                           "1.1.225.256", "1 .1", "1.1.225.7.2.3.4.5", "+1", "**", "1.1.225.7.2.3.4."})
    EXPECT_FALSE(DisPattern::parse(text)) << text;
  EXPECT_TRUE(DisPattern::parse("1.1.65535"));
}

std::vector<TargetType> types(const char* text) {
  return read_type_file(parse_config_text(text, "types.toml"));
}

TEST(EntityKinds, ThePatternThatSaysMostWins) {
  EntityKinds kinds(types("[target_types.mine]\ndis = [\"1.1.225.7\", \"1.3\"]\n"),
                    types("[target_types.a]\ndis = \"1.1\"\n[target_types.b]\ndis = [\"1.1.225.7.2\"]\n"
                          "[target_types.c]\ndis = [\"1.1.225.7\"]\n"));
  const auto name = [&](const DisEntityType& type, bool of_server) {
    const EntityKinds::Match match = kinds.of(type);
    EXPECT_EQ(match.of_server, of_server);
    return match.type == nullptr ? "none" : match.type->name;
  };
  EXPECT_EQ(name({1, 1, 225, 7, 1, 0, 0}, false), "mine") << "as many numbers as c's";
  EXPECT_EQ(name({1, 1, 225, 7, 2, 0, 0}, true), "b");
  EXPECT_EQ(name({1, 1, 222, 7, 2, 0, 0}, true), "a");
  EXPECT_EQ(name({1, 3, 225, 1, 0, 0, 0}, false), "mine") << "before the shipped carrier";
  EXPECT_EQ(name({1, 2, 225, 1, 0, 0, 0}, false), "fighter") << "of the shipped ones";
  EXPECT_TRUE(kinds.take_news().empty());
}

TEST(EntityKinds, WhatOnlyItsDomainCatchesIsToldOnce) {
  EntityKinds kinds({}, {});
  for (int k = 0; k < 3; ++k) EXPECT_EQ(kinds.of({1, 2, 225, 77, 5, 0, 0}).type->name, "aircraft");
  for (int k = 0; k < 3; ++k) EXPECT_EQ(kinds.of({7, 0, 225, 1, 0, 0, 0}).type, nullptr);
  const std::vector<std::string> news = kinds.take_news();
  ASSERT_EQ(news.size(), 2u);
  EXPECT_EQ(news[0],
            "entities 1.2.225.77.5.0.0 are of type \"aircraft\" by kind and domain alone; dis = "
            "[\"1.2.225.77.5.0.0\"] of another type would catch them");
  EXPECT_NE(news[1].find("entities 7.0.225.1.0.0.0 are no targets"), std::string::npos) << news[1];
}

TEST(EntityKinds, TheShippedTypesAreOverLandAirAndWater) {
  const std::vector<TargetType> shipped =
      read_type_file(parse_config_text(shipped_target_types(), "target_types.toml"));
  EXPECT_GE(shipped.size(), 20u);
  EntityKinds kinds({}, {});
  const auto name = [&](const DisEntityType& type) {
    const TargetType* found = kinds.of(type).type;
    return found == nullptr ? "none" : found->name;
  };
  EXPECT_EQ(name({1, 1, 225, 1, 1, 0, 0}), "tank");
  EXPECT_EQ(name({1, 1, 225, 81, 0, 0, 0}), "car");
  EXPECT_EQ(name({1, 1, 225, 83, 0, 0, 0}), "truck");
  EXPECT_EQ(name({1, 2, 225, 20, 0, 0, 0}), "helicopter");
  EXPECT_EQ(name({1, 2, 225, 50, 0, 0, 0}), "drone");
  EXPECT_EQ(name({2, 1, 225, 1, 0, 0, 0}), "missile");
  EXPECT_EQ(name({1, 3, 225, 82, 0, 0, 0}), "tanker");
  EXPECT_EQ(name({3, 1, 225, 1, 0, 0, 0}), "person");
  // No two types have the same pattern, so that none hides another.
  std::set<std::string> patterns;
  for (const TargetType& type : shipped)
    for (const std::string& pattern : type.dis) EXPECT_TRUE(patterns.insert(pattern).second) << pattern;
}

class EntityTargets : public testing::Test {
 protected:
  EntityTargets() {
    type.name = "jet";
    type.size = {7, 2, 20, 10, 5};
    state.velocity_m_s = {80, -150, 40};
    state.acceleration_m_s2 = {1, 2, -3};
    state.dead_reckoning = 5;
    state.body = body_axes(0.7, -0.6, 0.2);
  }
  wire::Target message(double after_s = 0) const {
    wire::Target target;
    EXPECT_TRUE(write_target({state, reckoned(state, after_s)}, {&type, of_server, false}, heights, target));
    return target;
  }
  EntityState state = entity();
  TargetType type;
  bool of_server = false;
  EntityHeights heights{-30, false};
};

TEST_F(EntityTargets, HaveTheirPlaceAndSizeAndAStableId) {
  state.marking = "OWL 7";
  const wire::Target target = message();
  EXPECT_EQ(target.id(), (std::uint64_t{1} << 48) + (std::uint64_t{1} << 32) + (2 << 16) + 1);
  EXPECT_EQ(target.name(), "OWL 7");
  EXPECT_NEAR(target.latitude_deg(), 33.0, 1e-11);
  EXPECT_NEAR(target.longitude_deg(), -99.5, 1e-11);
  EXPECT_NEAR(target.height_m(), 2000, 1e-6);
  EXPECT_EQ(target.height_reference(), wire::ELLIPSOID);
  EXPECT_EQ(target.geoid_undulation_m(), -30);
  EXPECT_EQ(target.type(), "");
  EXPECT_EQ(target.rcs_dbsm(), 7);
  EXPECT_EQ(target.swerling(), 2);
  EXPECT_EQ(target.length_m(), 20);
  of_server = true;
  EXPECT_EQ(message().type(), "jet");
  EXPECT_FALSE(message().has_rcs_dbsm());
  state.marking.clear();
  EXPECT_EQ(message().name(), "1:2:1");
}

TEST_F(EntityTargets, MoveAlongTheirOwnNorthEastAndUp) {
  // By differences of places: M and N, the radii of curvature of WGS84.
  const wire::Target target = message();
  const double t = 0.01;
  const Place before = place_of(state.location_m - t * state.velocity_m_s),
              after = place_of(state.location_m + t * state.velocity_m_s);
  const double square = 0.00669437999014, sine = std::sin(33.0 * kDegree);
  const double n = 6378137.0 / std::sqrt(1 - square * sine * sine);
  const double m = n * (1 - square) / (1 - square * sine * sine);
  EXPECT_NEAR(target.velocity_north_m_s(),
              (after.latitude_deg - before.latitude_deg) * kDegree * (m + 2000) / (2 * t), 1e-4);
  EXPECT_NEAR(target.velocity_east_m_s(),
              (after.longitude_deg - before.longitude_deg) * kDegree * (n + 2000) * std::cos(33.0 * kDegree) /
                  (2 * t),
              1e-4);
  EXPECT_NEAR(target.velocity_up_m_s(), (after.height_m - before.height_m) / (2 * t), 1e-4);
}

TEST_F(EntityTargets, AreWhereTheServerShowsThem) {
  // A straight line of the earth's frame is one of the server's, where datum and ellipsoid are one.
  heights.undulation_m = 0;
  TargetConfig config;
  config.target.is_timed = false;
  ASSERT_TRUE(merge_message(message(), {}, config).empty());
  for (const double t : {0.0, 1.0, 12.0}) {
    const auto shown = target_motion(config.target, t);
    ASSERT_TRUE(shown);
    const Place expected = place_of(reckoned(state, t).location_m);
    EXPECT_NEAR(shown->at.height_m, expected.height_m, 1e-6) << t;
    EXPECT_NEAR(glm::degrees(shown->at.latitude_rad), expected.latitude_deg, 1e-11) << t;
    EXPECT_NEAR(glm::degrees(shown->at.longitude_rad), expected.longitude_deg, 1e-11) << t;
  }
}

TEST_F(EntityTargets, TurnTheirNose) {
  state.dead_reckoning = 7;
  state.turn_rad_s = {0.02, 0.05, -0.04};
  const double slope = (message(1.001).heading_deg() - message(0.999).heading_deg()) / 0.002;
  EXPECT_NEAR(message(1).heading_rate_deg_s(), slope, 1e-3);
}

TEST_F(EntityTargets, OnTheGroundStandOnTheLoadedOne) {
  heights.on_ground = true;
  EXPECT_EQ(message().height_reference(), wire::ELLIPSOID) << "an aircraft";
  state.type.domain = 1;
  EXPECT_EQ(message().height_reference(), wire::GROUND);
  EXPECT_EQ(message().height_m(), 0);
  EXPECT_EQ(message().velocity_up_m_s(), 0);
}

TEST_F(EntityTargets, OutsideTheLimitsAreNone) {
  wire::Target target;
  const auto fits = [&](double after_s) {
    return write_target({state, reckoned(state, after_s)}, {&type, false, false}, heights, target);
  };
  state.velocity_m_s = {19999, 0, 0};
  EXPECT_TRUE(fits(0));
  state.acceleration_m_s2 = {5000, 0, 0};
  EXPECT_TRUE(fits(0));
  EXPECT_EQ(target.acceleration_north_m_s2(), 0) << "more than a target may have";
  EXPECT_FALSE(fits(12)) << "80 km/s";
}

}  // namespace
}  // namespace obliq::test::entity_target_test
