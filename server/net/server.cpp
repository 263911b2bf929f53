#include "server/net/server.h"

#include <algorithm>
#include <boost/asio.hpp>
#include <chrono>
#include <utility>  // Boost 1.74's coroutines use std::exchange without including it

#include "server/log/log.h"
#include "server/net/panel.h"
#include "server/net/room.h"
#include "server/net/session.h"
#include "server/net/socket_transport.h"
#include "terrain/base/errors.h"
#include "terrain/base/units.h"

namespace obliq::net {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

struct Server::State {
  State(std::unique_ptr<asio::io_context> own_context, asio::io_context& context,
        const rendering::FrameRenderer& renderer, const std::vector<RadarConfig>& radars,
        const ServerOptions& options)
      : own(std::move(own_context)),
        io(context),
        room(std::make_shared<Room>(
            renderer, options, radars,
            [&context](std::function<void()> work) { asio::post(context, std::move(work)); })),
        panel(*room, [&context](std::function<void()> work) { asio::post(context, std::move(work)); }) {}

  void listen(ReservedPort reserved);
  asio::awaitable<void> accept();
  void admit(tcp::socket socket);
  void admit(std::unique_ptr<Transport> transport);
  void stop();

  std::unique_ptr<asio::io_context> own;  ///< null: another thread runs it
  asio::io_context& io;
  tcp::acceptor acceptor{io};
  asio::steady_timer limit{io};
  std::shared_ptr<Room> room;
  Panel panel;
  std::string address;
  std::uint16_t port = 0;  ///< read by any thread, also after the acceptor has closed
  std::uint64_t last_id = 0;
  bool stopping = false;
};

void Server::State::listen(ReservedPort reserved) {
  address = reserved.address();
  error_code error;
  const auto check = [&] {
    if (error) throw InputError("cannot listen on " + address + ": " + error.message());
  };
  const tcp protocol = reserved.is_v6() ? tcp::v6() : tcp::v4();
  acceptor.assign(protocol, reserved.release(), error);
  check();
  acceptor.listen(asio::socket_base::max_listen_connections, error);
  check();
  port = acceptor.local_endpoint(error).port();
  check();
}

asio::awaitable<void> Server::State::accept() {
  bool in_trouble = false;
  while (!stopping) {
    error_code error;
    tcp::socket socket = co_await acceptor.async_accept(asio::redirect_error(asio::use_awaitable, error));
    if (stopping) break;
    std::string trouble = error ? error.message() : std::string();
    if (!error) {
      try {
        admit(std::move(socket));
      } catch (const std::exception& e) {  // no memory: drop this one; later there may be some
        trouble = failure_text(e);
      }
    }
    if (!trouble.empty()) {
      // Connected clients are served as before; new ones wait.
      if (!in_trouble)
        log_error(
            "cannot accept a connection: {}; if descriptors have run out, raise their limit (ulimit -n, "
            "LimitNOFILE=)",
            trouble);
      asio::steady_timer pause(io, std::chrono::milliseconds(200));
      co_await pause.async_wait(asio::redirect_error(asio::use_awaitable, error));
    } else if (in_trouble) {
      log_info("connections are accepted again");
    }
    in_trouble = !trouble.empty();
  }
}

void Server::State::admit(tcp::socket socket) {
  error_code error;
  const ServerOptions& options = room->options();
  const auto peer = socket.remote_endpoint(error);
  if (error) return;  // gone already
  const int fd = socket.release(error);
  if (error) return;
  watch_for_dead_peer(fd, options.dead_after_s);
  admit(std::make_unique<SocketTransport>(io, fd, peer.address().is_v6(), options.security->tls()));
}

void Server::State::admit(std::unique_ptr<Transport> transport) {
  if (stopping) return;
  room->make_room_before_hello();
  start_session(io, std::move(transport), ++last_id, room);
}

void Server::State::stop() {
  if (stopping) return;
  stopping = true;
  const ServerOptions& options = room->options();
  log_info("stopping: frames in progress and queues have {:g} s to finish", options.stop_limit_s);
  // Stop rendering before the port closes, so that a closed port implies no new frames.
  room->finish();
  error_code ignored;
  acceptor.close(ignored);
  // The last message to each client needs its time as well.
  const double frames_s = std::max(0.0, options.stop_limit_s - options.stop_grace_s);
  limit.expires_after(from_seconds(frames_s));
  limit.async_wait([this](error_code error) {
    if (error) return;
    log_warning("frames are aborted after server.stop_limit_s; raise that limit to give them longer");
    room->stop();
  });
}

Server::Server(const rendering::FrameRenderer& renderer, const std::vector<RadarConfig>& radars,
               const ServerOptions& options)
    : Server(renderer, radars, options, ReservedPort(options.address, options.port)) {}

Server::Server(const rendering::FrameRenderer& renderer, const std::vector<RadarConfig>& radars,
               const ServerOptions& options, ReservedPort port) {
  auto own = std::make_unique<asio::io_context>(1);
  asio::io_context& io = *own;
  state_ = std::make_unique<State>(std::move(own), io, renderer, radars, options);
  state_->listen(std::move(port));
}

Server::Server(asio::io_context& io, const rendering::FrameRenderer& renderer,
               const std::vector<RadarConfig>& radars, const ServerOptions& options, ReservedPort port)
    : state_(std::make_unique<State>(nullptr, io, renderer, radars, options)) {
  state_->listen(std::move(port));
}

// Sessions that an io_context still holds keep the room, but the renderer goes with its owner.
Server::~Server() { state_->room->end(); }

std::uint16_t Server::port() const { return state_->port; }

Panel& Server::panel() { return state_->panel; }

std::string Server::address() const { return state_->address; }

void Server::run() {
  start([] {});
  state_->io.run();
}

security::Security::Reloaded Server::reload_security() {
  security::Security::Reloaded reloaded = state_->room->options().security->reload();
  check_credentials();
  return reloaded;
}

void Server::check_credentials() {
  asio::post(state_->io, [this] { state_->room->check_credentials(); });
}

void Server::start(std::function<void()> stopped) {
  state_->room->when_stopped([this, call = std::move(stopped)] {
    state_->limit.cancel();
    call();
  });
  asio::co_spawn(state_->io, state_->accept(), asio::detached);
  state_->room->start();
}

void Server::admit(std::unique_ptr<Transport> transport) { state_->admit(std::move(transport)); }

void Server::set_limits(const ServerLimits& limits) { state_->room->set_limits(limits); }

RoomStatistics Server::statistics() const { return state_->room->statistics(); }

void Server::stop() {
  asio::post(state_->io, [this] { state_->stop(); });
}

}  // namespace obliq::net
