// obliqd as systemd, a container engine and an operator run it: notifications, signals, JSON lines, health.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <ctime>
#include <deque>
#include <mutex>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <thread>

#include "proto/obliq.pb.h"
#include "tests/integration/clients.h"
#include "tests/integration/daemon.h"
#include "tests/integration/http_peer.h"
#include "tests/support/loopback.h"

namespace obliq::test::operation_test {
namespace {

const std::string kScene = text_of(SmallScene{.terrain = "synthetic = \"ridge\"\n"});

std::string between(const std::string& text, const std::string& before, const std::string& after) {
  const std::size_t at = text.find(before);
  if (at == std::string::npos) return "";
  const std::size_t first = at + before.size();
  return text.substr(first, text.find(after, first) - first);
}

class DaemonOperation : public ProgramTest {
 protected:
  /// "127.0.0.1:PORT" of HTTP.
  static std::string http_address(const Daemon& daemon) { return between(daemon.log(), "HTTP on ", ": /"); }
  /// Whom the first JSON line with the words is about.
  static std::string client_of(const std::string& log, const std::string& words) {
    std::istringstream lines(log);
    for (std::string line; std::getline(lines, line);) {
      if (line.find(words) != std::string::npos) return nlohmann::json::parse(line).value("client", "nobody");
    }
    return "no such line";
  }
  static std::string http_port(const Daemon& daemon) { return std::to_string(port_of(http_address(daemon))); }
  Outcome health(const std::vector<std::string>& more) const {
    return obliq({"health", "--config", scene}, more);
  }

  std::string scene = folder.write("scene.toml", kScene);
};

/// Stands for systemd: a datagram socket that NOTIFY_SOCKET names while the object lives.
class NotifySocket {
 public:
  NotifySocket() : fd_(socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    // Abstract: a path of the test's folder may be too long for it.
    const std::string name = "obliq-notify-" + std::to_string(getpid());
    name.copy(address.sun_path + 1, sizeof address.sun_path - 1);
    const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
    EXPECT_EQ(bind(fd_, reinterpret_cast<const sockaddr*>(&address), length), 0);
    const timeval now_and_then{0, 100000};
    setsockopt(fd_, SOL_SOCKET, SO_RCVTIMEO, &now_and_then, sizeof now_and_then);
    setenv("NOTIFY_SOCKET", ("@" + name).c_str(), 1);
    setenv("WATCHDOG_USEC", "300000", 1);
    // From the start: a socket holds ten messages, and who sends one more waits, as the real manager's do.
    reader_ = std::jthread([this](const std::stop_token& stop) {
      char text[4096];
      while (!stop.stop_requested()) {
        const ssize_t n = recv(fd_, text, sizeof text, 0);
        if (n <= 0) continue;
        const std::scoped_lock lock(mutex_);
        heard_.emplace_back(text, static_cast<std::size_t>(n));
        changed_.notify_all();
      }
    });
  }
  ~NotifySocket() {
    unsetenv("NOTIFY_SOCKET");
    unsetenv("WATCHDOG_USEC");
    reader_ = {};
    close(fd_);
  }
  /// Everything from the last call up to and with the first message that holds `part`; empty when it does not
  /// come.
  std::string until(const std::string& part) {
    std::string all;
    std::unique_lock lock(mutex_);
    for (;;) {
      // The limit is reached only when something is broken.
      if (!changed_.wait_for(lock, std::chrono::seconds(20), [&] { return !heard_.empty(); })) return "";
      all += heard_.front() + "\n";
      heard_.pop_front();
      if (all.find(part) != std::string::npos) return all;
    }
  }

 private:
  int fd_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::string> heard_;
  std::jthread reader_;
};

TEST_F(DaemonOperation, SystemdHearsOfLoadingReadinessPulseReloadAndTheEnd) {
  NotifySocket systemd;
  Daemon daemon({"--config", scene}, folder.path());
  const std::string start = systemd.until("READY=1");
  EXPECT_NE(start.find("STATUS=loading: "), std::string::npos) << start;
  EXPECT_NE(start.find("STATUS=serving main on " + daemon.address()), std::string::npos) << start;
  for (int beat = 0; beat < 3; ++beat) EXPECT_NE(systemd.until("WATCHDOG=1"), "");
  daemon.send_signal(SIGHUP);
  EXPECT_NE(systemd.until("RELOADING=1").find("MONOTONIC_USEC="), std::string::npos);
  EXPECT_NE(systemd.until("READY=1"), "");
  daemon.send_signal(SIGTERM);
  EXPECT_NE(systemd.until("STOPPING=1"), "");
  EXPECT_EQ(daemon.wait(), 0);
}

TEST_F(DaemonOperation, EveryJsonLineIsAnObjectAndClientsAreNamed) {
  Daemon daemon({"--config", scene, "--set", "log.format=json", "--set", "log.level=debug"}, folder.path(),
                "ready: ");
  const std::string address = between(daemon.log().substr(daemon.log().find("ready: ")), " on ", "\"");
  {
    const client::Client odd = connected(address, "o\"dd}\n{\x1b");
    client::Client wrong;  // bytes that are no UTF-8 are refused; protobuf has its own words for that
    EXPECT_FALSE(wrong.connect(*client::parse_endpoint(address), {.name = "\xff"}).ok());
    HttpPeer no_client(port_of(address));
    no_client.send("GET / HTTP/1.1\r\n\r\n");
    EXPECT_TRUE(no_client.closed());
  }
  daemon.send_signal(SIGTERM);
  EXPECT_EQ(daemon.wait(), 0);
  std::istringstream lines(daemon.log());
  std::set<std::string> levels;
  bool refused = false;
  for (std::string line; std::getline(lines, line);) {
    const auto read = nlohmann::json::parse(line, nullptr, false);
    ASSERT_TRUE(read.is_object()) << line;
    EXPECT_EQ(read["time"].get<std::string>().size(), 27u) << line;  // 2026-11-20T12:00:00.123456Z
    levels.insert(read["level"].get<std::string>());
    refused = refused || (read.contains("error") && read["error"] == 1 &&
                          read["client"].get<std::string>().rfind("127.0.0.1:", 0) == 0);
  }
  EXPECT_TRUE(refused) << "what sent no obliq bytes is logged with error number and address: "
                       << daemon.log();
  EXPECT_TRUE(levels.contains("info") && levels.contains("warning")) << daemon.log();
}

TEST_F(DaemonOperation, HealthIsExitCodeZeroOnlyWhileItAnswers) {
  Daemon daemon({"--config", scene}, folder.path());
  const std::string port = "http.port=" + http_port(daemon);
  const Outcome alive = health({"--set", port});
  EXPECT_EQ(alive.code, 0) << alive.err;
  EXPECT_EQ(alive.out.rfind("healthy: http://127.0.0.1:", 0), 0u) << alive.out;
  EXPECT_EQ(health({"--set", port, "--ready"}).code, 0);
  daemon.send_signal(SIGTERM);
  EXPECT_EQ(daemon.wait(), 0);
  for (const auto& arguments :
       {std::vector<std::string>{"--set", port}, {"--set", "http.enabled=false"}, {}}) {
    const Outcome gone = health(arguments);
    EXPECT_EQ(gone.code, 1);
    EXPECT_EQ(std::count(gone.err.begin(), gone.err.end(), '\n'), 1) << gone.err;
  }
}

TEST_F(DaemonOperation, HealthTellsLoadingFromReady) {
  // Fifty million posts: seconds of loading, of which the question comes in the first.
  const Daemon daemon({"--config", scene, "--set", "terrain.synthetic=hills", "--set", "terrain.cell_m=2.5"},
                      folder.path(), "loading terrain");
  const std::string port = "http.port=" + http_port(daemon);
  EXPECT_EQ(health({"--set", port}).code, 0);
  const Outcome loading = health({"--set", port, "--ready"});
  EXPECT_EQ(loading.code, 1);
  EXPECT_NE(loading.err.find("answered 503 loading: "), std::string::npos) << loading.err;
}

/// Says this to the first client, whatever that asks, and closes.
class SaysOnce {
 public:
  explicit SaysOnce(std::string text) : listening_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    port_ = bind_to_loopback(listening_);
    EXPECT_EQ(listen(listening_, 1), 0);
    speaker_ = std::jthread([this, text = std::move(text)] {
      const int peer = accept(listening_, nullptr, nullptr);
      char question[1024];
      EXPECT_GT(read(peer, question, sizeof question), 0);
      EXPECT_EQ(send(peer, text.data(), text.size(), MSG_NOSIGNAL), static_cast<ssize_t>(text.size()));
      close(peer);
    });
  }
  ~SaysOnce() {
    shutdown(listening_, SHUT_RDWR);  // where no client connected
    speaker_.join();
    close(listening_);
  }
  SaysOnce(const SaysOnce&) = delete;
  SaysOnce& operator=(const SaysOnce&) = delete;
  std::string port() const { return std::to_string(port_); }

 private:
  int listening_;
  std::uint16_t port_ = 0;
  std::jthread speaker_;
};

TEST_F(DaemonOperation, HealthBelievesNoHalfAnswer) {
  const std::string headers = "HTTP/1.1 200 OK\r\n";
  for (const auto& [said, why] : {std::pair<std::string, std::string>{"", "end of stream"},
                                  {"HTTP/1.1 20", "partial message"},
                                  {headers + "Content-Length: 50\r\n\r\nok", "partial message"},
                                  {headers + "Transfer-Encoding: chunked\r\n\r\n2\r\nok", "partial message"},
                                  {headers + "\r\n" + std::string(70'000, 'x'), "body limit exceeded"},
                                  {headers + "Content-Length: 1000000000000000\r\n\r\nok", "partial message"},
                                  {headers + "X: " + std::string(30'000, 'x'), "header limit exceeded"},
                                  {"220 this is no web server\r\n\r\n", "bad version"}}) {
    const SaysOnce peer(said);
    const Outcome outcome = health({"--set", "http.port=" + peer.port()});
    EXPECT_EQ(outcome.code, 1) << said.substr(0, 50);
    EXPECT_NE(outcome.err.find(why), std::string::npos) << said.substr(0, 50) << "\n" << outcome.err;
  }
  const SaysOnce whole(headers + "\r\nall is well\n");
  EXPECT_EQ(health({"--set", "http.port=" + whole.port()}).code, 0);
}

TEST_F(DaemonOperation, WithTokensTheMetricsNeedOneAndHealthDoesNot) {
  const std::string tokens = folder.write("tokens", "viewer viewer-token-0123456789\n");
  ASSERT_EQ(chmod(tokens.c_str(), 0600), 0);
  const Daemon daemon({"--config", scene, "--set", "server.tokens=" + tokens, "--set", "log.format=json"},
                      folder.path(), "ready: ");
  const std::uint16_t port = port_of(http_address(daemon));
  EXPECT_EQ(http_get(port, "/healthz").status, 200);
  EXPECT_EQ(http_get(port, "/readyz").status, 200);
  const auto metrics = [&](const std::string& field) {
    HttpPeer peer(port);
    peer.send("GET /metrics HTTP/1.1\r\nHost: localhost\r\n" + field + "\r\n");
    return peer.receive();
  };
  EXPECT_EQ(metrics("").status, 401);
  EXPECT_NE(metrics("").headers.find("www-authenticate: bearer"), std::string::npos);
  EXPECT_EQ(metrics("Authorization: Bearer viewer-token-012345678\r\n").status, 401);
  EXPECT_EQ(metrics("Authorization: Bearer\r\n").status, 401);
  EXPECT_EQ(metrics("Authorization: Basic viewer-token-0123456789\r\n").status, 401);
  EXPECT_EQ(metrics("Authorization: Bearer viewer-token-0123456789\r\n").status, 200);
  EXPECT_EQ(metrics("authorization: bearer viewer-token-0123456789\r\n").status, 200);
  EXPECT_EQ(daemon.log().find("viewer-token"), std::string::npos) << "no token is ever written down";
  EXPECT_EQ(client_of(daemon.log(), "/metrics refused").rfind("127.0.0.1:", 0), 0u) << daemon.log();
}

TEST_F(DaemonOperation, WithACertificateHttpIsHttpsAndHealthAsksSo) {
  const std::string certificate = folder / "certificate.pem";
  const std::string key = folder / "key.pem";
  const Outcome made =
      run_program("/usr/bin/openssl",
                  {"req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes",
                   "-days", "2", "-subj", "/CN=somewhere.else", "-keyout", key, "-out", certificate},
                  folder.path());
  if (made.code != 0) GTEST_SKIP() << "no openssl program here makes a certificate: " << made.err;
  const std::vector<std::string> tls = {"--set", "server.tls_certificate=" + certificate, "--set",
                                        "server.tls_key=" + key};
  std::vector<std::string> arguments = {"--config", scene, "--set", "log.format=json"};
  arguments.insert(arguments.end(), tls.begin(), tls.end());
  const Daemon daemon(arguments, folder.path(), "ready: ");
  std::vector<std::string> question = tls;
  question.insert(question.end(), {"--set", "http.port=" + http_port(daemon)});
  const Outcome alive = health(question);
  EXPECT_EQ(alive.code, 0) << alive.err;
  EXPECT_EQ(alive.out.rfind("healthy: https://", 0), 0u) << alive.out;
  const Outcome metrics =
      run_program("/usr/bin/curl", {"--silent", "--insecure", "https://" + http_address(daemon) + "/metrics"},
                  folder.path());
  const std::string name = "\nobliq_tls_certificate_end_time_seconds ";
  const std::size_t at = metrics.out.find(name);
  ASSERT_NE(at, std::string::npos) << metrics.out << metrics.err;
  EXPECT_NEAR(std::stod(metrics.out.substr(at + name.size())) - static_cast<double>(std::time(nullptr)),
              2 * 86400, 3600)
      << "two days from when it was made";
  HttpPeer plain(port_of(http_address(daemon)));
  plain.send("GET /metrics HTTP/1.1\r\nHost: localhost\r\n\r\n");
  const HttpReply reply = plain.receive();
  EXPECT_EQ(reply.status, 400);
  EXPECT_EQ(reply.body, "this port speaks HTTPS only: https://\n") << "nothing else is said in plain words";
  EXPECT_EQ(client_of(daemon.log(), "TLS handshake failed").rfind("127.0.0.1:", 0), 0u) << daemon.log();
}

TEST_F(DaemonOperation, OffLoopbackHttpIsRefusedAsTheStreamIs) {
  const Outcome outcome =
      run_program(OBLIQD_PROGRAM, {"--config", scene, "--set", "http.address=0.0.0.0"}, folder.path());
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.err.find("http.address"), std::string::npos) << outcome.err;
}

TEST_F(DaemonOperation, ReadinessEndsAtTheSignalAndASecondSignalEndsItAtOnce) {
  Daemon daemon(
      {"--config", scene, "--set", "server.stop_limit_s=600", "--set", "server.stall_timeout_s=600"},
      folder.path());
  client::Client stalled =
      connected(daemon.address());  // asks for 80 MB and never reads: its queue does not drain
  wire::RenderOnce request;
  request.set_radar("main");
  request.mutable_settings()->set_azimuth_bins(2000);
  request.mutable_settings()->set_range_bins(2000);
  request.mutable_settings()->set_r_max_m(9000);
  request.mutable_pose()->set_latitude_deg(33);
  request.mutable_pose()->set_longitude_deg(-99.5);
  request.mutable_pose()->set_height_m(1500);
  ASSERT_TRUE(is_ok(stalled.render_once(request)));
  // Its frame has begun: the server had something to send.
  ASSERT_TRUE(stalled.receive(client::Timeout(20000)).ok());
  daemon.send_signal(SIGTERM);
  HttpReply ready = http_get(port_of(http_address(daemon)), "/readyz");
  while (ready.status == 200) ready = http_get(port_of(http_address(daemon)), "/readyz");
  EXPECT_EQ(ready.status, 503);
  EXPECT_EQ(ready.body, "stopping\n");
  EXPECT_EQ(http_get(port_of(http_address(daemon)), "/healthz").status, 200);
  daemon.send_signal(SIGTERM);
  EXPECT_EQ(daemon.wait(), -SIGTERM);
}

}  // namespace
}  // namespace obliq::test::operation_test
