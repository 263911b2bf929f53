// A connection from its first byte to its last: a session behind a transport, a socket, and a peer that sends
// what the input says. All limits of size are some hundred bytes, so that short inputs reach them.
//
// First byte: bit 0, a WebSocket, else TCP; bit 1, its opening handshake is the first piece, else a good one.
// Then pieces, each up to two bytes FE: no lengths, so that a piece can grow by itself. A piece's first byte,
// lowest two bits:
//   0  a message: its type, then its descriptor, behind a header that fits
//   1  a message whose bytes are the input's, header included, in a frame where there are frames
//   2  bytes as they are
//   3  a frame (bits 4 to 7 its opcode, bit 3 the last of its message); bytes as they are over TCP
// Bit 2 sends the piece as a whole, else it comes in two halves.
#include <spdlog/spdlog.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <boost/asio.hpp>
#include <chrono>
#include <memory>
#include <string>
#include <utility>  // Boost 1.74 uses std::exchange without including it

#include "proto/message_codec.h"
#include "server/net/room.h"
#include "server/net/session.h"
#include "server/net/socket_transport.h"
#include "server/websocket/json_message.h"
#include "server/websocket/web_socket_transport.h"
#include "tests/fuzz/input.h"
#include "tests/fuzz/no_scene.h"

namespace obliq::net {
namespace {

namespace asio = boost::asio;

constexpr int kMostRequestBytes = 600;
constexpr std::uint32_t kMostHelloBytes = 240;
constexpr std::uint32_t kMostDescriptorBytes = 88;  // a little more than the seed web_query has
constexpr std::size_t kLongestPiece = 1024;

constexpr std::byte kText{1};
constexpr std::byte kBinary{2};
constexpr std::byte kClose{8};
constexpr std::byte kLastOfMessage{0x80};

constexpr const char* kOpening =
    "GET /stream HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
    "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n"
    "Sec-WebSocket-Protocol: obliq.v1.json\r\n\r\n";

ServerOptions small_limits() {
  ServerOptions options;
  options.max_request_bytes = kMostRequestBytes;
  options.max_hello_bytes = kMostHelloBytes;
  options.max_descriptor_bytes = kMostDescriptorBytes;
  options.stop_grace_s = 0.05;  // of a session whose peer has not taken its leave
  return options;
}

/// A frame as a client sends it, under a mask of zeros.
wire::Bytes frame_of(std::byte first, std::span<const std::byte> payload) {
  const std::size_t n = payload.size();
  wire::Bytes frame;
  frame.reserve(n + 8);
  frame.push_back(first);
  if (n < 126) {
    frame.push_back(std::byte{0x80} | static_cast<std::byte>(n));
  } else {
    frame.push_back(std::byte{0x80 | 126});
    frame.push_back(static_cast<std::byte>(n >> 8));
    frame.push_back(static_cast<std::byte>(n & 0xff));
  }
  frame.insert(frame.end(), 4, std::byte{0});
  frame.insert(frame.end(), payload.begin(), payload.end());
  return frame;
}

/// What the peer has been sent, taken apart.
class Heard {
 public:
  explicit Heard(bool web) : web_(web) {}

  void add(std::span<const std::byte> bytes) {
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    while (web_ ? take_frame() : take_message(bytes_.size(), 0)) {
    }
  }
  /// Whether the peer knows that the connection ends, and why.
  bool told() const { return told_; }
  bool opened() const { return opened_; }

 private:
  bool take_frame() {
    if (!opened_) {
      const std::string_view text(reinterpret_cast<const char*>(bytes_.data()), bytes_.size());
      const std::size_t end = text.find("\r\n\r\n");
      if (end == std::string_view::npos) return false;
      opened_ = text.starts_with("HTTP/1.1 101");
      bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(end + 4));
      return opened_;
    }
    if (bytes_.size() < 2) return false;
    const auto first = std::to_integer<unsigned>(bytes_[1]);
    const std::size_t more = first == 126 ? 2 : first == 127 ? 8 : 0;
    if (bytes_.size() < 2 + more) return false;
    std::size_t n = more == 0 ? first : 0;
    for (std::size_t i = 0; i < more; ++i) n = n << 8 | std::to_integer<std::size_t>(bytes_[2 + i]);
    const std::size_t head = 2 + more;
    if (bytes_.size() < head + n) return false;
    const std::byte opcode = bytes_[0] & std::byte{15};
    if (opcode == kText) fuzz::broken("a text message was sent");
    if (opcode == kClose) told_ = true;
    if (opcode != kBinary) {
      bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(head + n));
      return true;
    }
    if (!take_message(n, head)) fuzz::broken("a frame holds no message");
    return true;
  }

  /// One of `n` bytes behind `skip` others; over TCP of as many as it has.
  bool take_message(std::size_t n, std::size_t skip) {
    wire::MessageView view;
    const auto bytes = std::span<const std::byte>(bytes_).subspan(skip, n);
    if (web_) {
      wire::Bytes binary;
      if (websocket::to_binary(bytes, {1 << 24, 1 << 24}, binary)) return false;
      (void)wire::decode_message(binary, 1 << 24, view);
      view.size = n;
    } else {
      const auto status = wire::decode_message(bytes, 1 << 24, view);
      if (status == wire::MessageStatus::need_more) return false;
      if (status != wire::MessageStatus::ok) fuzz::broken("what was sent is no message");
    }
    told_ |= view.header.type == wire::MessageType::error;
    bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(skip + view.size));
    return true;
  }

  bool web_;
  bool opened_ = false;
  bool told_ = false;
  wire::Bytes bytes_;
};

/// One for all inputs: a room has threads, and to begin and end them takes longer than an input.
struct Server {
  fuzz::NoScene renderer;
  asio::io_context io{1};
  std::shared_ptr<Room> room =
      std::make_shared<Room>(renderer, small_limits(), std::vector{fuzz::small_radar("main")},
                             [this](std::function<void()> work) { asio::post(io, std::move(work)); });
};

Server& server() {
  static Server only;
  return only;
}

class Connection {
 public:
  Connection(bool web, std::string opening) : io_(server().io), heard_(web) {
    std::array<int, 2> ends{};
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends.data()) != 0)
      fuzz::broken("no sockets");
    peer_ = ends[1];
    std::unique_ptr<Transport> transport;
    auto socket = std::make_unique<SocketTransport>(io_, ends[0], false, nullptr);
    if (web) {
      transport = std::make_unique<websocket::WebSocketTransport>(io_, std::move(socket), std::move(opening),
                                                                  std::string());
    } else {
      transport = std::move(socket);
    }
    start_session(io_, std::move(transport), 1, server().room);
    turn();
  }
  ~Connection() {
    ::shutdown(peer_, SHUT_WR);
    turn();
    ::close(peer_);
    io_.restart();
    io_.run_for(std::chrono::seconds(5));
    if (!io_.stopped()) fuzz::broken("the session goes on without its peer");
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  /// Sends, and lets the server do what it can. False: the server has closed.
  bool send(std::span<const std::byte> bytes) {
    if (::send(peer_, bytes.data(), bytes.size(), MSG_NOSIGNAL) < 0) return false;
    return turn();
  }
  const Heard& heard() const { return heard_; }

 private:
  bool turn() {
    while (true) {
      io_.restart();
      const std::size_t done = io_.poll();
      std::array<std::byte, 4096> some;
      const ssize_t n = ::recv(peer_, some.data(), some.size(), 0);
      if (n > 0) heard_.add(std::span(some).first(static_cast<std::size_t>(n)));
      if (n == 0) return false;
      if (n < 0 && done == 0) return true;
    }
  }

  asio::io_context& io_;
  int peer_ = -1;
  Heard heard_;
};

wire::Bytes message_of(bool web, wire::MessageType type, std::span<const std::byte> descriptor) {
  wire::MessageHeader header{.type = type};
  header.flags = web ? wire::kJsonDescriptor : std::uint16_t{0};
  header.payload_length = header.descriptor_length = static_cast<std::uint32_t>(descriptor.size());
  wire::Bytes bytes(wire::kHeaderBytes);
  bytes.insert(bytes.end(), descriptor.begin(), descriptor.end());
  wire::encode_header(header, std::span(bytes).first<wire::kHeaderBytes>());
  if (!web) fuzz::mend_crcs(bytes);
  return bytes;
}

wire::Bytes piece_of(bool web, unsigned kind, fuzz::Input bytes) {
  wire::Bytes piece;
  if ((kind & 3) == 0) {
    const auto type = static_cast<wire::MessageType>(bytes.u8());
    piece = message_of(web, type, bytes.rest());
  } else {
    const auto given = bytes.rest();
    piece.assign(given.begin(), given.end());
    if (!web && (kind & 3) == 1) fuzz::mend_crcs(piece);
  }
  if (!web || (kind & 3) == 2) return piece;
  if ((kind & 3) != 3) return frame_of(kLastOfMessage | kBinary, piece);
  const std::byte last = (kind & 8) != 0 ? kLastOfMessage : std::byte{0};
  return frame_of(last | static_cast<std::byte>(kind >> 4), piece);
}

/// Up to the next end of a piece, which is left out.
fuzz::Input next_piece(std::span<const std::uint8_t>& left) {
  constexpr std::array<std::uint8_t, 2> kEnd{0xfe, 0xfe};
  const auto end = std::search(left.begin(), left.end(), kEnd.begin(), kEnd.end());
  const auto n = static_cast<std::size_t>(end - left.begin());
  const auto piece = left.first(std::min(n, kLongestPiece));
  left = left.subspan(std::min(n + kEnd.size(), left.size()));
  return {piece.data(), piece.size()};
}

void run(std::span<const std::uint8_t> input) {
  const unsigned mode = input.empty() ? 0 : input[0];
  input = input.subspan(std::min<std::size_t>(1, input.size()));
  const bool web = (mode & 1) != 0;
  const bool own_opening = (mode & 2) != 0;
  std::string opening = kOpening;
  if (own_opening) {
    const auto bytes = next_piece(input).rest();
    opening.assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  }
  Connection connection(web, std::move(opening));
  bool open = true;
  while (!input.empty() && open) {
    fuzz::Input bytes = next_piece(input);
    const unsigned kind = bytes.u8();
    const wire::Bytes piece = piece_of(web, kind, bytes);
    const std::size_t half = (kind & 4) == 0 ? piece.size() / 2 : 0;
    if (half > 0) open = connection.send(std::span(piece).first(half));
    if (open) open = connection.send(std::span(piece).subspan(half));
  }
  if (!open && !connection.heard().told() && (!web || connection.heard().opened()))
    fuzz::broken("the server has closed and did not say why");
}

}  // namespace
}  // namespace obliq::net

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  const obliq::fuzz::QuietProtobuf quiet;
  spdlog::set_level(spdlog::level::off);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  obliq::net::run({data, size});
  return 0;
}
