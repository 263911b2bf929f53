// `obliq save`, `load`, `reset` and `freeze` against a real daemon, and their file.
#include <gtest/gtest.h>

#include <fstream>

#include "proto/obliq.pb.h"
#include "tests/integration/clients.h"
#include "tests/integration/daemon.h"

namespace obliq::test::exercise_test {
namespace {

class ExerciseCommand : public ProgramTest {
 protected:
  Outcome obliq(const std::vector<std::string>& arguments) {
    return ProgramTest::obliq(arguments, {"--server", daemon.address()});
  }
  std::string state() {
    client::Client client = connected(daemon.address());
    wire::ExerciseState found;
    EXPECT_TRUE(is_ok(client.get_exercise(found)));
    return found.DebugString();
  }
  void disturb() {
    EXPECT_EQ(
        obliq({"set", "--radar", "nose", "radar.power_w=7", "receiver.noise_seed=-9", "--freeze", "on"}).code,
        0);
    EXPECT_EQ(obliq({"pose", "--radar", "main", "--bearing", "123.25", "--height", "1777"}).code, 0);
  }
  /// Refused, and nothing has changed.
  void expect_refused(const std::string& text, const std::string& part) {
    const std::string before = state();
    const Outcome outcome = obliq({"load", folder.write("bad.toml", text)});
    EXPECT_EQ(outcome.code, 1) << outcome.out;
    EXPECT_NE(outcome.err.find(part), std::string::npos) << part << "\nin: " << outcome.err;
    EXPECT_NE(outcome.err.find("bad.toml"), std::string::npos) << outcome.err;
    EXPECT_EQ(state(), before);
  }
  static std::string with(std::string text, const std::string& old, const std::string& fresh) {
    const std::size_t at = text.find(old);
    EXPECT_NE(at, std::string::npos) << old;
    return text.replace(at, old.size(), fresh);
  }

  Daemon daemon{{"--config", folder.write("scene.toml", text_of(SmallScene{.radars = kTwoRadars}))},
                folder.path()};
};

TEST_F(ExerciseCommand, WhatIsSavedIsLoadedAgainToTheBit) {
  disturb();
  const std::string saved = state();
  const Outcome outcome = obliq({"save", folder / "state.toml"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const std::string text = text_of(folder / "state.toml");
  EXPECT_NE(text.find("antenna.bearing_deg = 123.25\n"), std::string::npos) << text;
  EXPECT_NE(text.find("receiver.noise_seed = -9\n"), std::string::npos) << text;
  EXPECT_EQ(text.find("scene_hash = \"\""), std::string::npos) << "a scene that was loaded has one";
  ASSERT_EQ(obliq({"reset"}).code, 0);
  EXPECT_NE(state(), saved);
  const Outcome loaded = obliq({"load", folder / "state.toml"});
  ASSERT_EQ(loaded.code, 0) << loaded.err;
  EXPECT_EQ(state(), saved);
}

TEST_F(ExerciseCommand, AResetIsTheSceneFileAgainOfOneRadarOrOfAll) {
  const std::string initial = state();
  disturb();
  ASSERT_EQ(obliq({"reset", "--radar", "nose"}).code, 0);
  EXPECT_NE(state(), initial) << "main is where it was";
  ASSERT_EQ(obliq({"reset"}).code, 0);
  EXPECT_EQ(state(), initial);
}

TEST_F(ExerciseCommand, AFreezeIsSeenByAllAndEnds) {
  client::Client client = connected(daemon.address());
  wire::Status status;
  ASSERT_EQ(obliq({"freeze", "on"}).code, 0);
  ASSERT_TRUE(is_ok(client.get_status(status)));
  EXPECT_TRUE(status.exercise_frozen());
  ASSERT_EQ(obliq({"freeze", "off"}).code, 0);
  ASSERT_TRUE(is_ok(client.get_status(status)));
  EXPECT_FALSE(status.exercise_frozen());
  const Outcome wrong = obliq({"freeze", "perhaps"});
  EXPECT_EQ(wrong.code, 1);
  EXPECT_NE(wrong.err.find("perhaps"), std::string::npos) << wrong.err;
}

TEST_F(ExerciseCommand, AFileOfAnotherSceneOfALaterVersionOrCutIsRefusedAndChangesNothing) {
  ASSERT_EQ(obliq({"save", folder / "state.toml"}).code, 0);
  disturb();
  const std::string good = text_of(folder / "state.toml");
  const std::size_t hash = good.find("scene_hash = \"") + 14;
  expect_refused(with(good, good.substr(hash, 32), std::string(32, '0')), "scene_hash: found 00000000");
  expect_refused(with(good, "version = 1", "version = 2"), "exercise.version: found 2");
  expect_refused(with(good, "version = 1\n", ""), "exercise.version: found nothing");
  expect_refused(with(good, "antenna.tilt_deg = 0.0\n", ""), "antenna.tilt_deg: found nothing");
  expect_refused(with(good, "antenna.tilt_deg = 0.0\n", "antenna.tilt_deg = 100.0\n"),
                 "antenna.tilt_deg: found 100");
  expect_refused(with(good, "antenna.tilt_deg = 0.0\n", "antenna.tilt_deg = true\n"),
                 "antenna.tilt_deg: found true");
  expect_refused(with(good, "antenna.tilt_deg", "antenna.tilt_degrees"), "antenna.tilt_degrees");
  expect_refused(with(good, "name = \"nose\"", "name = \"tail\""), "nothing of nose");
  expect_refused("[exercise]\nversion = 1\n", "exercise.radars: found nothing");
  expect_refused("", "exercise.version: found nothing");
  expect_refused("this is no TOML", "bad.toml:1");
  // Cut behind any line it is refused; each takes a process, so every twentieth is.
  std::size_t lines = 0;
  for (std::size_t at = good.find('\n'); at + 1 < good.size(); at = good.find('\n', at + 1)) {
    if (lines++ % 20 != 0) continue;
    const Outcome outcome = obliq({"load", folder.write("bad.toml", good.substr(0, at + 1))});
    ASSERT_EQ(outcome.code, 1) << good.substr(0, at);
  }
  EXPECT_GT(lines, 100u);
}

TEST_F(ExerciseCommand, AServerThatReplaysHasNoExercise) {
  ASSERT_EQ(obliq({"record", "--out", folder / "recording.obliq", "--radar", "nose", "--frames", "1"}).code,
            0);
  Running replay({"replay", folder / "recording.obliq", "--serve", "--port", "0", "--hold"},
                 folder / "replay.log");
  const Outcome outcome =
      ProgramTest::obliq({"save", folder / "state.toml"}, {"--server", replay.await(" on ")});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.err.find("125"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace obliq::test::exercise_test
