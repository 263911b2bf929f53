#include "server/websocket/web_socket_transport.h"

#include <algorithm>
#include <array>
#include <boost/asio.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "server/stream/block.h"
#include "server/websocket/frame_lengths.h"
#include "server/websocket/json_message.h"

namespace obliq::websocket {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace bws = boost::beast::websocket;
using boost::system::error_code;
using net::SocketTransport;
using Transfer = net::Transport::Transfer;

namespace {

error_code error_of(Transfer transfer) {
  if (transfer == Transfer::done) return {};
  return transfer == Transfer::end ? error_code(asio::error::eof) : error_code(asio::error::connection_reset);
}

/// A SocketTransport as Beast wants its streams.
class SocketStream {
 public:
  using executor_type = asio::io_context::executor_type;

  SocketStream(executor_type executor, std::unique_ptr<SocketTransport> socket, std::string unread)
      : executor_(std::move(executor)), socket_(std::move(socket)), unread_(std::move(unread)) {}

  executor_type get_executor() const noexcept { return executor_; }
  SocketTransport& socket() { return *socket_; }
  const SocketTransport& socket() const { return *socket_; }

  template <class Buffers, class Handler>
  void async_read_some(const Buffers& buffers, Handler&& handler) {
    const asio::mutable_buffer first = first_of<asio::mutable_buffer>(buffers);
    auto shared = std::make_shared<std::decay_t<Handler>>(std::forward<Handler>(handler));
    if (!unread_.empty() || first.size() == 0) {
      const std::size_t n = asio::buffer_copy(first, asio::buffer(unread_));
      unread_.erase(0, n);
      lengths_.pass({static_cast<std::byte*>(first.data()), n});
      return asio::post(executor_, [shared, n] { std::move (*shared)(error_code(), n); });
    }
    const std::span bytes(static_cast<std::byte*>(first.data()), first.size());
    socket_->read_some(bytes, [this, bytes, shared](Transfer got, std::size_t n) {
      lengths_.pass(bytes.first(n));
      std::move (*shared)(error_of(got), n);
    });
  }

  /// Fails after end(): a read that would send a pong or a close then ends.
  template <class Buffers, class Handler>
  void async_write_some(const Buffers& buffers, Handler&& handler) {
    std::vector<std::span<const std::byte>> parts;
    for (auto at = asio::buffer_sequence_begin(buffers); at != asio::buffer_sequence_end(buffers); ++at) {
      const asio::const_buffer part(*at);
      if (part.size() > 0) parts.emplace_back(static_cast<const std::byte*>(part.data()), part.size());
    }
    const std::size_t n = asio::buffer_size(buffers);
    auto shared = std::make_shared<std::decay_t<Handler>>(std::forward<Handler>(handler));
    if (ending_) return asio::post(executor_, [shared] { std::move (*shared)(asio::error::broken_pipe, 0); });
    writing_ = true;
    socket_->write_parts(parts, [this, shared, n](Transfer put) {
      writing_ = false;
      if (const auto next = std::exchange(after_write_, nullptr)) next();
      std::move (*shared)(error_of(put), put == Transfer::done ? n : 0);
    });
  }

  /// Sends a close frame behind what is being written, and nothing after it.
  void end(net::Transport::Done done) {
    ending_ = true;
    if (writing_) {
      after_write_ = [this, done = std::move(done)] { end(done); };
      return;
    }
    socket_->write(kCloseFrame, [this, done = std::move(done)](Transfer put) {
      put == Transfer::done ? socket_->finish(done) : done(put);
    });
  }

 private:
  /// Normal closure, without a reason (RFC 6455 sections 5.2 and 7.4.1).
  static constexpr std::array kCloseFrame{std::byte{0x88}, std::byte{2}, std::byte{1000 >> 8},
                                          std::byte{1000 & 0xff}};

  template <class Buffer, class Buffers>
  static Buffer first_of(const Buffers& buffers) {
    for (auto at = asio::buffer_sequence_begin(buffers); at != asio::buffer_sequence_end(buffers); ++at)
      if (const Buffer buffer(*at); buffer.size() > 0) return buffer;
    return {};
  }

  executor_type executor_;
  std::unique_ptr<SocketTransport> socket_;
  std::string unread_;    ///< came with the request
  FrameLengths lengths_;  ///< Beast asks for nothing before the first frame
  bool writing_ = false;
  bool ending_ = false;
  std::function<void()> after_write_;
};

// What Beast calls at the end of the closing handshake (its "Teardown" requirements), and when a time limit
// of its own is over; it has none here.
template <class Handler>
void async_teardown(beast::role_type, SocketStream& stream, Handler&& handler) {
  auto shared = std::make_shared<std::decay_t<Handler>>(std::forward<Handler>(handler));
  stream.socket().finish([shared](Transfer finished) { std::move (*shared)(error_of(finished)); });
}

void beast_close_socket(SocketStream& stream) { stream.socket().close(); }

Transfer outcome(error_code error) {
  if (!error) return Transfer::done;
  const bool end = error == bws::error::closed || error == asio::error::eof;
  return end ? Transfer::end : Transfer::failed;
}

}  // namespace

struct WebSocketTransport::State : std::enable_shared_from_this<WebSocketTransport::State> {
  State(asio::io_context& context, std::unique_ptr<SocketTransport> from, std::string request,
        std::string unread)
      : io(context),
        header(std::move(request)),
        socket(io.get_executor(), std::move(from), std::move(unread)) {
    socket.binary(true);
    socket.auto_fragment(false);
    socket.read_message_max(0);  // received() looks, so that the peer is told in words
    socket.set_option(bws::stream_base::decorator([](bws::response_type& response) {
      response.set(beast::http::field::sec_websocket_protocol, kSubprotocol);
    }));
  }

  SocketTransport& below() { return socket.next_layer().socket(); }
  void accept(Started done);
  void satisfy();
  void receive();
  void received(error_code error);
  void refuse(wire::ErrorNumber number, std::string text);
  void complete(Transfer transfer);
  std::size_t longest() const { return wire::kMaxHeaderBytes + std::size_t{limits.payload_bytes}; }

  /// What the session waits for.
  struct Wanted {
    std::span<std::byte> bytes;
    bool some = false;
    Done done;
    std::size_t filled = 0;
  };

  asio::io_context& io;
  std::string header;
  wire::MessageLimits limits{0};
  bws::stream<SocketStream, false> socket;  ///< without permessage-deflate
  bool ready = false;
  std::string failure;
  std::optional<Wanted> wanted;
  beast::flat_buffer incoming;  ///< of the peer's message
  wire::Bytes message;          ///< for the session: the first byte, then all of it
  std::size_t taken = 0;        ///< of those
  bool is_whole = false;        ///< the message
  Fault fault;
  bool refused = false;
};

void WebSocketTransport::State::accept(Started done) {
  beast::http::request_parser<beast::http::empty_body> request;
  error_code error;
  request.put(asio::buffer(header), error);
  auto accepted = [self = shared_from_this(), done = std::move(done)](error_code problem) {
    self->ready = !problem;
    if (problem) self->failure = problem.message();
    done(problem ? Start::failed : Start::ready);
  };
  if (error) return asio::post(io, [accepted, error] { accepted(error); });
  socket.async_accept(request.get(), std::move(accepted));
}

void WebSocketTransport::State::complete(Transfer transfer) {
  asio::post(io, [done = std::move(wanted->done), transfer] { done(transfer); });
  wanted.reset();
}

void WebSocketTransport::State::satisfy() {
  const std::size_t n = std::min(wanted->bytes.size() - wanted->filled, message.size() - taken);
  std::copy_n(message.begin() + static_cast<std::ptrdiff_t>(taken), n,
              wanted->bytes.begin() + static_cast<std::ptrdiff_t>(wanted->filled));
  taken += n;
  wanted->filled += n;
  if (is_whole && taken == message.size()) {
    message.clear();
    taken = 0;
    is_whole = false;
  }
  const bool enough = wanted->filled == wanted->bytes.size() || (wanted->some && wanted->filled > 0);
  enough ? complete(Transfer::done) : receive();
}

void WebSocketTransport::State::receive() {
  constexpr std::size_t kAtOnce = 65536;
  socket.async_read_some(incoming, kAtOnce, [self = shared_from_this()](error_code error, std::size_t) {
    self->received(error);
  });
}

void WebSocketTransport::State::received(error_code error) {
  if (error) return complete(outcome(error));
  if (refused) {
    incoming.clear();
    return complete(Transfer::done);
  }
  if (!socket.got_binary())
    return refuse(wire::ErrorNumber::bad_length,
                  "a text message; allowed: binary messages, each of them an obliq message");
  if (incoming.size() > longest())
    return refuse(wire::ErrorNumber::bad_length,
                  "a message of more than " + std::to_string(longest()) +
                      " bytes; allowed: " + std::to_string(limits.payload_bytes) + " behind the header");
  const std::span bytes(static_cast<const std::byte*>(incoming.data().data()), incoming.size());
  if (message.empty() && !bytes.empty()) message.assign(1, bytes[0]);
  if (socket.is_message_done()) {
    wire::Bytes whole;
    if (auto refusal = to_binary(bytes, limits, whole))
      return refuse(refusal->number, std::move(refusal->text));
    message = std::move(whole);
    incoming.clear();
    is_whole = true;
  }
  satisfy();
}

void WebSocketTransport::State::refuse(wire::ErrorNumber number, std::string text) {
  fault = {number, std::move(text)};
  refused = true;
  message.clear();  // the session may have its first byte
  taken = 0;
  is_whole = false;
  incoming.clear();
  complete(Transfer::refused);
}

WebSocketTransport::WebSocketTransport(asio::io_context& io, std::unique_ptr<SocketTransport> socket,
                                       std::string header, std::string unread)
    : state_(std::make_shared<State>(io, std::move(socket), std::move(header), std::move(unread))) {}
WebSocketTransport::~WebSocketTransport() = default;

std::string WebSocketTransport::host() const { return state_->below().host(); }
std::string WebSocketTransport::address() const { return state_->below().address(); }
bool WebSocketTransport::is_ready() const { return state_->ready; }

std::string WebSocketTransport::description() const {
  return state_->failure.empty() ? "WebSocket, " + state_->below().description() : state_->failure;
}

void WebSocketTransport::start(Started done) { state_->accept(std::move(done)); }

void WebSocketTransport::expect(const wire::MessageLimits& limits) { state_->limits = limits; }

void WebSocketTransport::read(std::span<std::byte> bytes, bool some, Done done) {
  state_->wanted = {bytes, some, std::move(done)};
  state_->satisfy();
}

net::Transport::Fault WebSocketTransport::fault() const { return state_->fault; }

void WebSocketTransport::write(const stream::Block& message, Done done) {
  const auto plane = message.plane();
  const std::array<asio::const_buffer, 2> parts{asio::buffer(message.json_head),
                                                {plane.data(), plane.size()}};
  state_->socket.async_write(parts, [self = state_, done = std::move(done)](error_code error, std::size_t) {
    done(outcome(error));
  });
}

void WebSocketTransport::finish(Done done) {
  if (!state_->ready) return state_->below().finish(std::move(done));
  // Not Beast's async_close: it and a read that finds a fault in what the peer sends wait for each other.
  state_->socket.next_layer().end([self = state_, done = std::move(done)](Transfer put) { done(put); });
}

void WebSocketTransport::close() { state_->below().close(); }

}  // namespace obliq::websocket
