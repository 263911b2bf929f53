#include "server/net/socket_transport.h"

#include <array>
#include <atomic>
#include <boost/asio/bind_executor.hpp>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/ssl/error.hpp>
#include <boost/asio/ssl/stream.hpp>
#include <boost/asio/write.hpp>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "server/net/io_thread.h"
#include "server/net/tcp.h"
#include "server/security/networks.h"
#include "server/stream/block.h"
#include "terrain/base/process.h"

namespace obliq::net {

namespace asio = boost::asio;
namespace ssl = boost::asio::ssl;
using asio::ip::tcp;
using boost::system::error_code;

namespace {

/// For a peer on this machine, whose round trip is too short to need more: what the kernel holds then stays
/// in the cache, which is worth a third of the throughput (stream_bench). Elsewhere the kernel fits its
/// buffer to the round trip.
constexpr int kLoopbackSendBytes = 200'000;

/// RFC 8446 section 5.1: the first byte of a client's first record, ContentType handshake.
constexpr std::byte kTlsHandshake{22};

/// Does the arithmetic of TLS handshakes, on one thread of low priority for all servers of this process, so
/// that a flood of handshakes takes little from the clients that are served. Runs until the process ends.
/// While a socket's handshake is here, nothing else may touch the socket.
asio::io_context& handshakes() {
  static IoThread only;
  static std::once_flag lowered;  // best effort: without it a flood costs more
  std::call_once(lowered, [] { only.post([] { (void)lower_own_priority(); }); });
  return only.context();
}

Transport::Transfer outcome(error_code error) {
  if (!error) return Transport::Transfer::done;
  // A TLS peer may close without close_notify: messages have lengths and CRCs of their own.
  const bool end = error == asio::error::eof || error == ssl::error::stream_truncated;
  return end ? Transport::Transfer::end : Transport::Transfer::failed;
}

}  // namespace

struct SocketTransport::State {
  State(asio::io_context& io, int socket_fd, bool is_ipv6, std::shared_ptr<ssl::context> tls)
      : context(std::move(tls)), socket(io, is_ipv6 ? tcp::v6() : tcp::v4(), socket_fd) {
    if (context) stream.emplace(socket, *context);
  }

  void shake_hands(std::function<void(error_code)> shaken);

  std::shared_ptr<ssl::context> context;  ///< outlives the stream, whatever is loaded meanwhile
  tcp::socket socket;
  std::optional<ssl::stream<tcp::socket&>> stream;  ///< none: plain
  std::byte first{};                                ///< of the peer
  std::vector<std::byte> joined;                    ///< parts that are being written
  bool ready = false;
  std::string failure;
  bool shaking = false;              ///< the socket belongs to the handshake thread
  std::atomic<bool> closed = false;  ///< meanwhile
};

SocketTransport::SocketTransport(asio::io_context& io, int socket_fd, bool is_ipv6,
                                 std::shared_ptr<ssl::context> tls)
    : state_(std::make_unique<State>(io, socket_fd, is_ipv6, std::move(tls))) {
  error_code ignored;  // optional: failure is harmless
  state_->socket.set_option(tcp::no_delay(true), ignored);
  if (security::is_loopback_address(host()))
    state_->socket.set_option(asio::socket_base::send_buffer_size(kLoopbackSendBytes), ignored);
}
SocketTransport::~SocketTransport() = default;

std::string SocketTransport::host() const { return host_of_peer(state_->socket.native_handle()); }

std::string SocketTransport::address() const { return endpoint_of_peer(state_->socket.native_handle()); }

bool SocketTransport::is_ready() const { return state_->ready; }

std::string SocketTransport::description() const {
  if (!state_->failure.empty()) return state_->failure;
  if (!state_->stream) return "plain";
  SSL* tls = state_->stream->native_handle();
  return std::string(SSL_get_version(tls)) + ", " + SSL_get_cipher_name(tls);
}

/// On the handshake thread; then calls `shaken` on the io thread. Once that has been called nothing of this
/// is left on the handshake thread, close() included.
void SocketTransport::State::shake_hands(std::function<void(error_code)> shaken) {
  // Keeps the io thread alive while it waits for this.
  const auto work = asio::make_work_guard(socket.get_executor());
  const auto back = [this, shaken = std::move(shaken), work](error_code error) {
    asio::post(work.get_executor(), [this, shaken, work, error] {
      if (!closed) return shaken(error);
      // After what close() posted to the handshake thread before this.
      asio::post(handshakes(), [shaken, work] {
        asio::post(work.get_executor(), [shaken] { shaken(asio::error::operation_aborted); });
      });
    });
  };
  asio::post(handshakes(), [this, back] {
    if (closed) return back(asio::error::operation_aborted);  // the peer has gone: save the arithmetic
    stream->async_handshake(ssl::stream_base::server, asio::bind_executor(handshakes().get_executor(), back));
  });
}

void SocketTransport::start(Started done) {
  State& s = *state_;
  if (!s.stream) {
    s.ready = true;
    return asio::post(s.socket.get_executor(), [done = std::move(done)] { done(Start::ready); });
  }
  const auto fail = [&s](error_code error) {
    s.failure = error.message();
    return Start::failed;
  };
  const auto shaken = [&s, fail, done](error_code error) {
    s.shaking = false;
    s.ready = !error;
    done(error ? fail(error) : Start::ready);
  };
  s.socket.async_receive(asio::buffer(&s.first, 1), tcp::socket::message_peek,
                         [&s, fail, shaken, done](error_code error, std::size_t) {
                           if (error) return done(fail(error));
                           if (s.first == kTlsHandshake) {
                             s.shaking = true;
                             return s.shake_hands(shaken);
                           }
                           s.stream.reset();
                           s.ready = true;
                           done(Start::plain_peer);
                         });
}

void SocketTransport::read(std::span<std::byte> bytes, bool some, Done done) {
  if (some) return read_some(bytes, [done = std::move(done)](Transfer got, std::size_t) { done(got); });
  State& s = *state_;
  const auto transfer = [&](auto& stream) {
    asio::async_read(stream, asio::buffer(bytes.data(), bytes.size()),
                     [done = std::move(done)](error_code error, std::size_t) { done(outcome(error)); });
  };
  s.stream ? transfer(*s.stream) : transfer(s.socket);
}

void SocketTransport::read_some(std::span<std::byte> bytes, Counted done) {
  State& s = *state_;
  const auto transfer = [&](auto& stream) {
    stream.async_read_some(
        asio::buffer(bytes.data(), bytes.size()),
        [done = std::move(done)](error_code error, std::size_t got) { done(outcome(error), got); });
  };
  s.stream ? transfer(*s.stream) : transfer(s.socket);
}

void SocketTransport::write(const stream::Block& message, Done done) {
  write(message.bytes, std::move(done));
}

void SocketTransport::write(std::span<const std::byte> bytes, Done done) {
  write_parts(std::array{bytes}, std::move(done));
}

void SocketTransport::write_parts(std::span<const std::span<const std::byte>> parts, Done done) {
  State& s = *state_;
  std::vector<asio::const_buffer> buffers;
  for (const auto part : parts) buffers.emplace_back(part.data(), part.size());
  const std::size_t most = asio::buffer_size(buffers);
  if (s.stream && parts.size() > 1) {  // each part would be a record, and a packet, of its own
    s.joined.resize(most);
    asio::buffer_copy(asio::buffer(s.joined), buffers);
    buffers.assign(1, asio::const_buffer(s.joined.data(), most));
  }
  // Offer the kernel all that is left at once; Asio by default offers 64 KiB at a time.
  const auto all_of_it = [most](error_code error, std::size_t) { return error ? std::size_t{0} : most; };
  const auto transfer = [&](auto& stream) {
    asio::async_write(stream, std::move(buffers), all_of_it,
                      [done = std::move(done)](error_code error, std::size_t) { done(outcome(error)); });
  };
  s.stream ? transfer(*s.stream) : transfer(s.socket);
}

void SocketTransport::finish(Done done) {
  State& s = *state_;
  if (s.stream) {
    // Sends close_notify, then waits for the peer's, which the reader receives.
    return s.stream->async_shutdown([done = std::move(done)](error_code error) { done(outcome(error)); });
  }
  error_code error;
  s.socket.shutdown(tcp::socket::shutdown_send, error);
  asio::post(s.socket.get_executor(), [done = std::move(done), error] { done(outcome(error)); });
}

void SocketTransport::close() {
  State& s = *state_;
  const auto close_socket = [&s] {
    error_code ignored;
    s.socket.close(ignored);
  };
  if (!s.shaking) return close_socket();
  if (!s.closed.exchange(true)) asio::post(handshakes(), close_socket);
}

}  // namespace obliq::net
