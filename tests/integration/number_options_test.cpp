// Every option of obliq that is a number refuses what is none that can be meant, before anything else
// happens.
#include <gtest/gtest.h>

#include "tests/integration/daemon.h"

namespace obliq::test {
namespace {

struct NumberOption {
  std::string command;
  std::string option;
  std::string allowed;
  bool takes_zero = true;
};

const std::string kFrames = "a whole number from 0 to 1000000000000";
const std::string kSeconds = "a whole number from 0 to 86400";
const std::string kThreads = "a whole number from 0 to 1024";
const std::string kRate = "a number from 0.001 to 100";

const std::vector<NumberOption> kOptions = {
    {"get", "--wait", kSeconds},
    {"watch", "--rate", kRate, false},
    {"watch", "--frames", kFrames},
    {"watch", "--wait", kSeconds},
    {"watch", "--reconnect", kSeconds},
    {"record", "--rate", kRate, false},
    {"record", "--frames", kFrames},
    {"record", "--seconds", "a number from 0 to 1000000000"},
    {"record", "--reconnect", kSeconds},
    {"replay", "--frames", kFrames},
    {"replay", "--port", "a whole number from 0 to 65535"},
    {"replay", "--speed", "0.01 to 1000000 recorded seconds in a second, or max", false},
    {"cat240", "--rate", kRate, false},
    {"render", "--threads", kThreads},
    {"explain", "--threads", kThreads},
    {"frontier", "--threads", kThreads},
    {"frontier", "--azimuths", "a whole number from 0 to 8192"},
    {"frontier", "--pixels", "a whole number from 1 to 16384", false},
    {"frontier", "--cells", "a number from 0.03125 to 10000", false},
    {"frontier", "--repeats", "a whole number from 1 to 1000", false},
    {"frontier", "--truth-planes", "a whole number from 1 to 65536", false},
    {"frontier", "--truth-planes-limit", "a whole number from 1 to 65536", false},
    {"frontier", "--truth-step", "a number from 0.001 to 1000", false},
    {"frontier", "--stop-after", "a whole number from 0 to 100000"},
    {"health", "--timeout", "a number from 0.1 to 3600", false},
};

/// What else a command needs so that the option is what is wrong.
std::vector<std::string> line_of(const std::string& command, const std::string& option,
                                 const std::string& value) {
  std::vector<std::string> words = {command, option + "=" + value};
  if (command == "get" || command == "record") words.insert(words.end(), {"--out", "out"});
  if (command == "cat240") words.insert(words.end(), {"--to", "127.0.0.1:8600"});
  if (command == "health") words.insert(words.end(), {"--config", "none.toml"});
  if (command == "replay" || command == "render" || command == "explain" || command == "frontier") {
    words.emplace_back("none");
  }
  if (option == "--port") words.emplace_back("--serve");
  return words;
}

TEST(NumberOptions, RefuseWhatIsNoNumberWithTheirNameWhatWasFoundAndWhatIsAllowed) {
  const TestFolder folder;
  for (const NumberOption& option : kOptions) {
    std::vector<std::string> wrong = {"nan", "-1", "1e300"};
    if (!option.takes_zero) wrong.emplace_back("0");
    for (const std::string& value : wrong) {
      const Outcome outcome =
          run_program(OBLIQ_PROGRAM, line_of(option.command, option.option, value), folder.path());
      EXPECT_EQ(outcome.code, 1) << option.command << " " << option.option << " " << value;
      EXPECT_NE(outcome.err.find("obliq: " + option.option + ": found \"" + value +
                                 "\"; allowed: " + option.allowed),
                std::string::npos)
          << option.command << " " << option.option << " " << value << ": " << outcome.err;
    }
  }
}

TEST(NumberOptions, RefuseNothingInfinityAndWhatFollowsANumber) {
  const TestFolder folder;
  for (const std::string value : {"", "inf", "5x", " 5", "0x10"}) {
    for (const std::string option : {"--seconds", "--frames"}) {
      const Outcome outcome =
          run_program(OBLIQ_PROGRAM, {"record", "--out", "out", option, value}, folder.path());
      EXPECT_EQ(outcome.code, 1) << option << " " << value;
      EXPECT_NE(outcome.err.find("obliq: " + option + ": found \"" + value + "\"; allowed: "),
                std::string::npos)
          << outcome.err;
    }
  }
}

}  // namespace
}  // namespace obliq::test
