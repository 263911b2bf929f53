// `obliq fly --dis --targets` against a real daemon: entities of a DIS exercise are the world's targets.
#include <gtest/gtest.h>

#include <bit>
#include <chrono>
#include <csignal>
#include <functional>
#include <thread>

#include "proto/obliq.pb.h"
#include "terrain/base/files.h"
#include "tests/integration/clients.h"
#include "tests/integration/daemon.h"
#include "tests/support/loopback.h"
#include "tests/unit/apps/dis/dis_fixture.h"

namespace obliq::test::fly_targets_test {
namespace {

using Bytes = std::vector<std::byte>;

template <typename Number>
void put(Bytes& bytes, std::size_t at, Number value) {
  auto raw = std::bit_cast<std::array<std::byte, sizeof(Number)>>(value);
  if constexpr (std::endian::native == std::endian::little) std::ranges::reverse(raw);
  std::ranges::copy(raw, bytes.begin() + static_cast<std::ptrdiff_t>(at));
}

struct Entity {
  std::uint16_t number = 1;
  DisEntityType type = {1, 1, 225, 7, 2, 0, 0};
  double latitude_deg = 33.02;
  std::array<float, 3> velocity_m_s = {0, 0, 0};
  std::uint32_t appearance = 0;
};

/// Of entity 11:22:number in exercise 42.
Bytes pdu_of(const Entity& entity) {
  Bytes bytes = entity_bytes();
  put(bytes, 16, entity.number);
  for (std::size_t at = 20; const std::uint8_t part : {entity.type.kind, entity.type.domain})
    put(bytes, at++, part);
  put(bytes, 22, entity.type.country);
  for (std::size_t at = 24; const std::uint8_t part : {entity.type.category, entity.type.subcategory,
                                                       entity.type.specific, entity.type.extra})
    put(bytes, at++, part);
  const glm::dvec3 location_m = earth_centred(entity.latitude_deg, -99.48, 1800.0);
  for (std::size_t k = 0; k < 3; ++k) {
    put(bytes, 36 + 4 * k, entity.velocity_m_s[k]);
    put(bytes, 48 + 8 * k, (&location_m.x)[k]);
  }
  put(bytes, 84, entity.appearance);
  put(bytes, 88, std::uint8_t{2});
  return bytes;
}

constexpr std::uint64_t kFirstId = (std::uint64_t{1} << 48) | (std::uint64_t{11} << 32) | (22 << 16);
constexpr std::uint32_t kDeactivated = 1u << 23;

class FlyTargets : public ProgramTest {
 protected:
  /// `obliq fly` that listens.
  std::unique_ptr<Running> fly(std::vector<std::string> words) {
    words.insert(words.begin(), {"fly", "--server", daemon.address(), "--udp", "0"});
    auto running = std::make_unique<Running>(words, folder / ("fly" + std::to_string(++flights_) + ".log"));
    const std::string port = running->await("listening on 127.0.0.1:");
    EXPECT_NE(port, "") << running->log();
    socket = UniqueFd(::socket(AF_INET, SOCK_DGRAM, 0));
    if (!port.empty()) connect_to_loopback(socket.get(), static_cast<std::uint16_t>(std::stoi(port)));
    return running;
  }
  void send(const Bytes& bytes) { EXPECT_GT(::send(socket.get(), bytes.data(), bytes.size(), 0), 0); }
  wire::TargetList targets() {
    wire::TargetList list;
    EXPECT_TRUE(is_ok(client.get_targets(list)));
    return list;
  }
  /// The world's targets, once they are so; as they are when that takes too long.
  wire::TargetList once(const std::function<bool(const wire::TargetList&)>& holds) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    for (;;) {
      wire::TargetList list = targets();
      if (holds(list) || std::chrono::steady_clock::now() > end) return list;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }
  wire::TargetList once_so_many(int count) {
    return once([&](const wire::TargetList& list) { return list.targets_size() == count; });
  }
  static std::string end(Running& running) {
    EXPECT_EQ(running.end(SIGINT), 0);
    return running.log();
  }

  Daemon daemon{
      {"--config",
       folder.write("scene.toml", text_of(SmallScene{.terrain = kFlat,
                                                     .radars = kTwoRadars,
                                                     .server = "[target_types.truck]\nrcs_dbsm = 14\n"
                                                               "swerling = 3\ndis = [\"1.1.*.7\"]\n"}))},
      folder.path()};
  client::Client client = connected(daemon.address());
  UniqueFd socket;

 private:
  int flights_ = 0;
};

TEST_F(FlyTargets, EntitiesAreTargetsOfTheirTypes) {
  const auto running = fly({"--dis", "--targets", "--undulation", "-30"});
  send(pdu_of({.number = 5, .velocity_m_s = {20, 0, 0}}));
  send(pdu_of({.number = 6, .type = {1, 2, 225, 1, 0, 0, 0}, .latitude_deg = 33.04}));
  send(pdu_of({.number = 7, .type = {7, 0, 225, 1, 0, 0, 0}}));  // a radio
  send(Bytes(7));
  const wire::TargetList list = once_so_many(2);
  ASSERT_EQ(list.targets_size(), 2);
  EXPECT_TRUE(list.controller().starts_with("obliq fly (127.0.0.1:")) << list.controller();
  ASSERT_EQ(list.types_size(), 1);
  ASSERT_EQ(list.types(0).dis_size(), 1);
  EXPECT_EQ(list.types(0).dis(0), "1.1.*.7");
  const wire::Target& truck = list.targets(0);
  EXPECT_EQ(truck.id(), kFirstId + 5);
  EXPECT_EQ(truck.name(), "OWL 7");
  EXPECT_EQ(truck.type(), "truck");
  EXPECT_EQ(truck.rcs_dbsm(), 14);
  EXPECT_EQ(truck.swerling(), 3);
  EXPECT_NEAR(truck.latitude_deg(), 33.02, 1e-4);
  EXPECT_EQ(truck.height_reference(), wire::ELLIPSOID);
  EXPECT_EQ(truck.geoid_undulation_m(), -30);
  EXPECT_NEAR(std::hypot(truck.velocity_north_m_s(), truck.velocity_east_m_s(), truck.velocity_up_m_s()), 20,
              1e-4);
  EXPECT_EQ(truck.valid_s(), 12);
  EXPECT_FALSE(truck.has_sim_time_ns()) << "no ownship: by arrival";
  const wire::Target& fighter = list.targets(1);
  EXPECT_EQ(fighter.id(), kFirstId + 6);
  EXPECT_EQ(fighter.type(), "");
  EXPECT_EQ(fighter.rcs_dbsm(), 8) << "of the shipped types";
  EXPECT_NEAR(fighter.latitude_deg(), 33.04, 1e-9);
  EXPECT_NEAR(fighter.height_m(), 1800, 1e-5);

  send(pdu_of({.number = 5, .appearance = kDeactivated}));
  EXPECT_EQ(once_so_many(1).targets(0).id(), kFirstId + 6);
  const std::string log = end(*running);
  EXPECT_NE(
      log.find(
          "targets: 1 entity, 1 PDUs of entities that no type has, 0 datagrams lost, 1 datagrams that were "
          "none, 4 PDUs understood\n"),
      std::string::npos)
      << log;
  EXPECT_NE(log.find("entities 7.0.225.1.0.0.0 are no targets"), std::string::npos) << log;
  EXPECT_NE(log.find("found 7 bytes"), std::string::npos) << log;
  EXPECT_EQ(targets().controller(), "");
  EXPECT_EQ(targets().targets_size(), 1) << "stays until its validity is over";
}

TEST_F(FlyTargets, AnOwnshipIsNoTargetAndHasTheTargetsClock) {
  const std::string types = folder.write(
      "types.toml",
      "[target_types.lorry]\nrcs_dbsm = 21\nlength_m = 9\nswerling = 1\ndis = \"1.1.225.7.2\"\n");
  const auto running =
      fly({"--radar", "main", "--dis", "11:22:33", "--exercise", "42", "--targets", "--types", types});
  send(pdu_of({.number = 33, .type = {1, 2, 225, 1, 0, 0, 0}, .latitude_deg = 33.01}));
  send(pdu_of({.number = 5}));
  Bytes other = pdu_of({.number = 6});
  put(other, 1, std::uint8_t{41});  // of another exercise
  send(other);
  const wire::TargetList list = once_so_many(1);
  ASSERT_EQ(list.targets_size(), 1);
  EXPECT_EQ(list.targets(0).id(), kFirstId + 5);
  EXPECT_EQ(list.targets(0).type(), "");
  EXPECT_EQ(list.targets(0).rcs_dbsm(), 21) << "--types' pattern says more than the scene's";
  EXPECT_EQ(list.targets(0).length_m(), 9);
  ASSERT_TRUE(list.targets(0).has_sim_time_ns());
  wire::RadarInfo info;
  ASSERT_TRUE(is_ok(client.get_radar("main", info)));
  EXPECT_NEAR(info.pose().latitude_deg(), 33.01, 1e-9);
  // One clock: both count from the command's start, a moment ago.
  EXPECT_LT(std::abs(1e-9 * static_cast<double>(info.pose().sim_time_ns() - list.targets(0).sim_time_ns())),
            20);
  const std::string log = end(*running);
  EXPECT_NE(log.find("targets: 1 entity\n"), std::string::npos) << log;
  EXPECT_NE(log.find(", 2 PDUs understood\n"), std::string::npos) << "of its exercise: " << log;
}

TEST_F(FlyTargets, OfTooManyTheNearestToTheRadarStay) {
  const auto running = fly({"--targets", "--most", "2"});
  for (std::uint16_t number = 1; number <= 4; ++number)
    send(pdu_of({.number = number, .latitude_deg = 34 - 0.1 * number}));
  const wire::TargetList list = once([](const wire::TargetList& now) {
    return now.targets_size() == 2 && now.targets(0).id() == kFirstId + 3 &&
           now.targets(1).id() == kFirstId + 4;
  });
  ASSERT_EQ(list.targets_size(), 2);
  EXPECT_EQ(list.targets(0).id(), kFirstId + 3);
  const std::string log = end(*running);
  EXPECT_NE(log.find("4 entities, 2 left out as too many"), std::string::npos) << log;
}

TEST_F(FlyTargets, WrongWordsAreNamed) {
  const auto refused = [&](std::vector<std::string> words, const std::string& said) {
    words.insert(words.begin(), {"fly", "--server", daemon.address()});
    const Outcome outcome = obliq(words);
    EXPECT_NE(outcome.code, 0);
    EXPECT_NE(outcome.err.find(said), std::string::npos) << said << "\nin: " << outcome.err;
  };
  refused({"--dis"}, "--dis: found no entity; allowed: SITE:APP:ENTITY, or --targets beside it");
  refused({"--targets", folder.write("track.csv", "0,33,-99,1000,0\n")},
          "TRACK and --udp, --dis or --targets");
  refused({"--targets", "--udp", "0", "--allow", "10.0.0.1/8"}, "--allow: found \"10.0.0.1/8\"");
  refused({"--targets", "--udp", "0", "--clock", "utc"}, "--clock");
  refused({"--targets", "--udp", "0", "--most", "0"}, "--most");
  const std::string bad =
      folder.write("bad.toml", "[target_types.x]\ndis = [\"1.1.300000\"]\nrcs_dbsm = 999\n");
  refused({"--targets", "--udp", "0", "--types", bad},
          "bad.toml:2: target_types.x.dis: found \"1.1.300000\"");
  refused({"--targets", "--udp", "0", "--types", bad}, "bad.toml:3: target_types.x.rcs_dbsm");
  refused({"--targets", "--udp", "0", "--types", folder.write("more.toml", "[radar]\nname = \"x\"\n")},
          "more.toml:1: radar: found an unknown key");
}

TEST_F(FlyTargets, DatagramsFromOtherNetworksAreNotTaken) {
  {
    const auto running = fly({"--targets", "--allow", "10.0.0.0/8"});
    send(pdu_of({}));
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    const std::string log = end(*running);
    EXPECT_NE(
        log.find(
            "targets: 0 entities, 0 datagrams lost, 1 datagrams from networks that --allow does not name"),
        std::string::npos)
        << log;
  }
  const auto running = fly({"--targets", "--allow", "10.0.0.0/8", "--allow", "127.0.0.1"});
  send(pdu_of({}));
  EXPECT_EQ(once_so_many(1).targets_size(), 1);
}

TEST_F(FlyTargets, WhatTheKernelDropsIsCounted) {
  const auto running = fly({"--targets"});
  running->send_signal(SIGSTOP);
  const Bytes pdu = pdu_of({});
  // More than any buffer that it is granted: 32 MiB hold some 44,000.
  constexpr int kSent = 150'000;
  for (int k = 0; k < kSent; ++k) send(pdu);
  running->send_signal(SIGCONT);
  // The count comes with the next datagram that finds room.
  const wire::TargetList list = once([&](const wire::TargetList& now) {
    send(pdu_of({.number = 2}));
    return now.targets_size() == 2;
  });
  EXPECT_EQ(list.targets_size(), 2);
  const std::string log = end(*running);
  const std::string before = "targets: 2 entities, ";
  const std::size_t at = log.rfind(before);
  ASSERT_NE(at, std::string::npos) << log;
  const int lost = std::stoi(log.substr(at + before.size()));
  EXPECT_GT(lost, 0) << log;
  EXPECT_LT(lost, kSent) << log;
}

TEST_F(FlyTargets, AServerThatComesBackHearsOfAllAgain) {
  const std::string address = daemon.address();
  const auto running = fly({"--targets", "--timeout", "600"});
  send(pdu_of({.number = 5}));
  ASSERT_EQ(once_so_many(1).targets_size(), 1);
  daemon.send_signal(SIGTERM);
  daemon.wait();
  const std::string port = address.substr(address.rfind(':') + 1);
  Daemon again({"--config", folder / "scene.toml", "--set", "server.port=" + port}, folder.path());
  ASSERT_EQ(again.address(), address);
  client = connected(address);
  const wire::TargetList list = once_so_many(1);
  ASSERT_EQ(list.targets_size(), 1);
  EXPECT_EQ(list.targets(0).id(), kFirstId + 5);
  EXPECT_EQ(end(*running).find("left out"), std::string::npos);
}

}  // namespace
}  // namespace obliq::test::fly_targets_test
