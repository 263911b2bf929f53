// What PDUs of DIS mean, and which bytes are none.
#include "server/apps/dis/entity_state.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <limits>

#include "server/apps/dis/ownship.h"
#include "server/apps/dis/pdu_clock.h"
#include "tests/unit/apps/dis/dis_fixture.h"

namespace obliq::test::entity_state_test {
namespace {

using Bytes = std::vector<std::byte>;

EntityState state_of(const Bytes& bytes) {
  const Pdu pdu = read_pdu(bytes);
  if (const auto* none = std::get_if<NoPose>(&pdu)) {
    ADD_FAILURE() << none->why;
    return {};
  }
  return std::get<EntityState>(pdu);
}

std::string why_not(const Bytes& bytes) {
  const Pdu pdu = read_pdu(bytes);
  const auto* none = std::get_if<NoPose>(&pdu);
  return none == nullptr ? "taken" : none->why;
}

Bytes with(std::size_t at, std::string_view hex) {
  Bytes bytes = entity_bytes();
  const Bytes other = bytes_of(hex);
  std::ranges::copy(other, bytes.begin() + static_cast<std::ptrdiff_t>(at));
  return bytes;
}

TEST(EntityStatePdu, FieldsAreWhereAnotherImplementationPutsThem) {
  const EntityState state = state_of(entity_bytes());
  EXPECT_EQ(state.exercise, 42);
  EXPECT_EQ(state.timestamp, 0x951ae0ffu);
  EXPECT_EQ(state.id, (EntityId{11, 22, 33}));
  EXPECT_EQ(state.force, 2);
  EXPECT_EQ(text_of(state.type), "1.2.225.85.11.7.3");
  EXPECT_EQ(state.velocity_m_s, glm::dvec3(250, -3.5, 1.25));
  EXPECT_LT(glm::distance(state.location_m, earth_centred(36.41, -107.58, 2500.0)), 1e-6);
  EXPECT_TRUE(state.frozen);
  EXPECT_TRUE(state.active);
  EXPECT_EQ(state.dead_reckoning, 4);
  EXPECT_EQ(state.acceleration_m_s2, glm::dvec3(1.5, 2.5, -0.5));
  EXPECT_EQ(state.marking, "OWL 7");
  // The nose by psi and theta; the turn, which is along the body's axes, by its length.
  EXPECT_NEAR(state.body.nose.x, std::cos(-0.25) * std::cos(0.5), 1e-12);
  EXPECT_NEAR(state.body.nose.y, std::cos(-0.25) * std::sin(0.5), 1e-12);
  EXPECT_NEAR(state.body.nose.z, -std::sin(-0.25), 1e-12);
  EXPECT_NEAR(glm::dot(state.turn_rad_s, state.body.nose), 0.01, 1e-8);
  EXPECT_NEAR(glm::dot(state.turn_rad_s, state.body.right), -0.02, 1e-8);
  EXPECT_NEAR(glm::dot(state.turn_rad_s, state.body.below), 0.03, 1e-8);
}

TEST(EntityStatePdu, MotionAlongTheBodyIsTurnedIntoTheEarthsAxes) {
  for (const char* algorithm : {"06", "07", "08", "09"}) {
    const EntityState state = state_of(with(88, algorithm));
    EXPECT_NEAR(glm::dot(state.velocity_m_s, state.body.nose), 250, 1e-9);
    EXPECT_NEAR(glm::dot(state.velocity_m_s, state.body.right), -3.5, 1e-9);
    EXPECT_NEAR(glm::dot(state.acceleration_m_s2, state.body.below), -0.5, 1e-9);
  }
}

TEST(EntityStatePdu, ItsVersionsFiveToSevenAreAlike) {
  for (const char* version : {"05", "06", "07"}) EXPECT_EQ(state_of(with(0, version)).marking, "OWL 7");
  EXPECT_EQ(why_not(with(0, "04")), "protocol version: found 4; allowed: 5 to 7");
  EXPECT_EQ(why_not(with(0, "08")), "protocol version: found 8; allowed: 5 to 7");
}

TEST(EntityStatePdu, ADeactivatedOneHasLeft) { EXPECT_FALSE(state_of(with(84, "00800000")).active); }

TEST(EntityStatePdu, AMarkingIsWhatOfItCanBePrinted) {
  EXPECT_EQ(state_of(with(129, "1b41ff42200a2020202020")).marking, "AB");
  EXPECT_EQ(state_of(with(129, "0000000000000000000000")).marking, "");
  EXPECT_EQ(state_of(with(129, "4142434445464748494a4b")).marking, "ABCDEFGHIJK");
}

TEST(EntityStatePdu, WhatIsNoneIsToldWhy) {
  Bytes bytes = entity_bytes();
  for (const std::size_t size : {0U, 1U, 11U, 12U, 100U, 143U}) {
    const std::string why = why_not(Bytes(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)));
    EXPECT_EQ(why, "found " + std::to_string(size) + " bytes; allowed: 144 or more");
  }
  // Its articulations are cut.
  EXPECT_EQ(why_not(Bytes(bytes.begin(), bytes.end() - 1)), "length: found 160; allowed: 144 to 159");
  EXPECT_EQ(why_not(with(8, "0090")), "length: found 144 with 1 variable parameters; allowed: 160 or more");
  EXPECT_EQ(why_not(with(8, "0000")), "length: found 0; allowed: 144 to 160");
  EXPECT_EQ(why_not(with(8, "ffff")), "length: found 65535; allowed: 144 to 160");
  EXPECT_EQ(why_not(with(2, "17")), "PDU type: found 23; allowed: 1, Entity State, or 12 to 14");
}

TEST(EntityStatePdu, NumbersThatAreNoneAreRefused) {
  const std::string no_place = "location: found a point that is not near the earth";
  const std::string no_number =
      "velocity, acceleration, turn or orientation: found no number, or one that is too large";
  EXPECT_EQ(why_not(with(48, "000000000000000000000000000000000000000000000000")), no_place);
  EXPECT_EQ(why_not(with(48, "7ff8000000000000")), no_place);
  EXPECT_EQ(why_not(with(64, "7ff0000000000000")), no_place);
  EXPECT_EQ(why_not(with(56, "7fe0000000000000")), no_place);
  for (const std::size_t at : {36U, 44U, 72U, 76U, 80U, 104U, 116U, 124U}) {
    EXPECT_EQ(why_not(with(at, "7fc00000")), no_number) << at;
    EXPECT_EQ(why_not(with(at, "ff800000")), no_number) << at;
  }
  EXPECT_EQ(why_not(with(36, "46c35000")), no_number) << "25 km/s";
  EXPECT_NE(why_not(with(48, "000000000000000000000000000000000000000000000001")), "taken");
}

TEST(EntityStatePdu, LocationsComeBackToAMicrometre) {
  for (const double latitude : {-90.0, -60.25, -0.0, 1e-9, 33.0, 45.0, 89.9999, 90.0})
    for (const double longitude : {-180.0, -107.58, 0.0, 90.0, 179.999})
      for (const double height : {-400.0, 0.0, 2500.0, 30e3}) {
        const glm::dvec3 location_m = earth_centred(latitude, longitude, height);
        const Place at = place_of(location_m);
        EXPECT_NEAR(at.latitude_deg * kDegree * 6.4e6, latitude * kDegree * 6.4e6, 1e-6);
        EXPECT_NEAR(at.height_m, height, 1e-6);
        EXPECT_LT(glm::distance(location_of(at), location_m), 1e-6);
      }
}

TEST(SimulationOrders, AreReadAndMeanTheirReceiver) {
  Bytes stop = bytes_of("072a0e050000000100280000000100020003000b0016ffff");
  stop.resize(40);
  const Pdu pdu = read_pdu(stop);
  const auto& order = std::get<SimulationOrder>(pdu);
  EXPECT_EQ(order.what, SimulationOrder::What::stop);
  EXPECT_EQ(order.exercise, 42);
  EXPECT_EQ(order.receiver, (EntityId{11, 22, 65535}));
  EXPECT_TRUE(is_for(order.receiver, {11, 22, 33}));
  EXPECT_FALSE(is_for(order.receiver, {11, 23, 33}));
  EXPECT_TRUE(is_for({11, 22, 0}, {11, 22, 33}));
  EXPECT_TRUE(is_for({65535, 65535, 65535}, {11, 22, 33}));
  EXPECT_FALSE(is_for({11, 22, 34}, {11, 22, 33}));
  stop.resize(39);
  EXPECT_EQ(why_not(stop), "PDU of type 14: found 39 bytes and length 40; allowed: 40");
}

TEST(Datagrams, OfSeveralPdusAreTakenOneByOne) {
  const Bytes one = entity_bytes();
  Bytes three = one;
  three.insert(three.end(), one.begin(), one.end());
  three.insert(three.end(), one.begin(), one.end());
  std::span<const std::byte> rest = three;
  for (int k = 0; k < 3; ++k) EXPECT_EQ(take_pdu(rest).size(), one.size());
  EXPECT_TRUE(rest.empty());
  // What follows and is no PDU belongs to the one before.
  Bytes padded = one;
  padded.resize(one.size() + 40);
  rest = padded;
  EXPECT_EQ(take_pdu(rest).size(), padded.size());
  EXPECT_TRUE(rest.empty());
  EXPECT_EQ(state_of(padded).marking, "OWL 7");
}

TEST(PduClock, ReadsAbsoluteTimesAndBelievesThoseThatAreNear) {
  ASSERT_TRUE(seconds_past_the_hour(0x951ae0ff));
  EXPECT_NEAR(*seconds_past_the_hour(0x951ae0ff), 34 * 60 + 56.789, 2e-6);
  EXPECT_FALSE(seconds_past_the_hour(0x951ae0fe)) << "relative";
  using std::chrono::milliseconds;
  using std::chrono::seconds;
  const PduClock::Time arrived{seconds(1000)};
  const auto utc = [](double past_the_hour_s) {
    return PduClock::Utc(std::chrono::hours(490'000) +
                         milliseconds(static_cast<std::int64_t>(std::llround(1e3 * past_the_hour_s))));
  };
  const auto later_s = [&](PduClock& clock, std::uint32_t timestamp, double utc_s) {
    return std::chrono::duration<double>(clock.moment(timestamp, arrived, utc(utc_s)) - arrived).count();
  };
  PduClock absolute(true);
  EXPECT_NEAR(later_s(absolute, 0x951ae0ff, 2096.989), -0.2, 1e-5);
  EXPECT_NEAR(later_s(absolute, 0x951ae0ff, 2093.0), 3.789, 1e-5);
  EXPECT_NEAR(later_s(absolute, 0xffffffff, 0.25), -0.25, 1e-5) << "the hour has ended between";
  EXPECT_NEAR(later_s(absolute, 0x00000001, 3599.5), 0.5, 1e-5);
  EXPECT_EQ(absolute.arrivals(), 0u);
  EXPECT_EQ(later_s(absolute, 0x951ae0ff, 2102.0), 0) << "5.2 s apart";
  EXPECT_EQ(later_s(absolute, 0x951ae0fe, 2096.989), 0) << "relative";
  EXPECT_EQ(absolute.arrivals(), 2u);
  PduClock arrival(false);
  EXPECT_EQ(later_s(arrival, 0x951ae0ff, 2096.989), 0);
  EXPECT_EQ(arrival.arrivals(), 0u);
}

}  // namespace
}  // namespace obliq::test::entity_state_test
