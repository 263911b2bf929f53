#pragma once
// The real programs, run as an operator runs them.
#include <gtest/gtest.h>
#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace obliq::test {

struct Outcome {
  int code = -1;  ///< exit code; negative: killed by that signal
  std::string out;
  std::string err;
};

/// Runs a program to its end, its output captured in files of `folder`.
Outcome run_program(const std::string& program, const std::vector<std::string>& arguments,
                    const std::filesystem::path& folder);

/// `obliq` in the background. Killed, if it still runs, by the destructor.
class Running {
 public:
  /// Both its outputs go to `log`.
  Running(const std::vector<std::string>& arguments, std::filesystem::path log);
  ~Running();
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;

  /// Its exit code; negative: killed by that signal.
  int wait();
  int end(int signal);
  void send_signal(int signal) const;
  bool has_ended() const;
  std::string log() const;
  /// What follows `before` in its output, as soon as there is a line with it; empty when it ends before.
  std::string await(const std::string& before) const;

 private:
  std::filesystem::path log_;
  pid_t pid_ = -1;
};

/// An obliqd in the background. Killed, if it still runs, by the destructor.
class Daemon {
 public:
  /// Returns when it is ready (or its log holds `until`, if that is given), or has ended.
  Daemon(const std::vector<std::string>& arguments, const std::filesystem::path& folder,
         const std::string& until = "");
  ~Daemon();
  Daemon(const Daemon&) = delete;
  Daemon& operator=(const Daemon&) = delete;

  /// "127.0.0.1:PORT"; empty if it is not ready.
  const std::string& address() const { return address_; }
  std::string log() const;
  pid_t pid() const { return pid_; }
  void send_signal(int signal) const;
  /// Its exit code; negative: killed by that signal.
  int wait();

 private:
  std::filesystem::path log_;
  pid_t pid_ = -1;
  std::string address_;
};

/// A folder of its own for the running test, removed by the destructor.
class TestFolder {
 public:
  TestFolder();
  ~TestFolder();
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }
  std::string write(const std::string& name, const std::string& text) const;

 private:
  std::filesystem::path path_;
};

/// A test that runs the programs in a folder of its own.
class ProgramTest : public testing::Test {
 protected:
  /// `obliq` with these words and more of them.
  Outcome obliq(std::vector<std::string> words, const std::vector<std::string>& more = {}) const {
    words.insert(words.end(), more.begin(), more.end());
    return run_program(OBLIQ_PROGRAM, words, folder.path());
  }
  TestFolder folder;
};

std::string text_of(const std::filesystem::path& file);

constexpr const char* kFlat = "synthetic = \"flat\"\n";
constexpr const char* kRidge = "synthetic = \"ridge\"\nshape = { distance_m = 5000.0 }\n";
constexpr const char* kOneRadar = "[radar]\nr_min_m = 2000.0\nr_max_m = 9000.0\n";
constexpr const char* kTwoRadars = R"([[radar]]
name = "main"
sector_deg = 60.0
r_min_m = 2000.0
r_max_m = 9000.0
[[radar]]
name = "nose"
sector_deg = 90.0
r_min_m = 2000.0
r_max_m = 9000.0
)";

/// A scene that is small enough for any machine, and what those of the tests differ in.
struct SmallScene {
  std::string terrain = kRidge;    ///< lines of [terrain], further tables behind them
  std::string antenna = {};        ///< further lines of [antenna]
  std::string radars = kOneRadar;  ///< tables
  int pixels = 64;
  int azimuth_bins = 36;
  int range_bins = 32;
  std::string server = {};  ///< further lines of [server], further tables behind them
};
/// As a scene file has it.
std::string text_of(const SmallScene& scene);

}  // namespace obliq::test
