#include "server/net/session.h"

#include <algorithm>
#include <array>
#include <boost/asio.hpp>
#include <chrono>
#include <string>
#include <utility>  // Boost 1.74's coroutines use std::exchange without including it

#include "proto/obliq.pb.h"
#include "server/log/log.h"
#include "server/log/service_log.h"
#include "server/net/peer.h"
#include "server/net/requests/requests.h"
#include "server/net/requests/result_of.h"
#include "server/net/room.h"
#include "server/net/transport.h"
#include "terrain/base/errors.h"
#include "terrain/base/units.h"

namespace obliq::net {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;
using wire::ErrorNumber;
using wire::MessageType;
using Clock = std::chrono::steady_clock;

// With more answers than this waiting to be written, no request is read.
constexpr std::size_t kMaxAnswersWaiting = 256;
// A peer with more messages than this waiting (answers, and news of what others do) is not reading.
constexpr std::size_t kMaxControlWaiting = 4 * kMaxAnswersWaiting;

// How a TLS client begins: a handshake record of version 3.x (RFC 8446 section 5.1).
constexpr std::byte kTlsRecord[] = {std::byte{22}, std::byte{3}};

// A deadline noticed this late shows that this process stood still (stopped, frozen, swapped out), not the
// peer: what came meanwhile has not been read, so the time begins anew.
constexpr Clock::duration kStoodStill = std::chrono::milliseconds(500);

/// Resumes the coroutine that waits for it.
class Signal {
 public:
  explicit Signal(asio::io_context& io) : timer_(io, Clock::time_point::max()) {}
  void raise() { timer_.cancel(); }
  asio::awaitable<void> wait() {
    error_code cancelled;
    timer_.expires_at(Clock::time_point::max());
    co_await timer_.async_wait(asio::redirect_error(asio::use_awaitable, cancelled));
  }

 private:
  asio::steady_timer timer_;
};

struct Request {
  wire::MessageHeader header;
  wire::Bytes payload;
};

// GCC 12 bug: it always evaluates a co_await on the right of && or ||. Never use one there.
class Session final : public Peer, public std::enable_shared_from_this<Session> {
 public:
  Session(asio::io_context& io, std::unique_ptr<Transport> transport, std::uint64_t session_id,
          std::shared_ptr<Room> room)
      : Peer(session_id, transport->host(), transport->address(), transport->takes_json(),
             room->options().queue_frames, room->options().queue_bytes),
        room_(std::move(room)),
        io_(io),
        transport_(std::move(transport)),
        queued_(io),
        written_(io),
        read_deadline_(io),
        write_deadline_(io),
        silence_(io) {
    name = address;
  }

  void start() {
    room_->enter(shared_from_this());
    spawn(&Session::serve);
  }

  using Peer::send;
  void send(MessageType type, const google::protobuf::Message& message,
            std::span<const std::byte> plane) override {
    if (phase_ == Phase::closed) return;
    if (outbox.control_size() > kMaxControlWaiting) {
      log_warning("{}: does not read its messages; connection closed", name);
      return close();
    }
    outbox.push_control(
        stream::block_for_one(type, {0, ++sequence_, wire::utc_now_ns()}, message, takes_json, plane));
    kick();
  }

  void kick() override { queued_.raise(); }

  void fail(ErrorNumber number, const std::string& text) override {
    if (phase_ >= Phase::ending) return;
    {
      const LogFields fields{{"client", name}, {"error", std::int64_t{static_cast<std::uint32_t>(number)}}};
      const bool expected = number == ErrorNumber::server_stopping;
      log_line(expected ? LogLevel::debug : LogLevel::warning, "{}: {}; connection closed{}", name, text,
               advice(number));
    }
    // Without TLS there is no way to say it.
    if (!transport_->is_ready()) return close();
    outbox.close_all_queues(text);
    send(MessageType::error, make_error(0, number, text));
    if (phase_ == Phase::closed) return;
    phase_ = Phase::ending;
    // Closes after stop_grace_s even if the peer has not read the final Error.
    arm(read_deadline_, room_->options().stop_grace_s, [](Session& self) { self.close(); });
  }

  void finish(ErrorNumber number, const std::string& text) override {
    if (phase_ >= Phase::ending) return;
    if (!transport_->is_ready()) return fail(number, text);
    last_words_ = {number, text};
    kick();
  }

  void drop() override { close(); }

 private:
  /// Each leads to the next, or to `closed` at once.
  enum class Phase {
    greeting,  ///< until Hello
    serving,   ///< requests are read and answered; heartbeats go out
    ending,    ///< no request is read any more; what is queued is written, the last Error behind it
    closed,
  };

  void spawn(asio::awaitable<void> (Session::*coroutine)()) {
    asio::co_spawn(
        io_,
        [self = shared_from_this(), coroutine]() -> asio::awaitable<void> {
          return (self.get()->*coroutine)();
        },
        [self = shared_from_this()](const std::exception_ptr& failure) {
          // Only failures of this machine (no memory) come here; they cost this client, not the others.
          try {
            if (failure) std::rethrow_exception(failure);
          } catch (const std::exception& e) {
            const LogFields fields{{"client", self->name}};
            log_error(
                "{}: {}; connection closed; if memory runs out, lower server.max_clients, "
                "server.queue_frames or server.max_bins",
                self->name, failure_text(e));
            self->close();
          }
        });
  }

  // Calls `action` after `after_s`, unless disarmed or armed anew before.
  template <typename Action>
  void arm(asio::steady_timer& timer, double after_s, Action action) {
    timer.expires_after(from_seconds(after_s));
    timer.async_wait([weak = weak_from_this(), &timer, after_s, action](error_code error) {
      const auto self = weak.lock();
      const auto now = Clock::now();
      // A timer that has gone off may still be disarmed before its handler runs.
      if (error || !self || timer.expiry() > now) return;
      if (now - timer.expiry() > kStoodStill) return self->arm(timer, after_s, action);
      action(*self);
    });
  }
  static void disarm(asio::steady_timer& timer) { timer.expires_at(Clock::time_point::max()); }

  asio::awaitable<void> serve() {
    arm(read_deadline_, room_->options().handshake_timeout_s,
        [](Session& self) { self.fail(ErrorNumber::timed_out, "no Hello in time"); });
    const Transport::Start start =
        co_await result_of<Transport::Start>([this](auto done) { transport_->start(std::move(done)); });
    if (start == Transport::Start::failed && phase_ != Phase::closed) {
      const LogFields fields{{"client", name}};
      log_warning(
          "{}: TLS handshake failed: {}; connection closed; an obliq client must trust "
          "server.tls_certificate",
          name, transport_->description());
    }
    if (phase_ == Phase::closed || start == Transport::Start::failed) co_return close();
    log_debug("{}: connected, {}", name, transport_->description());
    spawn(&Session::write_outbox);
    if (start == Transport::Start::plain_peer)
      fail(ErrorNumber::tls_required, "this server speaks TLS only (obliq: --tls)");
    co_await read_requests();
  }

  asio::awaitable<void> read_requests() {
    Request request;
    while (phase_ < Phase::ending) {
      if (!co_await read_request(request)) break;
      room_->handle(*this, request.header.type,
                    std::span(request.payload).first(request.header.descriptor_length));
      if (phase_ == Phase::greeting && greeted) {
        phase_ = Phase::serving;
        disarm(read_deadline_);
        spawn(&Session::break_silence);
      }
      while (phase_ < Phase::ending && outbox.control_size() > kMaxAnswersWaiting) co_await written_.wait();
    }
    if (phase_ == Phase::ending) {
      // Bytes left unread when a socket is closed make the kernel reset the connection, and the peer would
      // lose the Error that tells it why: read on until it closes or the time is up.
      std::array<std::byte, 4096> unwanted;
      while (!peer_ended_) co_await read(unwanted, true);
    }
    close();
  }

  // Of the next one.
  wire::MessageLimits request_limits() const {
    const ServerOptions& options = room_->options();
    const auto most = static_cast<std::uint32_t>(options.max_request_bytes);
    return {phase_ == Phase::greeting ? std::min(most, options.max_hello_bytes) : most,
            options.max_descriptor_bytes};
  }

  // False when there will be no further request.
  asio::awaitable<bool> read_request(Request& request) {
    std::array<std::byte, wire::kMaxHeaderBytes> head;
    const std::span<std::byte> all(head);
    // The magic alone first: a peer of another protocol is told at once, however little it sends.
    constexpr std::size_t kMagicBytes = 4;
    transport_->expect(request_limits());
    if (!co_await read(all.first(1), true)) co_return false;
    const wire::MessageLimits limits = request_limits();  // they may have changed meanwhile
    if (phase_ == Phase::serving)
      arm(read_deadline_, room_->options().message_timeout_s,
          [](Session& self) { self.fail(ErrorNumber::timed_out, "a message was not completed in time"); });
    if (!co_await read(all.subspan(1, kMagicBytes - 1))) co_return false;
    wire::MessageHeader& header = request.header;
    std::fill(head.begin() + kMagicBytes, head.end(), std::byte{0});
    if (wire::decode_header(all.first<wire::kHeaderBytes>(), limits, header) ==
        wire::HeaderStatus::bad_magic) {
      const bool tls = head[0] == kTlsRecord[0] && head[1] == kTlsRecord[1];
      fail(ErrorNumber::bad_magic, tls ? "this port does not speak TLS (obliq: leave out --tls)"
                                       : wire::describe(wire::HeaderStatus::bad_magic, header, limits));
      co_return false;
    }
    if (!co_await read(all.subspan(kMagicBytes, wire::kHeaderBytes - kMagicBytes))) co_return false;
    const auto status = wire::decode_header(all.first<wire::kHeaderBytes>(), limits, header);
    if (status != wire::HeaderStatus::ok) {
      fail(status == wire::HeaderStatus::version_mismatch ? ErrorNumber::version_mismatch
                                                          : ErrorNumber::bad_length,
           wire::describe(status, header, limits));
      co_return false;
    }
    // An empty read returns at once.
    const std::size_t longer_by = header.header_length - wire::kHeaderBytes;
    if (!co_await read(all.subspan(wire::kHeaderBytes, longer_by))) co_return false;
    request.payload.resize(header.payload_length);
    if (!co_await read(request.payload)) co_return false;
    if (wire::message_crc(all.first(header.header_length), request.payload) != header.crc) {
      fail(ErrorNumber::bad_crc, "a message is damaged (CRC mismatch)");
      co_return false;
    }
    if (phase_ == Phase::serving) disarm(read_deadline_);
    co_return phase_ < Phase::ending;
  }

  // Fills the buffer, or with `some` a part of it. False when the connection has ended.
  asio::awaitable<bool> read(std::span<std::byte> buffer, bool some = false) {
    const Transport::Transfer got = co_await result_of<Transport::Transfer>(
        [=, this](auto done) { transport_->read(buffer, some, std::move(done)); });
    if (got == Transport::Transfer::refused) {
      const Transport::Fault fault = transport_->fault();
      fail(fault.number, fault.text);
      co_return false;
    }
    if (!some && got == Transport::Transfer::end && phase_ < Phase::ending) {
      const LogFields fields{{"client", name}};
      log_warning("{}: left in the middle of a message; if that repeats, check its network", name);
    }
    last_read_ = Clock::now();
    // The end is reported once: a second read would wait for ever.
    if (got != Transport::Transfer::done || phase_ == Phase::closed) peer_ended_ = true;
    co_return !peer_ended_;
  }

  asio::awaitable<void> write_outbox() {
    while (phase_ != Phase::closed) {
      if (phase_ < Phase::ending) room_->tell_news(*this);
      const stream::BlockPtr block = outbox.pop();
      if (!block) {
        if (phase_ == Phase::ending) break;
        if (last_words_.number != ErrorNumber::none) {
          fail(last_words_.number, last_words_.text);
          continue;
        }
        co_await queued_.wait();
        continue;
      }
      room_->taken(*this, *block);
      written_.raise();
      arm(write_deadline_, room_->options().stall_timeout_s, [](Session& self) {
        const LogFields fields{{"client", self.name}};
        log_warning("{}: reads too slowly; connection closed{}", self.name,
                    advice(ErrorNumber::reads_too_slowly));
        self.close();
      });
      const Transport::Transfer put = co_await result_of<Transport::Transfer>(
          [&](auto done) { transport_->write(*block, std::move(done)); });
      disarm(write_deadline_);
      last_written_ = Clock::now();
      if (put != Transport::Transfer::done) close();
    }
    if (phase_ == Phase::closed) co_return;
    co_await result_of<Transport::Transfer>([this](auto done) { transport_->finish(std::move(done)); });
  }

  // Sends heartbeats, so that both sides and the network between them know that the other is there.
  asio::awaitable<void> break_silence() {
    const ServerOptions& options = room_->options();
    const auto period = from_seconds(options.heartbeat_s);
    const bool patient = options.idle_timeout_s <= 0;
    Clock::time_point last_beat = Clock::now();
    while (phase_ == Phase::serving) {
      const auto now = Clock::now();
      const auto patience_ends =
          patient ? Clock::time_point::max() : last_read_ + from_seconds(options.idle_timeout_s);
      if (now >= patience_ends) {
        fail(ErrorNumber::idle, "the client sent nothing for idle_timeout_s");
        break;
      }
      const auto beat = std::max(std::min(last_read_, last_written_), last_beat) + period;
      if (now >= beat) {
        last_beat = now;
        // Messages that wait to be written do as well.
        if (outbox.control_size() == 0) {
          wire::Heartbeat heartbeat;
          heartbeat.set_answer_wanted(true);
          send(MessageType::heartbeat, heartbeat);
        }
        continue;
      }
      silence_.expires_at(std::min(beat, patience_ends));
      error_code cancelled;
      co_await silence_.async_wait(asio::redirect_error(asio::use_awaitable, cancelled));
      if (Clock::now() - silence_.expiry() > kStoodStill) last_read_ = Clock::now();
    }
  }

  void close() {
    if (phase_ == Phase::closed) return;
    phase_ = Phase::closed;
    log_end(*this);
    transport_->close();
    queued_.raise();
    written_.raise();
    for (auto* timer : {&read_deadline_, &write_deadline_, &silence_}) timer->cancel();
    room_->leave(shared_from_this());
  }

  std::shared_ptr<Room> room_;
  asio::io_context& io_;
  std::unique_ptr<Transport> transport_;
  Phase phase_ = Phase::greeting;
  Signal queued_;                      ///< there is something to write
  Signal written_;                     ///< the outbox has become shorter
  asio::steady_timer read_deadline_;   ///< for Hello, then for each message begun, then for the last words
  asio::steady_timer write_deadline_;  ///< for each message written
  asio::steady_timer silence_;         ///< until the next heartbeat, or the end of patience
  Clock::time_point last_read_ = Clock::now();
  Clock::time_point last_written_ = Clock::now();
  std::uint64_t sequence_ = 0;  ///< of stream 0
  struct LastWords {
    ErrorNumber number = ErrorNumber::none;
    std::string text;
  };
  LastWords last_words_;     ///< sent when the outbox is empty, unless there are none
  bool peer_ended_ = false;  ///< nothing more comes from the peer
};

}  // namespace

void start_session(asio::io_context& io, std::unique_ptr<Transport> transport, std::uint64_t id,
                   const std::shared_ptr<Room>& room) {
  std::make_shared<Session>(io, std::move(transport), id, room)->start();
}

}  // namespace obliq::net
