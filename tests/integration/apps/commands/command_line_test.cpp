// The obliq command as an operator meets it: exit codes, one line on stderr for each mistake.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

#include "tests/integration/daemon.h"

namespace obliq::test::command_line_test {
namespace {

std::string quoted(const std::string& argument) {
  std::string text = "'";
  for (const char c : argument) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

class CommandLine : public ProgramTest {
 protected:
  /// Runs obliq. `around`: an assignment of the environment, or a redirection, in the shell's words.
  Outcome obliq(const std::vector<std::string>& arguments, const std::string& environment = {},
                const std::string& out = "out") const {
    std::string line = environment + " " + quoted(OBLIQ_PROGRAM);
    for (const std::string& argument : arguments) line += " " + quoted(argument);
    line +=
        " >" + (out == "out" ? quoted(folder / "out") : out) + " 2>" + quoted(folder / "err") + " </dev/null";
    const int status = std::system(line.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status), text_of(folder / "out"),
            text_of(folder / "err")};
  }

  std::string scene(const std::string& text, const std::string& name = "scene.toml") const {
    return folder.write(name, text);
  }

  /// What `obliq render` says of a scene file; it renders nothing.
  Outcome check(const std::string& file, const std::vector<std::string>& more = {},
                const std::string& environment = {}) const {
    std::vector<std::string> arguments{"render", file, "--out", folder / "frame", "--check-config"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return obliq(arguments, environment);
  }
};

/// Refused: exit code 1, nothing on stdout, and on stderr lines that begin "obliq: ", one of them with
/// `part`.
void expect_refused(const Outcome& outcome, const std::string& part) {
  EXPECT_EQ(outcome.code, 1) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  EXPECT_NE(outcome.err.find(part), std::string::npos) << part << "\nin: " << outcome.err;
  std::stringstream lines(outcome.err);
  for (std::string line; std::getline(lines, line);) EXPECT_TRUE(line.starts_with("obliq: ")) << line;
}

constexpr auto kScene = "[terrain]\nsynthetic = \"flat\"\n";

TEST_F(CommandLine, HelpAndVersionSucceed) {
  for (const std::string flag : {"--help", "-h"}) {
    const Outcome help = obliq({flag});
    EXPECT_EQ(help.code, 0);
    EXPECT_NE(help.out.find("parameters"), std::string::npos);
    EXPECT_EQ(help.err, "");
  }
  const Outcome version = obliq({"--version"});  // tests/checks/version.sh: which commit it names
  EXPECT_TRUE(
      std::regex_match(version.out, std::regex("obliq \\d+\\.\\d+\\.\\d+(\\+g[0-9a-f]{7,40}(-dirty)?)?\n")))
      << version.out;
  EXPECT_EQ(version.code, 0);
  EXPECT_EQ(obliq({"parameters", "--help"}).code, 0);
}

TEST_F(CommandLine, WrongWordsAreRefused) {
  expect_refused(obliq({}), "found no command");
  expect_refused(obliq({"rendre"}), "rendre: an unknown command; did you mean render? (`obliq --help`");
  expect_refused(obliq({"rendr", "canyon.toml"}), "rendr: an unknown command; did you mean render?");
  expect_refused(obliq({"qqqqqqqq"}), "qqqqqqqq: an unknown command (`obliq --help` lists them)");
  expect_refused(obliq({"--colour"}), "--colour: an unknown option of `obliq`");
  expect_refused(obliq({"status", "--port", "17420"}),
                 "--port: an unknown option of `obliq status`; did you mean --server HOST:PORT?");
  expect_refused(obliq({"watch", "--rat=3"}),
                 "--rat=3: an unknown option of `obliq watch`; did you mean --rate?");
  expect_refused(obliq({"render", "a.toml", "b.toml"}), "found \"b.toml\" where nothing more is expected");
  expect_refused(obliq({"render"}), "found no scene file");
  expect_refused(obliq({"parameters", "--xml"}), "--xml");
  expect_refused(obliq({"parameters", ""}), "");
}

TEST_F(CommandLine, WhereTheServerIsCanBeSaidInSeveralWays) {
  const std::string says = "cannot connect to 127.0.0.1:1: Connection refused; start obliqd there";
  expect_refused(obliq({"status", "--server", ":1"}), says);
  expect_refused(obliq({"status", "1"}), says);
  expect_refused(obliq({"pose", "127.0.0.1:1"}), says);
  expect_refused(obliq({"status"}, "OBLIQ_SERVER=:1"), says);
  expect_refused(obliq({"set", "--server", "1"}, "OBLIQ_SERVER=:2"), says);
  expect_refused(obliq({"status", "[::1]:1"}), "cannot connect to [::1]:1: ");
  expect_refused(obliq({"status", "--server", "here:0"}),
                 "--server: found \"here:0\"; allowed: HOST:PORT, HOST, :PORT, PORT or [IPv6]:PORT");
}

TEST_F(CommandLine, AMissingFileIsNamedOnce) {
  const Outcome outcome =
      obliq({"render", scene("[terrain]\ndem = \"none.tif\"\n"), "--out", folder / "frame"});
  expect_refused(outcome, "none.tif: No such file or directory; allowed: a raster");
  EXPECT_EQ(outcome.err.find("none.tif"), outcome.err.rfind("none.tif")) << outcome.err;
}

TEST_F(CommandLine, AnAntennaUnderTheGroundIsToldHowToCountFromIt) {
  const std::string hill = "[terrain]\nsynthetic = \"flat\"\nshape = { base_m = 1500.0 }\n";
  const Outcome outcome = obliq({"render", scene(hill), "--out", folder / "frame"});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.err.find("antenna.height_reference = \"ground\" counts the height from there"),
            std::string::npos)
      << outcome.err;
}

TEST_F(CommandLine, AFileThatMayGrowNoFurtherIsAFailureWithASentence) {
  const Outcome outcome = obliq(
      {"render", scene(kScene), "--out", folder / "frame", "--set", "frustum.pixels=64"}, "ulimit -f 20;");
  EXPECT_EQ(outcome.code, 1) << outcome.err;
  EXPECT_NE(outcome.err.find("cannot be written"), std::string::npos) << outcome.err;
}

TEST_F(CommandLine, AFullDiskUnderStdoutIsAFailure) {
  const Outcome outcome = obliq({"parameters"}, "", "/dev/full");
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.err.find("standard output: cannot be written"), std::string::npos) << outcome.err;
}

TEST_F(CommandLine, ParametersAreListedWithUnitAndLimits) {
  const Outcome outcome = obliq({"parameters"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_NE(outcome.out.find("radar.sector_deg"), std::string::npos);
  EXPECT_NE(outcome.out.find("above 0, at most 360 deg"), std::string::npos);
}

TEST_F(CommandLine, AGoodSceneIsGoodAndPrintsAsASceneThatIsGood) {
  EXPECT_EQ(check(scene(kScene)).code, 0);
  const Outcome printed = obliq({"render", scene(kScene), "--out", folder / "frame", "--print-config"});
  ASSERT_EQ(printed.code, 0) << printed.err;
  const Outcome again =
      obliq({"render", scene(printed.out, "printed.toml"), "--out", folder / "frame", "--print-config"});
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(again.out.substr(again.out.find('\n')), printed.out.substr(printed.out.find('\n')));
  EXPECT_FALSE(std::filesystem::exists(folder / "frame"));
}

TEST_F(CommandLine, FlagsAndVariablesReachTheScene) {
  const auto print = [&](const std::vector<std::string>& more, const std::string& environment) {
    std::vector<std::string> arguments{"render", scene(kScene), "--out", folder / "frame", "--print-config"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return obliq(arguments, environment).out;
  };
  EXPECT_NE(print({"--set", "bins.range=77"}, "OBLIQ_BINS_RANGE=66").find("range = 77 "), std::string::npos);
  EXPECT_NE(print({"--set", "bins.azimuth=7"}, "OBLIQ_BINS_RANGE=66").find("range = 66 "), std::string::npos);
  EXPECT_NE(
      print({"--set", "frustum.kind=symmetric", "--set", "bins.azimuth=7"}, "").find("kind = \"symmetric\""),
      std::string::npos);
  expect_refused(check(scene(kScene), {"--set", "radar.r_max=9"}), "did you mean radar.r_max_m?");
  expect_refused(check(scene(kScene), {"--set", "nonsense"}), "KEY=VALUE");
  expect_refused(check(scene(kScene), {"--set"}), "--set");
  expect_refused(check(scene(kScene), {}, "OBLIQ_BINS_RANGE=zero"),
                 "environment OBLIQ_BINS_RANGE: bins.range: found zero");
}

TEST_F(CommandLine, TheSweepHasNoPixelsToWriteSamplesOf) {
  const Outcome outcome =
      obliq({"render", scene(kScene), "--out", folder / "frame", "--samples", "--set", "frustum.kind=sweep"});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(
      outcome.err.find("render: --samples: found frustum.kind = \"sweep\", which has no pixels; allowed: "
                       "\"symmetric\" or \"oblique\""),
      std::string::npos)
      << outcome.err;
}

TEST_F(CommandLine, FilesThatAreNoSceneAreRefusedWithFileLineKeyAndWhatIsAllowed) {
  expect_refused(check(folder / "missing.toml"), "missing.toml: cannot be read: No such file or directory");
  expect_refused(check(scene("")), "scene.toml: terrain: found neither dem nor synthetic");
  expect_refused(check(scene(std::string("[radar]\nsector_deg = 0\n") + kScene)),
                 "scene.toml:2: radar.sector_deg: found 0.0; allowed: number above 0, at most 360 deg");
}

}  // namespace
}  // namespace obliq::test::command_line_test
