// Claims of a radar's pose and settings: who may do what, one flies while another operates, and what becomes
// of where the antenna looks.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>
#include <map>
#include <sstream>

#include "proto/obliq.pb.h"
#include "server/net/rights.h"
#include "server/security/security.h"
#include "tests/integration/daemon.h"
#include "tests/integration/net_fixture.h"

namespace obliq::test::claims_test {
namespace {

using client::Status;
using wire::ClaimSet;
using wire::ErrorNumber;
using wire::kPoseClaim;
using wire::kSettingsClaim;

constexpr ClaimSet kNone = 0;
constexpr ClaimSet kBoth = kPoseClaim | kSettingsClaim;

/// What the server answers to each kind of request, as PROTOCOL.md's numbers; 0: done.
struct Answers {
  std::uint32_t move, aim, set, flip, reset;
  bool operator==(const Answers&) const = default;
  friend std::ostream& operator<<(std::ostream& out, const Answers& a) {
    return out << a.move << " " << a.aim << " " << a.set << " " << a.flip << " " << a.reset;
  }
};

Answers answers_to(client::Client& client) {
  wire::Ack ack;
  const auto number_of = [](const Status& status) { return status.ok() ? 0 : status.number; };
  return {number_of(client.set_pose("main", moved(), ack)),
          number_of(client.set_pose("main", tilted(-3), ack)),
          number_of(client.set_settings("main", {}, ack)),
          number_of(client.set_state("main", std::nullopt, std::nullopt)),
          number_of(client.reset_exercise("main"))};
}

/// One pair of what another client holds and what this one wants.
struct Pair {
  ClaimSet wanted, others;
  std::uint32_t claim;  ///< the answer; 0 also where nothing is wanted
  Answers then;         ///< to the requests after it
};
constexpr Pair kPairs[] = {
    {kNone, kNone, 0, {103, 103, 103, 103, 103}},
    {kNone, kPoseClaim, 0, {102, 102, 103, 103, 102}},
    {kNone, kSettingsClaim, 0, {103, 103, 102, 102, 102}},
    {kNone, kBoth, 0, {102, 102, 102, 102, 102}},
    {kPoseClaim, kNone, 0, {0, 0, 103, 103, 103}},
    {kPoseClaim, kPoseClaim, 102, {102, 102, 103, 103, 102}},
    {kPoseClaim, kSettingsClaim, 0, {0, 0, 102, 102, 102}},
    {kPoseClaim, kBoth, 102, {102, 102, 102, 102, 102}},
    {kSettingsClaim, kNone, 0, {103, 0, 0, 0, 103}},
    {kSettingsClaim, kPoseClaim, 0, {102, 0, 0, 0, 102}},
    {kSettingsClaim, kSettingsClaim, 102, {103, 103, 102, 102, 102}},
    {kSettingsClaim, kBoth, 102, {102, 102, 102, 102, 102}},
    {kBoth, kNone, 0, {0, 0, 0, 0, 0}},
    {kBoth, kPoseClaim, 102, {102, 102, 103, 103, 102}},
    {kBoth, kSettingsClaim, 102, {103, 103, 102, 102, 102}},
    {kBoth, kBoth, 102, {102, 102, 102, 102, 102}},
};

class Claims : public testing::Test {
 protected:
  net::ServerOptions options() {
    const std::string path =
        folder.write("tokens",
                     "viewer viewer-0123456789\ncontroller controller-0123456789\ncontroller "
                     "another-0123456789\nadmin admin-0123456789\n");
    EXPECT_EQ(chmod(path.c_str(), 0600), 0);
    net::ServerOptions made = small_options();
    made.security = std::make_shared<security::Security>(security::SecurityFiles{path, "", ""});
    return made;
  }
  client::Client come(const TestServer& server, const std::string& name) {
    client::Client made;
    EXPECT_TRUE(is_ok(made.connect(server.endpoint(), {.name = name, .token = name + "-0123456789"})));
    return made;
  }
  TestFolder folder;
};

TEST_F(Claims, EveryPairOfClaimsAndRolesIsAnsweredByTheTable) {
  const TestServer server(options());
  for (const std::string role : {"viewer", "controller", "admin"}) {
    for (const Pair& pair : kPairs) {
      SCOPED_TRACE(role + " wants " + wire::claim_names(pair.wanted) + ", another holds " +
                   wire::claim_names(pair.others));
      client::Client other = come(server, "another");
      client::Client client = come(server, role);
      if (pair.others != kNone) {
        ASSERT_TRUE(is_ok(other.claim("main", pair.others)));
      }
      if (role == "viewer") {
        EXPECT_EQ(client.claim("main", pair.wanted).number, 108u);
        EXPECT_EQ(answers_to(client), (Answers{108, 108, 108, 108, 108}));
        continue;
      }
      if (pair.wanted != kNone) {
        const Status claim = client.claim("main", pair.wanted);
        EXPECT_EQ(claim.ok() ? 0 : claim.number, pair.claim) << claim.sentence();
      }
      Answers expected = pair.then;
      if (role == "admin") expected.reset = 0;  // for any holder
      EXPECT_EQ(answers_to(client), expected);
      if (pair.wanted == kNone) continue;
      // Taken over, each by itself.
      const Status forced = client.claim("main", pair.wanted, true);
      const bool takes = (pair.wanted & pair.others) != 0;
      if (takes && role == "controller") {
        EXPECT_EQ(forced.number, 108u) << forced.sentence();
        continue;
      }
      ASSERT_TRUE(is_ok(forced));
      const Status told = takes ? other.receive(kLong) : Status{};
      const wire::RadarInfo info = info_of(other);
      const auto left = static_cast<ClaimSet>(pair.others & ~pair.wanted);
      ClaimSet still = 0;
      for (const int kind : info.claimed_by_you()) still |= claim_bit(*wire::claim_from_number(kind));
      EXPECT_EQ(still, left);
      if (!takes) continue;
      EXPECT_EQ(told.number, number(ErrorNumber::controlled_by_other));
      EXPECT_NE(told.text.find(wire::claim_names(pair.wanted & pair.others) + " taken over by admin"),
                std::string::npos)
          << told.text;
    }
  }
}

TEST_F(Claims, TheDocumentsTableIsTheCodes) {
  std::ifstream file(OBLIQ_PROTOCOL_DOCUMENT);
  std::map<std::string, std::string> written;
  for (std::string line; std::getline(file, line) && line != "| request | role | holds |";) {
  }
  std::string line;
  std::getline(file, line);  // the rule below the heads
  while (std::getline(file, line) && line.starts_with("|")) {
    std::istringstream cells(line.substr(1));
    std::string names, role, holds;
    std::getline(cells, names, '|');
    std::getline(cells, role, '|');
    std::getline(cells, holds, '|');
    std::istringstream each(names);
    for (std::string name; std::getline(each, name, ',');) {
      const std::size_t from = name.find_first_not_of(' ');
      written[name.substr(from, name.find_last_not_of(' ') + 1 - from)] = role + "/" + holds;
    }
  }
  std::map<std::string, std::string> built;
  for (const net::Right& right : net::rights()) {
    const std::string holds = wire::claim_names(right.claims) + (right.admin_always ? ", or admin" : "");
    built[std::string(right.name)] =
        " " + std::string(role_name(right.role)) + " / " + holds + (holds.empty() ? "" : " ");
  }
  EXPECT_EQ(written, built);
}

TEST_F(Claims, AClientThatNamesNoneClaimsBothAndIsRefusedWhereAnotherHoldsEither) {
  const TestServer server;
  for (const ClaimSet held : {kPoseClaim, kSettingsClaim}) {
    client::Client holder = connect(server, "holder");
    client::Client old = connect(server, "old");
    ASSERT_TRUE(is_ok(holder.claim("main", held)));
    const Status refused = old.claim_control("main");
    EXPECT_EQ(refused.number, 102u);
    EXPECT_NE(refused.text.find(wire::claim_names(held)), std::string::npos) << refused.text;
    EXPECT_NE(refused.text.find("held by holder"), std::string::npos) << refused.text;
    ASSERT_TRUE(is_ok(holder.release_control("main")));
    ASSERT_TRUE(is_ok(old.claim_control("main")));
    const wire::RadarInfo info = info_of(old);
    EXPECT_TRUE(info.controlled_by_you());
    EXPECT_EQ(info.controller(), info.settings_controller());
    EXPECT_EQ(info.claimed_by_you_size(), 2);
    EXPECT_EQ(answers_to(old), (Answers{0, 0, 0, 0, 0}));
    EXPECT_TRUE(is_ok(old.release_control("main")));
  }
}

TEST_F(Claims, InfoAndStatusNameBothHolders) {
  const TestServer server;
  client::Client host = connect(server, "host");
  client::Client hand = connect(server, "hand");
  ASSERT_TRUE(is_ok(host.claim("main", kPoseClaim)));
  ASSERT_TRUE(is_ok(hand.claim("main", kSettingsClaim)));
  const wire::RadarInfo info = info_of(hand);
  EXPECT_EQ(info.controller(), host.welcome().client_name());
  EXPECT_EQ(info.settings_controller(), hand.welcome().client_name());
  EXPECT_FALSE(info.controlled_by_you());
  const wire::Status status = status_of(hand);
  EXPECT_EQ(status.radars(0).controller(), host.welcome().client_name());
  EXPECT_EQ(status.radars(0).settings_controller(), hand.welcome().client_name());
  // Each goes by itself, by a release or by leaving.
  EXPECT_TRUE(is_ok(host.release("main", kPoseClaim)));
  EXPECT_EQ(host.release("main", kSettingsClaim).number, 102u);
  EXPECT_EQ(info_of(hand).controller(), "");
  hand.close();
  while (!info_of(host).settings_controller().empty()) {
  }
}

TEST_F(Claims, AKindThatThereIsNotIsNamed) {
  const TestServer server;
  RawPeer peer(server);
  peer.send(hello_bytes());
  wire::ClaimControl claim;
  claim.set_request_id(7);
  claim.set_radar("main");
  claim.add_kinds(wire::POSE_CLAIM);
  claim.add_kinds(static_cast<wire::ClaimKind>(9));
  peer.send(wire::encode_message(wire::MessageType::claim_control, {}, claim));
  wire::Error error;
  ASSERT_TRUE(peer.await(wire::MessageType::error, error));
  EXPECT_EQ(error.number(), 100u);
  ASSERT_EQ(error.fields_size(), 1);
  EXPECT_EQ(error.fields(0).field(), "kinds");
  EXPECT_EQ(error.fields(0).found(), "9");
  client::Client witness = connect(server);
  EXPECT_EQ(info_of(witness).controller(), "") << "all or nothing";
}

}  // namespace
}  // namespace obliq::test::claims_test
