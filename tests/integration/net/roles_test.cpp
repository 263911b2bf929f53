// Tokens and roles: who may come, who may do what, and that no token is ever written down.
// What the log says of connections: one line for who only asks, none for a pose, all of it for guests.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <sstream>
#include <thread>

#include "proto/obliq.pb.h"
#include "server/log/log.h"
#include "server/security/security.h"
#include "terrain/base/errors.h"
#include "tests/integration/daemon.h"
#include "tests/integration/net_fixture.h"
#include "tests/support/captured_log.h"

namespace obliq::test::roles_test {
namespace {

using client::Outcome;
using client::Status;
using wire::ErrorNumber;

constexpr const char* kViewer = "viewer-token-0123456789";
constexpr const char* kController = "controller-token-0123456789";
constexpr const char* kOther = "other-controller-0123456789";
constexpr const char* kAdmin = "admin-token#0123456789";

std::string all_tokens() {
  return std::string("# who may do what\n\nviewer ") + kViewer + "\ncontroller\t" + kController +
         "  console # the one in the hall\ncontroller " + kOther + "\nadmin " + kAdmin + " chief\r\n";
}

class Roles : public testing::Test {
 protected:
  std::string write(const std::string& text, mode_t mode = 0600) {
    const std::string path = folder.write("tokens", text);
    EXPECT_EQ(chmod(path.c_str(), mode), 0);
    return path;
  }
  net::ServerOptions options() {
    net::ServerOptions made = small_options();
    made.security =
        std::make_shared<security::Security>(security::SecurityFiles{write(all_tokens()), "", ""});
    return made;
  }
  static Status come(const TestServer& server, const std::string& token, client::Client& made) {
    return made.connect(server.endpoint(), {.name = "tester", .token = token});
  }
  /// What an operator is told.
  std::string complaint(const std::string& path) {
    try {
      const auto tokens = security::TokenFile::read(path);
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  }

  TestFolder folder;
};

TEST_F(Roles, WithoutATokenOrWithAWrongOneTheConnectionCloses) {
  const TestServer server(options());
  // A first message has at most 4096 bytes.
  const std::pair<std::string, ErrorNumber> wrong[] = {
      {"", ErrorNumber::token_refused},
      {"viewer-token-012345678", ErrorNumber::token_refused},
      {std::string(kViewer) + "9", ErrorNumber::token_refused},
      {std::string(3900, 'x'), ErrorNumber::token_refused},
      {std::string(100000, 'x'), ErrorNumber::bad_length}};
  for (const auto& [token, refusal] : wrong) {
    client::Client nobody;
    const Status status = come(server, token, nobody);
    EXPECT_EQ(status.outcome, Outcome::refused) << status.sentence();
    EXPECT_EQ(status.number, number(refusal)) << status.sentence();
    EXPECT_FALSE(nobody.is_open());
  }
}

TEST_F(Roles, AViewerMayLookAndRenderButNotClaim) {
  const TestServer server(options());
  client::Client viewer;
  ASSERT_TRUE(come(server, kViewer, viewer).ok());
  EXPECT_EQ(viewer.welcome().role(), "viewer");
  wire::RadarList list;
  EXPECT_TRUE(viewer.list_radars(list).ok());
  wire::RadarInfo info;
  EXPECT_TRUE(viewer.get_radar("main", info).ok());
  wire::Status status;
  EXPECT_TRUE(viewer.get_status(status).ok());
  EXPECT_TRUE(viewer.subscribe("main", 50).ok());
  client::FrameAssembler frames;
  EXPECT_TRUE(receive_frame(viewer, frames).ok());
  EXPECT_TRUE(viewer.unsubscribe("main").ok());
  wire::RenderOnce once = once_request();
  EXPECT_TRUE(viewer.render_once(once).ok());

  wire::Ack ack;
  const Status refused[] = {viewer.claim_control("main"),     viewer.claim_control("main", true),
                            viewer.release_control("main"),   viewer.set_settings("main", {}, ack),
                            viewer.set_pose("main", {}, ack), viewer.set_state("main", false, true)};
  for (const Status& answer : refused) {
    EXPECT_EQ(answer.number, number(ErrorNumber::role_too_low)) << answer.sentence();
    EXPECT_NE(answer.text.find("needs the role controller"), std::string::npos) << answer.text;
    EXPECT_NE(answer.text.find("gives viewer"), std::string::npos) << answer.text;
  }
  EXPECT_TRUE(viewer.list_radars(list).ok()) << "the connection stays";
}

TEST_F(Roles, AControllerMayClaimButNotTakeOverAndAnAdminMay) {
  const TestServer server(options());
  client::Client holder;
  client::Client other;
  client::Client admin;
  ASSERT_TRUE(come(server, kController, holder).ok());
  ASSERT_TRUE(come(server, kOther, other).ok());
  ASSERT_TRUE(come(server, kAdmin, admin).ok());
  ASSERT_TRUE(holder.claim_control("main").ok());
  EXPECT_EQ(other.claim_control("main").number, number(ErrorNumber::controlled_by_other));
  const Status refused = other.claim_control("main", true);
  EXPECT_EQ(refused.number, number(ErrorNumber::role_too_low));
  EXPECT_NE(refused.text.find("needs the role admin"), std::string::npos) << refused.text;
  EXPECT_EQ(admin.claim_control("main").number, number(ErrorNumber::controlled_by_other)) << "without force";

  wire::Ack ack;
  wire::Pose pose;
  pose.set_bearing_deg(10);
  EXPECT_TRUE(holder.set_pose("main", pose, ack).ok());
  ASSERT_TRUE(admin.claim_control("main", true).ok());
  // Told without having asked.
  const Status told = holder.receive(kLong);
  EXPECT_EQ(told.number, number(ErrorNumber::controlled_by_other)) << told.sentence();
  EXPECT_NE(told.text.find("taken over by " + admin.welcome().client_name()), std::string::npos) << told.text;
  EXPECT_EQ(holder.set_pose("main", pose, ack).number, number(ErrorNumber::controlled_by_other));
  EXPECT_TRUE(admin.set_pose("main", pose, ack).ok());
}

TEST_F(Roles, WithoutTokensEverybodyIsAdmin) {
  const TestServer server;
  client::Client first = connect(server);
  client::Client second;
  ASSERT_TRUE(come(server, "a token that nobody asked for", second).ok());
  ASSERT_TRUE(first.claim_control("main").ok());
  EXPECT_TRUE(second.claim_control("main", true).ok());
  EXPECT_EQ(second.welcome().role(), "admin");
}

TEST_F(Roles, NoTokenIsEverWrittenToTheLog) {
  const CapturedLog log;
  const std::string wrong = "wrong-token-0123456789";
  {
    const TestServer server(options());
    client::Client controller;
    client::Client admin;
    client::Client nobody;
    EXPECT_TRUE(come(server, kController, controller).ok());
    EXPECT_TRUE(come(server, kAdmin, admin).ok());
    EXPECT_FALSE(come(server, wrong, nobody).ok());
    EXPECT_TRUE(controller.claim_control("main").ok());
    EXPECT_TRUE(admin.claim_control("main", true).ok());
    write("viewer " + std::string(kViewer) + "\nadmin " + wrong + " short\nnothing " + kOther + "\n");
    EXPECT_NE(complaint(folder / "tokens"), "");
    log_error("{}", complaint(folder / "tokens"));  // as a reload would
  }
  const std::string text = log.text();
  EXPECT_NE(text.find("connected as controller with the token of console"), std::string::npos) << text;
  for (const std::string& token :
       {std::string(kViewer), std::string(kController), std::string(kOther), std::string(kAdmin), wrong}) {
    EXPECT_EQ(text.find(token), std::string::npos) << text;
    EXPECT_EQ(text.find(token.substr(0, 12)), std::string::npos) << text;
  }
}

TEST_F(Roles, AReloadWithdrawsTokensAndABadFileChangesNothing) {
  auto made = options();
  TestServer server(made);
  client::Client controller;
  client::Client viewer;
  ASSERT_TRUE(come(server, kController, controller).ok());
  ASSERT_TRUE(come(server, kViewer, viewer).ok());
  ASSERT_TRUE(controller.claim_control("main").ok());

  write("nonsense\n");
  EXPECT_NE(server.server().reload_security().tokens_fault, "");
  wire::RadarList list;
  EXPECT_TRUE(viewer.list_radars(list).ok());
  client::Client another;
  EXPECT_TRUE(come(server, kOther, another).ok()) << "the old tokens are in force";

  write("controller " + std::string(kViewer) + "\n");
  EXPECT_EQ(server.server().reload_security().tokens_fault, "");
  // The viewer became a controller, the controller nobody.
  const Status told = controller.receive(kLong);
  EXPECT_EQ(told.number, number(ErrorNumber::token_refused)) << told.sentence();
  EXPECT_TRUE(viewer.claim_control("nose").ok());
  client::Client late;
  EXPECT_FALSE(come(server, kOther, late).ok());
  // Back to viewer: what it controlled is free again.
  write("viewer " + std::string(kViewer) + "\nadmin " + kAdmin + "\n");
  EXPECT_EQ(server.server().reload_security().tokens_fault, "");
  const Status demoted = viewer.receive(kLong);
  EXPECT_EQ(demoted.number, number(ErrorNumber::role_too_low)) << demoted.sentence();
  client::Client admin;
  ASSERT_TRUE(come(server, kAdmin, admin).ok());
  EXPECT_TRUE(admin.claim_control("nose").ok()) << "without force";
}

TEST_F(Roles, WhoIsAControllerNoLongerCannotHoldARadarUpAnyLonger) {
  net::ServerOptions made = options();
  made.lossless_limit_s = 3600;
  TestServer server(made);
  client::Client admin;
  client::Client controller;
  ASSERT_TRUE(come(server, kAdmin, admin).ok());
  ASSERT_TRUE(come(server, kController, controller).ok());
  size_radar(admin, 400, 500);  // frames of 2 MB: some are held back whatever the kernel buffers
  wire::Subscribe request = request_at(100);
  request.set_lossless(true);
  ASSERT_TRUE(controller.subscribe(request).ok());  // and reads nothing
  const auto frames = [&] { return status_of(admin).radars(0).frames(); };
  std::uint64_t held = 0;
  for (std::uint64_t now = frames(); now == 0 || now != held; now = frames()) {  // until it stands still
    held = now;
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
  }
  write(std::string("viewer ") + kController + "\nadmin " + kAdmin + "\n");
  EXPECT_EQ(server.server().reload_security().tokens_fault, "");
  while (frames() < held + 20) std::this_thread::sleep_for(std::chrono::milliseconds(10));
}

TEST_F(Roles, WhoMayNotKnowWhereTargetsAreAnyLongerIsTold) {
  auto made = options();
  TestServer server(made);
  client::Client controller;
  ASSERT_TRUE(come(server, kController, controller).ok());
  wire::Subscribe request = request_at(100);
  request.set_truth(true);
  ASSERT_TRUE(controller.subscribe(request).ok());
  write(std::string("viewer ") + kController + "\nadmin " + kAdmin + "\n");
  EXPECT_EQ(server.server().reload_security().tokens_fault, "");
  Status told;
  for (int k = 0; k < 10'000 && told.ok(); ++k) told = controller.receive(kLong);
  EXPECT_EQ(told.number, number(ErrorNumber::role_too_low)) << told.sentence();
  EXPECT_NE(told.sentence().find("no longer has where targets are"), std::string::npos) << told.sentence();
}

TEST_F(Roles, ATokenFileThatOthersMayReadIsRefused) {
  for (const mode_t mode : {0640u, 0604u, 0660u, 0622u}) {
    const std::string said = complaint(write(all_tokens(), mode));
    EXPECT_NE(said.find("server.tokens: "), std::string::npos) << said;
    EXPECT_NE(said.find("chmod 600"), std::string::npos) << said;
  }
  EXPECT_EQ(complaint(write(all_tokens(), 0400)), "");
}

TEST_F(Roles, ATokenFileOfAnotherUserIsRefused) {
  const std::string path = write(all_tokens());
  if (chown(path.c_str(), 65534, static_cast<gid_t>(-1)) != 0)
    GTEST_SKIP() << "only root can give files away";
  const std::string said = complaint(path);
  EXPECT_NE(said.find("found the owner with uid 65534"), std::string::npos) << said;
}

TEST_F(Roles, WhatIsWrongInATokenFileIsSaidWithItsLineAndWithoutTheToken) {
  const struct {
    std::string text;
    std::string said;
  } cases[] = {
      {"", "found no token"},
      {"# nothing\n\n", "found no token"},
      {"viewer " + std::string(kViewer) + "\nking " + kAdmin + "\n", "line 2: the first word is no role"},
      {std::string(kAdmin) + " admin\n", "line 1: the first word is no role"},
      {"viewer 123456789012345\n", "line 1: found a token of 15 bytes; allowed: 16 to 256"},
      {"viewer " + std::string(257, 'x') + "\n", "found a token of 257 bytes"},
      {"viewer\n", "found a token of 0 bytes"},
      {"viewer tokens-with-umlauts-\xC3\xA4\n", "printable"},
      {"viewer " + std::string(kViewer) + " two names\n", "one printable name"},
      {"viewer " + std::string(kViewer) + "\nadmin " + kViewer + "\n", "line 2: this token is there twice"},
      {std::string("viewer 0123456789abcdef\0x\n", 26), "printable"},
  };
  for (const auto& [text, said] : cases) {
    const std::string found = complaint(write(text));
    EXPECT_NE(found.find(said), std::string::npos) << text << ": " << found;
    EXPECT_EQ(found.find(kAdmin), std::string::npos) << found;
    EXPECT_EQ(found.find(kViewer), std::string::npos) << found;
  }
  EXPECT_NE(complaint(folder / "none").find("No such file"), std::string::npos);
  EXPECT_NE(complaint(folder.path()).find("allowed: a file of tokens"), std::string::npos);
}

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
  EXPECT_NE(lines[2].find("radar main: pose and settings released by pilot"), std::string::npos) << lines[2];
}

}  // namespace
}  // namespace obliq::test::roles_test
