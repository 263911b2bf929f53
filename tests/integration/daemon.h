#pragma once
// The real programs, run as an operator runs them.
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

std::string text_of(const std::filesystem::path& file);

}  // namespace obliq::test
