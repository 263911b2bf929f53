// obliq replay --serve with TLS, tokens and roles: the daemon's options, and what each role may do.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <csignal>

#include "proto/error_number.h"
#include "proto/obliq.pb.h"
#include "tests/integration/clients.h"
#include "tests/integration/http_peer.h"
#include "tests/integration/record_fixture.h"
#include "tests/integration/test_certificate.h"
#include "tests/support/made_recording.h"

namespace obliq::test::protection_test {
namespace {

using wire::ErrorNumber;

class ReplayProtection : public RecordTest {
 protected:
  std::string secret(const std::string& name, const std::string& text) const {
    const std::string path = folder.write(name, text);
    EXPECT_EQ(chmod(path.c_str(), 0600), 0);
    return path;
  }
  static std::string token_of(const std::string& role) { return "replay-test-token-of-" + role; }
  std::string serve(const std::vector<std::string>& more) {
    std::vector<std::string> all{"replay", recording, "--serve", "--hold", "--port", "0"};
    all.insert(all.end(), more.begin(), more.end());
    replay = std::make_unique<Running>(all, folder / "replay.log");
    return replay->await(" on ");
  }
  std::vector<std::string> guarded() const {
    return {"--set", "server.tokens=" + tokens,
            "--set", "server.tls_certificate=" + own.certificate.string(),
            "--set", "server.tls_key=" + own.key.string()};
  }
  client::Status connect(client::Client& client, const std::string& address, const std::string& role,
                         bool tls = true) const {
    client::ClientOptions options{.name = role};
    if (!role.empty()) options.token = token_of(role);
    options.tls.enabled = tls;
    if (tls) options.tls.ca_file = own.certificate;
    return client.connect(*client::parse_endpoint(address), options);
  }
  static client::Status pause(client::Client& client) {
    wire::SetReplay request;
    request.set_paused(true);
    return client.set_replay(request);
  }
  static void expect_number(const client::Status& status, ErrorNumber number) {
    EXPECT_EQ(status.number, static_cast<std::uint32_t>(number)) << status.sentence();
  }
  Outcome refused(const std::vector<std::string>& more) const {
    return obliq({"replay", recording, "--serve", "--port", "0"}, more);
  }
  static void expect_says(const Outcome& outcome, const std::string& words) {
    EXPECT_EQ(outcome.code, 1);
    EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
  }

  std::string recording = folder.write("timed.obliq", timed_recording(200, 50'000'000).bytes);
  TestCertificate own = make_certificate(folder.path(), "own");
  std::string tokens = secret("tokens", "viewer " + token_of("viewer") + "\ncontroller " +
                                            token_of("controller") + "\nadmin " + token_of("admin") + "\n");
  std::unique_ptr<Running> replay;
};

TEST_F(ReplayProtection, EachRoleWatchesAndAControllerOrAdminSteers) {
  const std::string address = serve(guarded());
  ASSERT_NE(address, "") << replay->log();
  for (const auto& [role, steers] : {std::pair{"viewer", false}, {"controller", true}, {"admin", true}}) {
    SCOPED_TRACE(role);
    client::Client client;
    ASSERT_TRUE(is_ok(connect(client, address, role)));
    EXPECT_EQ(client.welcome().role(), role);
    ASSERT_TRUE(is_ok(client.subscribe("main", 20)));
    const client::Status paused = pause(client);
    if (steers) {
      EXPECT_TRUE(is_ok(paused));
    } else {
      expect_number(paused, ErrorNumber::role_too_low);
      EXPECT_FALSE(client.replay_state()->paused());
    }
    // Nobody changes what was recorded; a viewer is told first that it may not.
    expect_number(client.claim_control("main"),
                  steers ? ErrorNumber::replay_only : ErrorNumber::role_too_low);
  }
  EXPECT_EQ(replay->log().find("replay-test-token"), std::string::npos);
}

TEST_F(ReplayProtection, WithoutTlsOrWithoutAKnownTokenNobodyWatches) {
  const std::string address = serve(guarded());
  ASSERT_NE(address, "") << replay->log();
  client::Client plain, tokenless, unknown, careful;
  expect_number(connect(plain, address, "admin", false), ErrorNumber::tls_required);
  expect_number(connect(tokenless, address, ""), ErrorNumber::token_refused);
  expect_number(connect(unknown, address, "nobody"), ErrorNumber::token_refused);
  client::ClientOptions options{.name = "careful", .token = token_of("admin")};
  options.tls.enabled = true;  // and trusts this machine's authorities alone
  const client::Status untrusted = careful.connect(*client::parse_endpoint(address), options);
  EXPECT_NE(untrusted.sentence().find("is not trusted"), std::string::npos) << untrusted.sentence();
}

TEST_F(ReplayProtection, TheSceneFileOfTheDaemonProtectsItsDebriefAndItsPage) {
  const std::string scene_of_daemon = folder.write(
      "guarded.toml", text_of(SmallScene{.server = "tokens = \"tokens\"\ntls_certificate = \"own.pem\"\n"
                                                   "tls_key = \"own.key\"\nmax_clients = 3\n"
                                                   "[stream]\nlive_frames = 2\n"}));
  const std::string address = serve({"--config", scene_of_daemon});
  ASSERT_NE(address, "") << replay->log();
  client::Client client;
  ASSERT_TRUE(is_ok(connect(client, address, "viewer")));
  EXPECT_EQ(client.welcome().limits().max_clients(), 3u);
  const std::string page = replay->await("the picture in a browser: ");
  EXPECT_TRUE(page.starts_with("https://")) << page;
  const std::size_t colon = page.find(':', 8);
  const auto port = static_cast<std::uint16_t>(std::stoi(page.substr(colon + 1)));
  EXPECT_NE(http_get(port, "/healthz").status, 200) << "HTTP without TLS";
}

TEST_F(ReplayProtection, OffLoopbackItDoesNotStartWithoutTlsAndTokens) {
  const std::vector<std::string> everywhere{"--address", "0.0.0.0"};
  const Outcome bare = refused(everywhere);
  expect_says(bare, "server.address: found 0.0.0.0");
  expect_says(bare, "server.tls_certificate, server.tls_key");
  expect_says(bare, "server.tokens");
  expect_says(refused({"--set", "http.address=0.0.0.0", "--http-port", "0"}), "http.address: found 0.0.0.0");
  for (std::vector<std::string> allowed : {guarded(), std::vector<std::string>{"--unprotected"}}) {
    allowed.insert(allowed.end(), everywhere.begin(), everywhere.end());
    EXPECT_NE(serve(allowed), "") << replay->log();
  }
}

TEST_F(ReplayProtection, WhatDoesNotFitIsRefusedByName) {
  expect_says(refused({"--set", "server.tls_certificate=" + own.certificate.string()}),
              "server.tls_key: found nothing");
  expect_says(refused({"--set", "server.tokens=none"}), "none: ");
  expect_says(
      refused({"--set", "radar.r_max_m=5000"}),
      "--set: radar.r_max_m: found a key of another section; allowed: keys of [server], [stream] and");
  expect_says(refused({"--set", "server.token=x"}), "server.token");
  expect_says(refused({"--set", "server.max_clients=0"}), "server.max_clients: found 0");
  expect_says(refused({"--config", folder / "missing.toml"}), "missing.toml");
  const Outcome alone = obliq({"replay", recording, "--set", "server.port=0"});
  EXPECT_EQ(alone.code, 1);
  EXPECT_NE(alone.err.find("--serve"), std::string::npos) << alone.err;
}

TEST_F(ReplayProtection, AHangUpReadsTheTokensAgain) {
  const std::string address = serve(guarded());
  client::Client client;
  ASSERT_TRUE(is_ok(connect(client, address, "controller")));
  ASSERT_TRUE(is_ok(pause(client)));
  secret("tokens", "viewer " + token_of("viewer") + "\n");
  replay->send_signal(SIGHUP);
  client::Status status;
  do status = client.receive(kLong);
  while (status.ok());
  expect_number(status, ErrorNumber::token_refused);
  client::Client viewer;
  EXPECT_TRUE(is_ok(connect(viewer, address, "viewer")));
}

}  // namespace
}  // namespace obliq::test::protection_test
