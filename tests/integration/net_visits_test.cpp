// What the log says of connections: one line for who only asks, none for a pose, all of it for guests.
#include <gtest/gtest.h>

#include <sstream>

#include "proto/obliq.pb.h"
#include "tests/integration/net_fixture.h"
#include "tests/support/captured_log.h"

namespace obliq::test {
namespace {

/// Lines of that level that name the client.
std::vector<std::string> lines_about(const std::string& client, const std::string& log,
                                     const std::string& level = "[info]") {
  std::vector<std::string> found;
  std::istringstream lines(log);
  for (std::string line; std::getline(lines, line);)
    if (line.find(level) != std::string::npos && line.find(client) != std::string::npos)
      found.push_back(line);
  return found;
}

/// Runs `visit` as a client of that name on a server of its own, and returns the log.
template <typename Visit>
std::string log_of(const std::string& name, Visit visit) {
  const CapturedLog log;
  {
    TestServer server;
    client::Client client = connect(server, name);
    visit(client);
    client.close();
    client::Client witness = connect(server, "witness");
    while (status_of(witness).clients() > 1) {
    }
  }
  return log.text();
}

TEST(Visits, WhoOnlyAsksIsOneLineWithNameAddressRequestsAndTime) {
  const std::string log = log_of("asker", [](client::Client& client) {
    wire::Status status;
    EXPECT_TRUE(client.get_status(status).ok());
    wire::RadarInfo info;
    EXPECT_TRUE(client.get_radar("main", info).ok());
  });
  const auto lines = lines_about("asker", log);
  ASSERT_EQ(lines.size(), 1u) << log;
  EXPECT_NE(lines[0].find("asker (127.0.0.1:"), std::string::npos) << lines[0];
  EXPECT_NE(lines[0].find("asked for GetRadar, GetStatus and disconnected after 0."), std::string::npos)
      << lines[0];
}

TEST(Visits, APoseIsNoLineButForTheLevelDebug) {
  const std::string log = log_of("poser", [](client::Client& client) {
    wire::Pose pose;
    pose.set_bearing_deg(10);
    wire::Ack ack;
    EXPECT_TRUE(client.claim_control("main").ok());
    EXPECT_TRUE(client.set_pose("main", pose, ack).ok());
    EXPECT_TRUE(client.release_control("main").ok());
  });
  EXPECT_TRUE(lines_about("poser", log).empty()) << log;
  EXPECT_EQ(lines_about("poser", log, "[debug]").size(), 4u) << "come, claimed, released, gone: " << log;
}

TEST(Visits, SettingsAreALineThatSaysSo) {
  const std::string log = log_of("setter", [](client::Client& client) {
    wire::Ack ack;
    EXPECT_TRUE(client.claim_control("main").ok());
    EXPECT_TRUE(client.set_settings("main", {}, ack).ok());
    EXPECT_TRUE(client.release_control("main").ok());
  });
  const auto lines = lines_about("setter", log);
  ASSERT_EQ(lines.size(), 1u) << log;
  EXPECT_NE(lines[0].find("SetSettings"), std::string::npos) << lines[0];
}

TEST(Visits, WhoWatchesOrFliesIsToldWhenHeComesAndWhenHeGoes) {
  std::string log =
      log_of("watcher", [](client::Client& client) { EXPECT_TRUE(client.subscribe("main", 50).ok()); });
  auto lines = lines_about("watcher", log);
  ASSERT_EQ(lines.size(), 2u) << log;
  EXPECT_NE(lines[0].find("connected as admin"), std::string::npos) << lines[0];
  EXPECT_NE(lines[1].find("disconnected"), std::string::npos) << lines[1];
  log = log_of("pilot", [](client::Client& client) {
    wire::Ack ack;
    EXPECT_TRUE(client.claim_control("main").ok());
    for (int i = 0; i < 5; ++i) EXPECT_TRUE(client.set_pose("main", {}, ack).ok());
    EXPECT_TRUE(client.release_control("main").ok());
  });
  lines = lines_about("pilot", log);
  ASSERT_EQ(lines.size(), 4u) << log;
  EXPECT_NE(lines[1].find("radar main: flown by pilot"), std::string::npos) << lines[1];
  EXPECT_NE(lines[2].find("radar main: released by pilot"), std::string::npos) << lines[2];
}

}  // namespace
}  // namespace obliq::test
