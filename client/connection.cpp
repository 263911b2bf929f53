#include "client/connection.h"

#include <algorithm>
#include <cstdio>
#include <string_view>
#include <utility>

#include "proto/limits.h"
#include "proto/obliq.pb.h"

namespace obliq::client {

namespace {

// A server that stops in the middle of a message for this long is taken for dead.
constexpr Timeout kMessageTimeout{30000};
// An Error without TLS, see explain_tls_failure.
constexpr std::uint32_t kLongestFarewellBytes = 4096;
constexpr std::size_t kMagicBytes = 4;
// Of a stranger's first words, as far as they come without waiting.
constexpr std::size_t kGreetingBytes = 60;
constexpr Timeout kGreetingPause{20};

struct Known {
  std::string_view beginning;
  std::string_view program;
};
// RFC 9112, RFC 4253 4.2, RFC 8446 5.1 (records of type alert and handshake), RFC 5321 and RFC 959 (220).
constexpr Known kKnown[] = {
    {"HTTP/", "an HTTP server (obliqd's own has another port than its stream)"},
    {"SSH-", "an SSH server"},
    {"\x15\x03", "a server that speaks TLS (obliq: --tls, if it is obliqd)"},
    {"\x16\x03", "a server that speaks TLS (obliq: --tls, if it is obliqd)"},
    {"220", "a mail or FTP server"},
};

bool is_printable(char c) { return c >= ' ' && c <= '~'; }

/// The first line as text, or the first bytes as numbers.
std::string shown(std::string_view text) {
  const std::string_view line = text.substr(0, text.find_first_of("\r\n"));
  if (!line.empty() && std::ranges::all_of(line, is_printable)) return "\"" + std::string(line) + "\"";
  std::string bytes = "the bytes";
  for (const char c : text.substr(0, 8)) {
    char number[4];
    std::snprintf(number, sizeof number, " %02X", static_cast<unsigned>(static_cast<unsigned char>(c)));
    bytes += number;
  }
  return bytes;
}

/// Guesses the protocol from the first bytes and suggests a fix.
std::string foreign_greeting(std::span<const std::byte> first) {
  const std::string_view text(reinterpret_cast<const char*>(first.data()), first.size());
  std::string_view program = "another program";
  for (const Known& known : kKnown)
    if (text.starts_with(known.beginning)) program = known.program;
  return "not an obliq stream: found " + shown(text) + ", which is " + std::string(program) +
         "; allowed: where obliqd listens (server.port, 7420 unless its scene file says otherwise)";
}

}  // namespace

wire::Bytes Message::bytes() const {
  const auto first = header_bytes();
  wire::Bytes all(first.begin(), first.end());
  all.insert(all.end(), payload.begin(), payload.end());
  return all;
}

Status Connection::open(const Endpoint& endpoint, const TlsOptions& tls, Timeout timeout, Connection& out) {
  out.sequence_ = 0;
  Status status = Socket::connect(endpoint, timeout, out.socket_);
  if (!status.ok() || !tls.enabled) return status;
  status = out.socket_.start_tls(endpoint.host, tls, timeout);
  if (status.ok()) return status;
  if (status.outcome == Outcome::untrusted) status = out.explain_tls_failure(std::move(status), timeout);
  out.close();
  status.text = endpoint.text() + ": " + status.text;
  return status;
}

// A server that does not speak TLS there, or not with this client, says why in an Error of its own.
Status Connection::explain_tls_failure(Status failure, Timeout timeout) {
  wire::Bytes said = socket_.give_up_tls();
  while (said.size() < kLongestFarewellBytes) {
    wire::MessageView view;
    const auto status = wire::decode_message(said, kLongestFarewellBytes, view);
    wire::Error error;
    if (status == wire::MessageStatus::ok && view.header.type == wire::MessageType::error &&
        wire::parse_descriptor(view.descriptor, error))
      return Status::from_error(error);
    if (status != wire::MessageStatus::need_more) break;
    std::byte next{};
    if (!socket_.receive(std::span(&next, 1), timeout).ok()) break;
    said.push_back(next);
  }
  return failure;
}

Status Connection::send(wire::MessageType type, const google::protobuf::MessageLite& message) {
  if (!is_open()) return Status::failure(Outcome::closed, "not connected");
  const wire::Bytes bytes = wire::encode_message(type, {0, ++sequence_, wire::utc_now_ns()}, message);
  if (bytes.empty()) return Status::failure(Outcome::bad_argument, "the request is too large");
  Status status = socket_.send(bytes, kMessageTimeout);
  // What the server said before it closed is still to be read, so the socket stays open for that.
  return status;
}

Status Connection::receive(Message& message, Timeout timeout) {
  if (Status status = socket_.wait_readable(timeout); !status.ok()) return status;
  Status status = receive_begun(message);
  if (!status.ok()) socket_.close();
  return status;
}

// Bytes of something other than an obliq stream: they and what follows tell which program answers.
Status Connection::foreign(std::span<const std::byte> magic) {
  wire::Bytes said(magic.begin(), magic.end());
  while (said.size() < kGreetingBytes && socket_.wait_readable(kGreetingPause).ok()) {
    std::byte next{};
    if (!socket_.receive(std::span(&next, 1), kGreetingPause).ok()) break;
    said.push_back(next);
  }
  return Status::failure(Outcome::bad_stream, foreign_greeting(said));
}

Status Connection::receive_begun(Message& message) {
  const std::span<std::byte> all(message.head);
  const auto fixed = all.first<wire::kHeaderBytes>();
  // The magic alone first: four bytes tell a foreign protocol.
  const auto magic = fixed.first(kMagicBytes);
  if (Status status = socket_.receive(magic, kMessageTimeout); !status.ok()) return status;
  std::fill(fixed.begin() + kMagicBytes, fixed.end(), std::byte{0});
  if (wire::decode_header(fixed, wire::kMaxPayloadBytes, message.header) == wire::HeaderStatus::bad_magic)
    return foreign(magic);
  if (Status status = socket_.receive(fixed.subspan(kMagicBytes), kMessageTimeout); !status.ok())
    return status;
  const auto decoded = wire::decode_header(fixed, wire::kMaxPayloadBytes, message.header);
  if (decoded != wire::HeaderStatus::ok)
    return Status::failure(Outcome::bad_stream,
                           wire::describe(decoded, message.header, wire::kMaxPayloadBytes));
  const auto header = all.first(message.header.header_length);
  if (Status status = socket_.receive(header.subspan(wire::kHeaderBytes), kMessageTimeout); !status.ok())
    return status;
  message.payload.resize(message.header.payload_length);
  if (Status status = socket_.receive(message.payload, kMessageTimeout); !status.ok()) return status;
  if (wire::message_crc(header, message.payload) != message.header.crc)
    return Status::failure(Outcome::bad_stream, "a message from the server is damaged (CRC mismatch)");
  return {};
}

}  // namespace obliq::client
