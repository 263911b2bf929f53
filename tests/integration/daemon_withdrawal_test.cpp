// SIGHUP reads tokens and certificate first and by themselves: who is shown the door goes, whatever else is
// wrong, and also while a scene is being built.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <csignal>
#include <thread>

#include "client/client.h"
#include "proto/error_number.h"
#include "proto/obliq.pb.h"
#include "tests/integration/daemon.h"

namespace obliq::test {
namespace {

constexpr client::Timeout kLong{20000};  // reached only when something is broken
constexpr const char* kStays = "token-of-one-who-stays";
constexpr const char* kGoes = "token-of-one-who-goes";

/// Seconds of work for one thread.
constexpr const char* kFineHills = "synthetic = \"hills\"\ncell_m = 5.0\nshape = { height_m = 300.0 }\n";

class Withdrawal : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(come(kStays, stays).ok()) << daemon.log();
    ASSERT_TRUE(come(kGoes, goes).ok()) << daemon.log();
  }
  client::Status come(const std::string& token, client::Client& made) const {
    return made.connect(*client::parse_endpoint(daemon.address()), {.name = "tester", .token = token});
  }
  std::string tokens_of(const std::vector<std::string>& names) const {
    std::string text;
    for (const std::string& token : names) text += "admin " + token + "\n";
    const std::string path = folder.write("tokens", text);
    EXPECT_EQ(chmod(path.c_str(), 0600), 0);
    return path;
  }
  void write_scene(const std::string& terrain, const std::string& more = "") const {
    folder.write("scene.toml", text_of(SmallScene{.terrain = terrain, .server = more}));
  }
  void withdraw() const {
    (void)tokens_of({kStays});
    daemon.send_signal(SIGHUP);
  }
  void expect_gone() {
    const client::Status told = goes.receive(kLong);
    EXPECT_EQ(told.number, static_cast<std::uint32_t>(wire::ErrorNumber::token_refused)) << daemon.log();
    client::Client again;
    EXPECT_FALSE(come(kGoes, again).ok());
    wire::RadarList list;
    EXPECT_TRUE(stays.list_radars(list).ok()) << daemon.log();
  }
  void await_log(const std::string& part) const {
    for (int i = 0; i < 2000 && daemon.log().find(part) == std::string::npos; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    EXPECT_NE(daemon.log().find(part), std::string::npos) << daemon.log();
  }

  TestFolder folder;
  std::string scene = folder.write("scene.toml", text_of(SmallScene{.terrain = kFlat}));
  Daemon daemon{{"--config", scene, "--set", "server.tokens=\"" + tokens_of({kStays, kGoes}) + "\""},
                folder.path()};
  client::Client stays;
  client::Client goes;
};

TEST_F(Withdrawal, HoldsWhereTheSceneFileHasATypo) {
  write_scene(kFlat, "max_clientz = 3\n");
  withdraw();
  expect_gone();
  await_log("reload refused");
  EXPECT_NE(daemon.log().find("(tokens were taken over)"), std::string::npos) << daemon.log();
}

TEST_F(Withdrawal, HoldsWhereTheAccuracyCannotBeMet) {
  write_scene(kRidge, "[accuracy]\nmax_power_error_db = 1e-9\n");
  withdraw();
  expect_gone();
  await_log("send SIGHUP again");
}

TEST_F(Withdrawal, HoldsWhereASceneIsBeingBuiltAndTheNewSignalSupersedesIt) {
  write_scene(kFineHills);
  daemon.send_signal(SIGHUP);
  await_log("tokens were taken over");
  write_scene(kFlat);
  withdraw();
  expect_gone();
  await_log("reloaded: the scene is the same");
  EXPECT_EQ(daemon.log().find("serving the new scene"), std::string::npos) << daemon.log();
}

TEST_F(Withdrawal, AFaultyTokenFileChangesNothingAndIsNamed) {
  (void)tokens_of({kStays});
  ASSERT_EQ(chmod((folder / "tokens").c_str(), 0644), 0);
  daemon.send_signal(SIGHUP);
  await_log("the old one stays in effect");
  EXPECT_NE(daemon.log().find("found mode 644"), std::string::npos) << daemon.log();
  wire::RadarList list;
  EXPECT_TRUE(goes.list_radars(list).ok());
  await_log("reloaded: the scene is the same");
}

}  // namespace
}  // namespace obliq::test
