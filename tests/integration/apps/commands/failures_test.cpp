// obliq get and watch against servers that fail them: one clear line, exit code 1, no hang.
#include <gtest/gtest.h>
#include <unistd.h>

#include <functional>
#include <thread>

#include "proto/limits.h"
#include "proto/message_codec.h"
#include "proto/obliq.pb.h"
#include "tests/integration/daemon.h"
#include "tests/support/loopback.h"

namespace obliq::test::failures_test {
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
    address_ = "127.0.0.1:" + std::to_string(bind_to_loopback(listener_));
    EXPECT_EQ(listen(listener_, 1), 0);
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

class CommandFailures : public ProgramTest {
 protected:
  /// Runs `obliq COMMAND` against a script and expects one line with `part` in it.
  void expect_failure(const std::string& command, const Script& script, const std::string& part,
                      int close_after = 0) {
    const ScriptedServer server(script, close_after);
    std::vector<std::string> more;
    if (command == "watch") more = {"--reconnect", "0"};
    if (command == "get") more = {"--out", folder / "frame"};
    const Outcome outcome = obliq({command, "--server", server.address()}, more);
    EXPECT_EQ(outcome.code, 1);
    EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  }
};

TEST_F(CommandFailures, NobodyListens) {
  std::string address;
  {
    address = ScriptedServer([](MessageType, std::uint64_t) { return wire::Bytes(); }).address();
  }
  const Outcome outcome = obliq({"status", "--server", address});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_EQ(outcome.err, "obliq: cannot connect to " + address + ": Connection refused" + kWhatToDo);
}

TEST_F(CommandFailures, AnAddressThatIsNone) {
  const Outcome outcome = obliq({"status", "--server", "host:port"});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.err.find("--server: found \"host:port\""), std::string::npos) << outcome.err;
}

TEST_F(CommandFailures, AServerThatDoesNotAnswerAsOneIsToldInALine) {
  const struct {
    const char* command;
    Script script;
    const char* said;
  } cases[] = {
      {"get",
       [](MessageType, std::uint64_t id) {
         wire::Bytes answer = welcome(id);
         answer[4] = std::byte{2};
         return answer;
       },
       "protocol version: found 2.2; allowed: 1.x"},
      {"get", [](MessageType, std::uint64_t id) { return welcome(id, 9); },
       "protocol version: found 9.0; allowed: 1.x"},
      {"watch", [](MessageType, std::uint64_t) { return wire::Bytes(100, std::byte{'x'}); },
       "not an obliq stream"},
      {"status", [](MessageType, std::uint64_t) { return wire::Bytes(); }, "the server has closed"},
      {"status",
       [](MessageType, std::uint64_t id) {
         wire::Bytes answer = welcome(id);
         answer.back() ^= std::byte{1};
         return answer;
       },
       "damaged"},
  };
  for (const auto& [command, script, said] : cases) expect_failure(command, script, said);
}

TEST_F(CommandFailures, NobodyListensForAsLongAsOneWaits) {
  std::string address;
  {
    address = ScriptedServer([](MessageType, std::uint64_t) { return wire::Bytes(); }).address();
  }
  const Outcome outcome = obliq({"status", "--wait", "1", "--server", address});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_EQ(outcome.err, "obliq: waiting for a server at " + address +
                             ", 1 s at most\nobliq: cannot connect to " + address +
                             ": Connection refused (waited 1 s)" + kWhatToDo);
}

TEST_F(CommandFailures, AServerThatRefusesIsNotWaitedFor) {
  const ScriptedServer server([](MessageType, std::uint64_t id) { return welcome(id, 9); });
  const Outcome outcome = obliq({"watch", "--wait", "600", "--server", server.address()});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_EQ(outcome.err.find("waiting"), std::string::npos) << outcome.err;
}

wire::Bytes bytes_of(std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

TEST_F(CommandFailures, AForeignServerIsKnownByItsFirstBytesHoweverFew) {
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

TEST_F(CommandFailures, AServerThatTakesConnectionsAndSaysNothingIsNotWaitedForLong) {
  const int listener = socket(AF_INET, SOCK_STREAM, 0);
  const std::string port = std::to_string(bind_to_loopback(listener));
  ASSERT_EQ(listen(listener, 1), 0);
  const Outcome outcome = obliq({"status", "--server", port});
  close(listener);
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.err.find("has sent nothing for 2 s: it is not obliqd, or too busy to answer"),
            std::string::npos)
      << outcome.err;
}

TEST_F(CommandFailures, AnUnknownRadar) {
  const ScriptedServer server([](MessageType type, std::uint64_t id) {
    if (type == MessageType::hello) return welcome(id);
    wire::RadarList list;
    list.set_request_id(id);
    list.add_radars("main");
    return wire::encode_message(MessageType::radar_list, {0, id, 0}, list);
  });
  const Outcome outcome = obliq({"pose", "--server", server.address(), "--radar", "tail"});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_EQ(outcome.err, "obliq: --radar: found \"tail\"; allowed: main\n");
}

TEST_F(CommandFailures, AServerThatGoesInTheMiddleOfAFrame) {
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

TEST_F(CommandFailures, AFrameThatTheServerGivesUp) {
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

TEST_F(CommandFailures, AFrameOfImpossibleSize) {
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
}  // namespace obliq::test::failures_test
