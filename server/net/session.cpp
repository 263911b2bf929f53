#include "server/net/session.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <boost/asio.hpp>
#include <chrono>
#include <string>
#include <utility>  // Boost 1.74's coroutines use std::exchange without including it

#include "proto/obliq.pb.h"
#include "server/net/requests.h"
#include "server/net/room.h"

namespace obliq::net {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;
using wire::ErrorNumber;
using wire::MessageType;
using Clock = std::chrono::steady_clock;

// More answers than this waiting to be written: requests are not read any further until some have been.
constexpr std::size_t kMaxAnswersWaiting = 256;

Clock::duration seconds(double s) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(s));
}

std::string address_of(const tcp::socket& socket) {
  error_code error;
  const auto peer = socket.remote_endpoint(error);
  return error ? "?" : peer.address().to_string() + ":" + std::to_string(peer.port());
}

struct Request {
  wire::FrameHeader header;
  wire::Bytes payload;
};

// GCC 12 evaluates a co_await on the right of && or || whatever the left says: none stands there below.
class Session final : public Peer, public std::enable_shared_from_this<Session> {
 public:
  Session(tcp::socket socket, std::uint64_t session_id, std::shared_ptr<Room> room)
      : Peer(session_id, address_of(socket), room->options().queue_frames, room->options().queue_bytes),
        room_(std::move(room)),
        socket_(std::move(socket)),
        wake_(socket_.get_executor()),
        drained_(socket_.get_executor()),
        read_deadline_(socket_.get_executor()),
        write_deadline_(socket_.get_executor()),
        linger_(socket_.get_executor()) {
    name = address;
  }

  void start() {
    error_code ignored;  // comforts, not needs
    socket_.set_option(tcp::no_delay(true), ignored);
    socket_.set_option(asio::socket_base::keep_alive(true), ignored);
    room_->enter(shared_from_this());
    spawn(&Session::read_requests);
    spawn(&Session::write_outbox);
  }

  void send(MessageType type, const google::protobuf::MessageLite& message) override {
    if (closed_) return;
    outbox.push_control(wire::encode_message(type, {0, ++sequence_, wire::utc_now_ns()}, message));
    kick();
  }

  void kick() override { wake_.cancel(); }

  void fail(ErrorNumber number, const std::string& text) override {
    if (closed_ || finishing_) return;
    if (number == ErrorNumber::server_stopping) {
      spdlog::debug("{}: {}", name, text);
    } else {
      spdlog::warn("{}: {}; connection closed", name, text);
    }
    outbox.close_all_lanes(text);
    send(MessageType::error, make_error(0, number, text));
    finishing_ = true;
    // A peer that does not read does not get to hear why.
    arm(linger_, room_->options().stop_grace_s, [](Session& self) { self.close(); });
  }

 private:
  void spawn(asio::awaitable<void> (Session::*coroutine)()) {
    asio::co_spawn(
        socket_.get_executor(),
        [self = shared_from_this(), coroutine]() -> asio::awaitable<void> {
          return (self.get()->*coroutine)();
        },
        [self = shared_from_this()](const std::exception_ptr& failure) {
          // Only the machine's own troubles (no memory) come here; they cost this client, not the others.
          try {
            if (failure) std::rethrow_exception(failure);
          } catch (const std::exception& e) {
            spdlog::error("{}: {}; connection closed", self->name, e.what());
            self->close();
          }
        });
  }

  // Calls `action` after `after_s`, unless disarmed or armed anew before.
  template <typename Action>
  void arm(asio::steady_timer& timer, double after_s, Action action) {
    timer.expires_after(seconds(after_s));
    timer.async_wait([weak = weak_from_this(), &timer, action](error_code error) {
      const auto self = weak.lock();
      // A timer that has gone off may still be disarmed before its handler runs.
      if (!error && self && timer.expiry() <= Clock::now()) action(*self);
    });
  }
  static void disarm(asio::steady_timer& timer) { timer.expires_at(Clock::time_point::max()); }

  asio::awaitable<void> read_requests() {
    arm(read_deadline_, room_->options().handshake_timeout_s,
        [](Session& self) { self.fail(ErrorNumber::timed_out, "no Hello in time"); });
    Request request;
    while (co_await read_request(request)) {
      room_->handle(*this, request.header.type,
                    std::span(request.payload).first(request.header.descriptor_length));
      if (finishing_) break;
      if (greeted) disarm(read_deadline_);
      while (!closed_ && outbox.control_size() > kMaxAnswersWaiting) {
        drained_.expires_at(Clock::time_point::max());
        error_code cancelled;
        co_await drained_.async_wait(asio::redirect_error(asio::use_awaitable, cancelled));
      }
    }
    disarm(read_deadline_);
    if (finishing_) {
      // Bytes left unread when a socket is closed make the kernel reset the connection, and the peer would
      // lose the Error that tells it why: read on until it closes or the time is up.
      std::array<std::byte, 4096> unwanted;
      while (!ended_) co_await read(asio::buffer(unwanted), true);
    }
    close();
  }

  // False when there will be no further request.
  asio::awaitable<bool> read_request(Request& request) {
    std::array<std::byte, wire::kMaxHeaderBytes> head;
    const std::span<std::byte> all(head);
    // The magic alone first: what is not obliq is told so at once, however short it is.
    constexpr std::size_t kMagicBytes = 4;
    if (!co_await read(asio::buffer(head.data(), 1), true)) co_return false;
    if (greeted) {
      arm(read_deadline_, room_->options().message_timeout_s, [](Session& self) {
        self.fail(ErrorNumber::timed_out, "a message was begun and not completed in time");
      });
    }
    if (!co_await read(asio::buffer(head.data() + 1, kMagicBytes - 1))) co_return false;
    wire::FrameHeader& header = request.header;
    std::fill(head.begin() + kMagicBytes, head.end(), std::byte{0});
    const std::uint32_t limit = room_->options().max_request_bytes;
    if (wire::decode_header(all.first<wire::kHeaderBytes>(), limit, header) ==
        wire::HeaderStatus::bad_magic) {
      fail(ErrorNumber::bad_magic, wire::describe(wire::HeaderStatus::bad_magic, header, limit));
      co_return false;
    }
    if (!co_await read(asio::buffer(head.data() + kMagicBytes, wire::kHeaderBytes - kMagicBytes)))
      co_return false;
    const auto status = wire::decode_header(all.first<wire::kHeaderBytes>(), limit, header);
    if (status != wire::HeaderStatus::ok) {
      fail(status == wire::HeaderStatus::version_mismatch ? ErrorNumber::version_mismatch
                                                          : ErrorNumber::bad_length,
           wire::describe(status, header, limit));
      co_return false;
    }
    // Nothing to read is read at once.
    const std::size_t longer_by = header.header_length - wire::kHeaderBytes;
    if (!co_await read(asio::buffer(head.data() + wire::kHeaderBytes, longer_by))) co_return false;
    request.payload.resize(header.payload_length);
    if (!co_await read(asio::buffer(request.payload))) co_return false;
    if (wire::message_crc(all.first(header.header_length), request.payload) != header.crc) {
      fail(ErrorNumber::bad_crc, "a message is damaged (CRC mismatch)");
      co_return false;
    }
    if (greeted) disarm(read_deadline_);
    co_return !finishing_;
  }

  // Fills the buffer, or with `some` a part of it. False when the connection has ended.
  asio::awaitable<bool> read(asio::mutable_buffer buffer, bool some = false) {
    error_code error;
    if (some) {
      co_await socket_.async_read_some(buffer, asio::redirect_error(asio::use_awaitable, error));
    } else {
      co_await asio::async_read(socket_, buffer, asio::redirect_error(asio::use_awaitable, error));
      if (error == asio::error::eof && !finishing_) spdlog::warn("{}: left in the middle of a message", name);
    }
    // The end is reported once: a second read would wait for ever.
    if (error || closed_) ended_ = true;
    co_return !ended_;
  }

  asio::awaitable<void> write_outbox() {
    while (!closed_) {
      const BlockPtr block = outbox.pop();
      error_code error;
      if (!block) {
        if (finishing_) break;
        wake_.expires_at(Clock::time_point::max());
        co_await wake_.async_wait(asio::redirect_error(asio::use_awaitable, error));
        continue;
      }
      room_->taken(*this, *block);
      drained_.cancel();
      arm(write_deadline_, room_->options().stall_timeout_s, [](Session& self) {
        spdlog::warn("{}: reads too slowly; connection closed", self.name);
        self.close();
      });
      co_await asio::async_write(socket_, asio::buffer(block->bytes),
                                 asio::redirect_error(asio::use_awaitable, error));
      disarm(write_deadline_);
      if (error) close();
    }
    error_code ignored;
    if (!closed_) socket_.shutdown(tcp::socket::shutdown_send, ignored);
  }

  void close() {
    if (closed_) return;
    closed_ = true;
    const auto self = shared_from_this();  // the room may hold the last other reference
    spdlog::info("{} has gone", name);
    error_code ignored;
    socket_.close(ignored);
    for (asio::steady_timer* timer : {&wake_, &drained_, &read_deadline_, &write_deadline_, &linger_})
      timer->cancel();
    room_->leave(*this);
    outbox.clear();
  }

  std::shared_ptr<Room> room_;
  tcp::socket socket_;
  asio::steady_timer wake_;            ///< cancelled: there is something to write
  asio::steady_timer drained_;         ///< cancelled: something has been written
  asio::steady_timer read_deadline_;   ///< for Hello, then for each message begun
  asio::steady_timer write_deadline_;  ///< for each message written
  asio::steady_timer linger_;          ///< for the last words
  std::uint64_t sequence_ = 0;         ///< of stream 0
  bool ended_ = false;                 ///< nothing more comes from the peer
  bool finishing_ = false;             ///< nothing is read any more; what is queued is written
  bool closed_ = false;
};

}  // namespace

void start_session(asio::io_context& io, int socket_fd, bool is_ipv6, std::uint64_t id,
                   const std::shared_ptr<Room>& room) {
  tcp::socket socket(io, is_ipv6 ? tcp::v6() : tcp::v4(), socket_fd);
  std::make_shared<Session>(std::move(socket), id, room)->start();
}

}  // namespace obliq::net
