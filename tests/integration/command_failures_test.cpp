// obliq get and watch against servers that fail them: one clear line, exit code 1, no hang.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <functional>
#include <thread>

#include "proto/limits.h"
#include "proto/message_codec.h"
#include "proto/obliq.pb.h"
#include "tests/integration/daemon.h"

namespace obliq::test {
namespace {

using wire::MessageType;

/// What to send in answer to a request; empty: close the connection.
using Script = std::function<wire::Bytes(MessageType type, std::uint64_t request_id)>;

constexpr const char* kWhatToDo =
    "; start obliqd there (`obliqd SCENE.toml`), or give its address with --server HOST:PORT; --wait "
    "SECONDS retries until it has loaded\n";

/// Serves one client after a script.
class ScriptedServer {
 public:
  /// close_after: this many requests; 0: when the script says so.
  explicit ScriptedServer(Script script, int close_after = 0)
      : script_(std::move(script)), close_after_(close_after) {
    listener_ = socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    EXPECT_EQ(bind(listener_, reinterpret_cast<sockaddr*>(&address), size), 0);
    EXPECT_EQ(listen(listener_, 1), 0);
    EXPECT_EQ(getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size), 0);
    address_ = "127.0.0.1:" + std::to_string(ntohs(address.sin_port));
    thread_ = std::thread([this] { serve(); });
  }
  ~ScriptedServer() {
    shutdown(listener_, SHUT_RDWR);
    thread_.join();
    close(listener_);
  }
  const std::string& address() const { return address_; }

 private:
  void serve() {
    const int fd = accept(listener_, nullptr, nullptr);
    if (fd < 0) return;
    wire::Bytes received;
    std::byte chunk[4096];
    int answered = 0;
    for (ssize_t n = 1; (n = recv(fd, chunk, sizeof chunk, 0)) > 0;) {
      received.insert(received.end(), chunk, chunk + n);
      wire::MessageView view;
      if (wire::decode_message(received, wire::kMaxPayloadBytes, view) != wire::MessageStatus::ok) continue;
      wire::ListRadars request;  // request_id is field 1 of every request; unknown fields are no trouble
      (void)wire::parse_descriptor(view.descriptor, request);
      const wire::Bytes answer = script_(view.header.type, request.request_id());
      received.clear();
      if (answer.empty()) break;
      send(fd, answer.data(), answer.size(), MSG_NOSIGNAL);
      if (++answered == close_after_) break;
    }
    close(fd);
  }

  Script script_;
  int close_after_;
  int listener_ = -1;
  std::string address_;
  std::thread thread_;
};

wire::Bytes welcome(std::uint64_t request_id, std::uint32_t major = wire::kMajorVersion) {
  wire::Welcome message;
  message.set_request_id(request_id);
  message.set_major(major);
  message.add_radars("main");
  return wire::encode_message(MessageType::welcome, {}, message);
}

wire::Bytes acknowledged(std::uint64_t request_id) {
  wire::Ack ack;
  ack.set_request_id(request_id);
  return wire::encode_message(MessageType::ack, {}, ack);
}

wire::Bytes begun_frame() {
  wire::FrameBegin begin;
  begin.mutable_frame()->mutable_settings()->set_azimuth_bins(8);
  begin.mutable_frame()->mutable_settings()->set_range_bins(8);
  return wire::encode_message(MessageType::frame_begin, {1, 1, 0}, begin);
}

void append(wire::Bytes& bytes, const wire::Bytes& more) {
  bytes.insert(bytes.end(), more.begin(), more.end());
}

/// Runs `obliq COMMAND` against a script and expects one line with `part` in it.
void expect_failure(const std::string& command, const Script& script, const std::string& part,
                    int close_after = 0) {
  const TestFolder folder;
  const ScriptedServer server(script, close_after);
  std::vector<std::string> arguments = {command, "--server", server.address()};
  if (command == "watch") arguments.insert(arguments.end(), {"--reconnect", "0"});
  if (command == "get") arguments.insert(arguments.end(), {"--out", folder / "frame"});
  const Outcome outcome = run_program(OBLIQ_PROGRAM, arguments, folder.path());
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
}

TEST(CommandFailures, NobodyListens) {
  const TestFolder folder;
  std::string address;
  {
    address = ScriptedServer([](MessageType, std::uint64_t) { return wire::Bytes(); }).address();
  }
  const Outcome outcome = run_program(OBLIQ_PROGRAM, {"status", "--server", address}, folder.path());
  EXPECT_EQ(outcome.code, 1);
  EXPECT_EQ(outcome.err, "obliq: cannot connect to " + address + ": Connection refused" + kWhatToDo);
}

TEST(CommandFailures, AnAddressThatIsNone) {
  const TestFolder folder;
  const Outcome outcome = run_program(OBLIQ_PROGRAM, {"status", "--server", "host:port"}, folder.path());
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.err.find("--server: found \"host:port\""), std::string::npos) << outcome.err;
}

TEST(CommandFailures, AServerOfAnotherMajorVersion) {
  expect_failure(
      "get",
      [](MessageType, std::uint64_t id) {
        wire::Bytes answer = welcome(id);
        answer[4] = std::byte{2};
        return answer;
      },
      "protocol version: found 2.1; allowed: 1.x");
}

TEST(CommandFailures, AServerWhoseWelcomeIsOfAnotherMajorVersion) {
  expect_failure(
      "get", [](MessageType, std::uint64_t id) { return welcome(id, 9); },
      "protocol version: found 9.0; allowed: 1.x");
}

TEST(CommandFailures, NobodyListensForAsLongAsOneWaits) {
  const TestFolder folder;
  std::string address;
  {
    address = ScriptedServer([](MessageType, std::uint64_t) { return wire::Bytes(); }).address();
  }
  const Outcome outcome =
      run_program(OBLIQ_PROGRAM, {"status", "--wait", "1", "--server", address}, folder.path());
  EXPECT_EQ(outcome.code, 1);
  EXPECT_EQ(outcome.err, "obliq: waiting for a server at " + address +
                             ", 1 s at most\nobliq: cannot connect to " + address +
                             ": Connection refused (waited 1 s)" + kWhatToDo);
}

TEST(CommandFailures, AServerThatRefusesIsNotWaitedFor) {
  const TestFolder folder;
  const ScriptedServer server([](MessageType, std::uint64_t id) { return welcome(id, 9); });
  const Outcome outcome =
      run_program(OBLIQ_PROGRAM, {"watch", "--wait", "600", "--server", server.address()}, folder.path());
  EXPECT_EQ(outcome.code, 1);
  EXPECT_EQ(outcome.err.find("waiting"), std::string::npos) << outcome.err;
}

TEST(CommandFailures, AServerThatIsNone) {
  expect_failure(
      "watch", [](MessageType, std::uint64_t) { return wire::Bytes(100, std::byte{'x'}); },
      "not an obliq stream");
}

wire::Bytes bytes_of(std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

TEST(CommandFailures, AForeignServerIsKnownByItsFirstBytesHoweverFew) {
  for (const auto& [says, found] :
       {std::pair{"SSH-2.0-OpenSSH_9.2\r\n", "found \"SSH-2.0-OpenSSH_9.2\", which is an SSH server"},
        std::pair{"HTTP/1.1 400 Bad Request\r\nConnection: close\r\n\r\n",
                  "found \"HTTP/1.1 400 Bad Request\", which is an HTTP server"},
        std::pair{"\x15\x03\x01\x02", "found the bytes 15 03 01 02, which is a server that speaks TLS"},
        std::pair{"220 mail ready\r\n", "a mail or FTP server"},
        std::pair{"hello", "found \"hello\", which is another program"}}) {
    expect_failure(
        "status", [says = says](MessageType, std::uint64_t) { return bytes_of(says); }, found);
  }
}

TEST(CommandFailures, AServerThatTakesConnectionsAndSaysNothingIsNotWaitedForLong) {
  const int listener = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  ASSERT_EQ(bind(listener, reinterpret_cast<sockaddr*>(&address), size), 0);
  ASSERT_EQ(listen(listener, 1), 0);
  ASSERT_EQ(getsockname(listener, reinterpret_cast<sockaddr*>(&address), &size), 0);
  const TestFolder folder;
  const Outcome outcome = run_program(
      OBLIQ_PROGRAM, {"status", "--server", std::to_string(ntohs(address.sin_port))}, folder.path());
  close(listener);
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.err.find("has sent nothing for 2 s: it is not obliqd, or too busy to answer"),
            std::string::npos)
      << outcome.err;
}

TEST(CommandFailures, AServerThatClosesAtOnce) {
  expect_failure(
      "status", [](MessageType, std::uint64_t) { return wire::Bytes(); }, "the server has closed");
}

TEST(CommandFailures, ADamagedAnswer) {
  expect_failure(
      "status",
      [](MessageType, std::uint64_t id) {
        wire::Bytes answer = welcome(id);
        answer.back() ^= std::byte{1};
        return answer;
      },
      "damaged");
}

TEST(CommandFailures, AnUnknownRadar) {
  const TestFolder folder;
  const ScriptedServer server([](MessageType, std::uint64_t id) { return welcome(id); });
  const Outcome outcome =
      run_program(OBLIQ_PROGRAM, {"pose", "--server", server.address(), "--radar", "tail"}, folder.path());
  EXPECT_EQ(outcome.code, 1);
  EXPECT_EQ(outcome.err, "obliq: --radar: found \"tail\"; allowed: main\n");
}

TEST(CommandFailures, AServerThatGoesInTheMiddleOfAFrame) {
  // Answers the subscription with the beginning of a frame, then closes: the client sends no more, so the
  // script's end is the end of the connection.
  expect_failure(
      "watch",
      [](MessageType type, std::uint64_t id) {
        if (type == MessageType::hello) return welcome(id);
        wire::Bytes answer = acknowledged(id);
        append(answer, begun_frame());
        return answer;
      },
      "the server has closed the connection", /*close_after=*/2);
}

TEST(CommandFailures, AFrameThatTheServerGivesUp) {
  expect_failure(
      "get",
      [](MessageType type, std::uint64_t id) {
        if (type == MessageType::hello) return welcome(id);
        if (type == MessageType::get_radar) {
          wire::RadarInfo info;
          info.set_request_id(id);
          return wire::encode_message(MessageType::radar_info, {}, info);
        }
        wire::Bytes answer = acknowledged(id);
        append(answer, begun_frame());
        wire::FrameAbort abort;
        abort.set_reason("no memory");
        append(answer, wire::encode_message(MessageType::frame_abort, {1, 2, 0}, abort));
        return answer;
      },
      "the server gave the frame up: no memory");
}

TEST(CommandFailures, AFrameOfImpossibleSize) {
  for (const auto& [azimuths, said] : {std::pair{1 << 14, "bytes; allowed: at most"},
                                       std::pair{1 << 20, "bins; allowed: 1 to 16384 x 1 to 16777216"}}) {
    expect_failure(
        "get",
        [azimuths = azimuths](MessageType type, std::uint64_t id) {
          if (type == MessageType::hello) return welcome(id);
          if (type == MessageType::get_radar) {
            wire::RadarInfo info;
            info.set_request_id(id);
            return wire::encode_message(MessageType::radar_info, {}, info);
          }
          wire::FrameBegin begin;
          begin.mutable_frame()->mutable_settings()->set_azimuth_bins(azimuths);
          begin.mutable_frame()->mutable_settings()->set_range_bins(1 << 20);
          wire::Bytes answer = acknowledged(id);
          append(answer, wire::encode_message(MessageType::frame_begin, {1, 1, 0}, begin));
          return answer;
        },
        said);
  }
}

}  // namespace
}  // namespace obliq::test
