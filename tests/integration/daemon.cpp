#include "tests/integration/daemon.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <sstream>
#include <thread>
#include <utility>

namespace obliq::test {
namespace {

pid_t start(const std::string& program, const std::vector<std::string>& arguments,
            const std::filesystem::path& out, const std::filesystem::path& err) {
  std::vector<std::string> words = {program};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  setenv("OBLIQ_CACHE_DIR", "", 0);  // tests leave nothing in the user's cache
  const pid_t pid = fork();
  if (pid != 0) return pid;
  // In the child: only calls that are safe after a fork of a process with threads.
  const int out_fd = open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_APPEND, 0600);
  const int err_fd = open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_APPEND, 0600);
  dup2(out_fd, STDOUT_FILENO);
  dup2(err_fd, STDERR_FILENO);
  execv(program.c_str(), argv.data());
  _exit(127);
}

int exit_code(int status) { return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status); }

int wait_for(pid_t& pid) {
  int status = 0;
  waitpid(std::exchange(pid, -1), &status, 0);
  return exit_code(status);
}

bool has_ended(pid_t pid) {
  siginfo_t info{};
  return waitid(P_PID, static_cast<id_t>(pid), &info, WEXITED | WNOHANG | WNOWAIT) == 0 && info.si_pid != 0;
}

}  // namespace

std::string text_of(const std::filesystem::path& file) {
  std::stringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

Outcome run_program(const std::string& program, const std::vector<std::string>& arguments,
                    const std::filesystem::path& folder) {
  pid_t pid = start(program, arguments, folder / "out", folder / "err");
  const int code = wait_for(pid);
  return {code, text_of(folder / "out"), text_of(folder / "err")};
}

Running::Running(const std::vector<std::string>& arguments, std::filesystem::path log)
    : log_(std::move(log)), pid_(start(OBLIQ_PROGRAM, arguments, log_, log_)) {}

Running::~Running() {
  if (pid_ > 0) (void)end(SIGKILL);
}

int Running::wait() { return wait_for(pid_); }

void Running::send_signal(int signal) const { kill(pid_, signal); }

int Running::end(int signal) {
  send_signal(signal);
  return wait();
}

bool Running::has_ended() const { return test::has_ended(pid_); }

std::string Running::log() const { return text_of(log_); }

std::string Running::await(const std::string& before) const {
  for (;;) {
    const bool ended = has_ended();
    const std::string text = log();
    const std::size_t at = text.find(before);
    const std::size_t end = at == std::string::npos ? at : text.find('\n', at);
    if (end != std::string::npos) return text.substr(at + before.size(), end - at - before.size());
    if (ended) return {};
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

Daemon::Daemon(const std::vector<std::string>& arguments, const std::filesystem::path& folder,
               const std::string& until)
    : log_(folder / "obliqd.log") {
  std::filesystem::remove(log_);  // of an earlier one, which was ready at another address
  // Any free HTTP port, so that daemons of tests do not meet; a test's own words come later and win.
  std::vector<std::string> words = {"--set", "http.port=0"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  pid_ = start(OBLIQD_PROGRAM, words, folder / "obliqd.out", log_);
  const std::string on = " on ";
  for (;;) {
    const std::string text = log();
    if (!until.empty() && text.find(until) != std::string::npos) return;
    const std::size_t ready = text.find("ready: ");
    const std::size_t at = ready == std::string::npos ? ready : text.find(on, ready);
    const std::size_t end = at == std::string::npos ? at : text.find('\n', at);
    if (end != std::string::npos) {
      address_ = text.substr(at + on.size(), end - at - on.size());
      return;
    }
    if (has_ended(pid_)) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

Daemon::~Daemon() {
  if (pid_ < 0) return;
  send_signal(SIGKILL);
  (void)wait();
}

std::string Daemon::log() const { return text_of(log_); }

void Daemon::send_signal(int signal) const { kill(pid_, signal); }

int Daemon::wait() { return wait_for(pid_); }

TestFolder::TestFolder()
    : path_(std::filesystem::path(testing::TempDir()) /
            ("obliq_net_" + std::to_string(getpid()) + "_" +
             testing::UnitTest::GetInstance()->current_test_info()->name())) {
  std::filesystem::create_directories(path_);
}
TestFolder::~TestFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::string TestFolder::write(const std::string& name, const std::string& text) const {
  std::ofstream(path_ / name, std::ios::binary) << text;
  return path_ / name;
}

std::string text_of(const SmallScene& scene) {
  return "[terrain]\ncell_m = 64.0\n" + scene.terrain + "[antenna]\nheight_m = 1500.0\n" + scene.antenna +
         "[frustum]\npixels = " + std::to_string(scene.pixels) +
         "\n[bins]\nazimuth = " + std::to_string(scene.azimuth_bins) +
         "\nrange = " + std::to_string(scene.range_bins) + "\n" + scene.radars +
         "[http]\nport = 0\n[server]\nport = 0\n" + scene.server;
}

}  // namespace obliq::test
