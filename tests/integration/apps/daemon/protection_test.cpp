// obliqd and obliq with TLS and tokens, and what obliqd refuses to start with, end to end.
// What a frame may cost the commands that render, where nobody has set a limit.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>

#include <cstdlib>
#include <filesystem>

#include "tests/integration/daemon.h"
#include "tests/integration/http_peer.h"
#include "tests/integration/test_certificate.h"

namespace obliq::test::protection_test {
namespace {

constexpr const char* kScene = R"(
[terrain]
synthetic = "flat"
cell_m = 64.0
[antenna]
latitude_deg = 33.0
longitude_deg = -99.5
[frustum]
pixels = 32
[bins]
azimuth = 8
range = 16
[radar]
r_min_m = 2000.0
r_max_m = 4000.0
[server]
port = 0
)";

constexpr const char* kAdminToken = "daemon-test-admin-token";
constexpr const char* kViewerToken = "daemon-test-viewer-token";

class Protection : public ProgramTest {
 protected:
  std::string secret(const std::string& name, const std::string& text) const {
    const std::string path = folder.write(name, text);
    EXPECT_EQ(chmod(path.c_str(), 0600), 0);
    return path;
  }
  Outcome refused(const std::vector<std::string>& settings) const {
    return run_program(OBLIQD_PROGRAM, with(settings), folder.path());
  }
  std::vector<std::string> with(const std::vector<std::string>& settings) const {
    std::vector<std::string> arguments{"--config", scene};
    for (const std::string& setting : settings) arguments.insert(arguments.end(), {"--set", setting});
    return arguments;
  }
  static void expect_says(const Outcome& outcome, const std::string& words) {
    EXPECT_EQ(outcome.code, 1);
    EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
  }

  std::string scene = folder.write("scene.toml", kScene);
  TestCertificate own = make_certificate(folder.path(), "own");
  std::string tokens =
      secret("tokens", std::string("admin ") + kAdminToken + "\nviewer " + kViewerToken + "\n");
  std::string tls = "server.tls_certificate=\"" + own.certificate.string() + "\"";
  std::string key = "server.tls_key=\"" + own.key.string() + "\"";
  std::string guarded = "server.tokens=\"" + tokens + "\"";
};

TEST_F(Protection, WhatTheFirstStartMakesIsTakenByDaemonAndClientWithoutAWarning) {
  const std::string state = folder / "state";
  const Outcome made =
      run_program(OBLIQ_SOURCE_DIR "/deploy/first-start.sh", {state, "--name", "localhost"}, folder.path());
  if (made.err.find("is not installed") != std::string::npos) GTEST_SKIP() << made.err;
  ASSERT_EQ(made.code, 0) << made.err;
  const Daemon daemon(
      with({"server.tls_certificate=" + state + "/server/server.crt",
            "server.tls_key=" + state + "/server/server.key", "server.tokens=" + state + "/server/tokens"}),
      folder.path());
  ASSERT_NE(daemon.address(), "") << daemon.log();
  const Outcome status = obliq({"status", "--server", daemon.address(), "--tls", "--ca",
                                state + "/client/ca.crt", "--token-file", state + "/client/viewer.token"});
  EXPECT_EQ(status.code, 0) << status.err;
  EXPECT_EQ(status.err, "");
  // Prometheus runs as a user of its own and reads by its group.
  using std::filesystem::perms;
  EXPECT_EQ(std::filesystem::status(state + "/scrape/viewer.token").permissions(),
            perms::owner_read | perms::owner_write | perms::group_read);
}

TEST_F(Protection, OffLoopbackTheDaemonDoesNotStartWithoutTlsAndTokens) {
  const std::string everywhere = "server.address=\"0.0.0.0\"";
  const Outcome bare = refused({everywhere});
  expect_says(bare, "server.address: found 0.0.0.0");
  expect_says(bare, "server.tls_certificate, server.tls_key");
  expect_says(bare, "server.tokens");
  expect_says(bare, "server.unprotected = true");
  expect_says(refused({everywhere, tls, key}), "without tokens (server.tokens);");
  expect_says(refused({everywhere, guarded}), "without TLS (server.tls_certificate, server.tls_key);");
  for (const auto& settings : {std::vector{everywhere, tls, key, guarded},
                               std::vector{everywhere, std::string("server.unprotected=true")}}) {
    const Daemon daemon(with(settings), folder.path());
    EXPECT_NE(daemon.address(), "") << daemon.log();
  }
}

TEST_F(Protection, AStreamForOtherMachinesWithAPageForThisOneAloneIsWarnedOf) {
  const std::string words = "they reach neither the page nor its stream nor /metrics";
  const std::vector<std::string> everywhere{"server.address=\"0.0.0.0\"", tls, key, guarded, "http.port=0"};
  const auto log_with = [&](const std::string& more) {
    std::vector<std::string> settings = everywhere;
    settings.push_back(more);
    const Daemon daemon(with(settings), folder.path());
    EXPECT_NE(daemon.address(), "") << daemon.log();
    return daemon.log();
  };
  EXPECT_NE(log_with("http.address=\"127.0.0.1\"").find(words), std::string::npos);
  EXPECT_EQ(log_with("http.address=\"0.0.0.0\"").find(words), std::string::npos);
  EXPECT_EQ(log_with("http.enabled=false").find(words), std::string::npos);
}

TEST_F(Protection, FilesThatDoNotFitStopTheStartWithTheirNames) {
  expect_says(refused({tls}), "server.tls_key: found nothing");
  expect_says(refused({tls, "server.tls_key=\"none.key\""}), "none.key: No such file");
  EXPECT_EQ(chmod(tokens.c_str(), 0644), 0);
  expect_says(refused({guarded}), tokens + ": found mode 644");
  expect_says(refused({"server.max_radars=0"}), "server.max_radars");
  const std::string two = folder.write("two.toml",
                                       "[terrain]\nsynthetic = \"flat\"\n[[radar]]\nname = \"a\"\n"
                                       "[[radar]]\nname = \"b\"\n[server]\nmax_radars = 1\n");
  expect_says(run_program(OBLIQD_PROGRAM, {"--config", two}, folder.path()),
              "found 2 radars; allowed: at most 1 (server.max_radars)");
}

TEST_F(Protection, TheCommandsSpeakTlsAndShowTheirToken) {
  const Daemon daemon(with({tls, key, guarded}), folder.path());
  const std::string admin = secret("admin", std::string("# mine\n\n  ") + kAdminToken + " \n");
  const std::string viewer = secret("viewer", kViewerToken);
  const std::vector<std::string> server{"--server", daemon.address()};
  const auto run = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), server.begin(), server.end());
    return obliq(arguments);
  };
  const std::string ca = own.certificate;
  const Outcome plain = run({"status", "--token-file", admin});
  expect_says(plain, "this server speaks TLS only (obliq: --tls)");
  expect_says(run({"status", "--tls", "--token-file", admin}), "is not trusted");
  expect_says(run({"status", "--ca", ca}), "--ca: allowed with --tls");
  expect_says(run({"status", "--tls", "--ca", folder / "none"}), "no certificate could be read");
  expect_says(run({"status", "--tls", "--ca", ca}), "this server wants a token (obliq: --token-file)");
  expect_says(run({"status", "--tls", "--ca", ca, "--token-file", folder / "none"}), "cannot be read");
  expect_says(run({"pose", "--tls", "--ca", ca, "--token-file", viewer, "--bearing", "90"}),
              "needs the role controller");

  EXPECT_EQ(run({"status", "--tls", "--ca", ca, "--token-file", viewer}).code, 0);
  EXPECT_EQ(run({"watch", "--frames", "2", "--rate", "20", "--tls", "--ca", ca, "--token-file", viewer}).code,
            0);
  EXPECT_EQ(run({"get", "--out", folder / "frame", "--tls", "--ca", ca, "--token-file", viewer}).code, 0);
  const Outcome turned = run({"pose", "--tls", "--ca", ca, "--token-file", admin, "--bearing", "90"});
  EXPECT_EQ(turned.code, 0) << turned.err;
  setenv("OBLIQ_TOKEN_FILE", viewer.c_str(), 1);
  const Outcome by_variable = run({"status", "--tls", "--ca", ca});
  unsetenv("OBLIQ_TOKEN_FILE");
  EXPECT_EQ(by_variable.code, 0) << by_variable.err;

  EXPECT_EQ(daemon.log().find(kAdminToken), std::string::npos);
  EXPECT_EQ(daemon.log().find(kViewerToken), std::string::npos);
}

TEST_F(Protection, RelativePathsCountFromTheSceneFile) {
  const std::string here =
      folder.write("here.toml", std::string(kScene) +
                                    "tokens = \"tokens\"\ntls_certificate = \"own.pem\"\n"
                                    "tls_key = \"own.key\"\n");
  const Daemon daemon({"--config", here}, folder.path());
  EXPECT_NE(daemon.address(), "") << daemon.log();
}

using DaemonLimits = ProgramTest;

TEST_F(DaemonLimits, HoldForACommandThatRendersAsWell) {
  const std::string scene = folder.write("scene.toml", text_of(SmallScene{.terrain = kFlat}));
  const auto render = [&](const std::vector<std::string>& more) {
    return obliq({"render", scene, "--out", folder / "frame"}, more);
  };
  const Outcome refused =
      render({"--set", "bins.azimuth=1", "--set", "bins.range=8192", "--set", "frustum.pixel_columns=16384",
              "--set", "frustum.kind=sweep", "--set", "frustum.sub_columns=0"});
  EXPECT_EQ(refused.code, 1);
  EXPECT_NE(refused.err.find("server.max_memory_mb is "), std::string::npos) << refused.err;
  EXPECT_NE(refused.err.find("--set server.max_memory_mb=MB"), std::string::npos) << refused.err;
  EXPECT_EQ(render({"--set", "server.max_memory_mb=1"}).code, 1);
  EXPECT_EQ(render({"--set", "server.max_memory_mb=inf"}).code, 0);
}

}  // namespace
}  // namespace obliq::test::protection_test
