#include "server/http/http_server.h"

#include <fmt/core.h>

#include <algorithm>
#include <boost/asio.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <chrono>
#include <cmath>
#include <list>
#include <memory>
#include <optional>
#include <sstream>
#include <utility>
#include <vector>

#include "server/http/answering.h"
#include "server/log/log.h"
#include "server/log/service_log.h"
#include "server/net/requests/result_of.h"
#include "server/net/socket_transport.h"
#include "server/net/tcp.h"
#include "server/security/networks.h"
#include "server/security/security.h"
#include "terrain/base/errors.h"
#include "terrain/base/units.h"

namespace obliq::http {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace bhttp = boost::beast::http;
using asio::ip::tcp;
using boost::system::error_code;

namespace {

constexpr const char* kMostConnections = "http.max_connections";
using net::SocketTransport;
using net::Transport;
using Request = bhttp::request_parser<bhttp::empty_body>;
using Clock = asio::steady_timer::clock_type;

/// A connection that is served.
struct Connection : std::enable_shared_from_this<Connection> {
  Connection(asio::io_context& io, std::unique_ptr<SocketTransport> from)
      : peer(from->address()),
        network(security::network_of(from->host())),
        transport(std::move(from)),
        deadline(io) {}

  void close() {
    if (transport) transport->close();
  }
  /// Closes it after so long, unless that is called again before.
  void limit(std::chrono::nanoseconds time) {
    deadline.expires_after(time);
    deadline.async_wait([weak = weak_from_this()](error_code error) {
      const auto self = weak.lock();
      // A timer that has gone off may still be set anew before its handler runs.
      if (!error && self && self->deadline.expiry() <= Clock::now()) self->close();
    });
  }

  const std::string peer;                      ///< "127.0.0.1:50000"
  const std::string network;                   ///< what max_connections_per_address counts
  std::unique_ptr<SocketTransport> transport;  ///< null once it has become something else than HTTP
  asio::steady_timer deadline;
  bool asked = false;  ///< a request of it is being answered
  bool gone = false;   ///< it is being closed, and counts no more
};
using ConnectionPtr = std::shared_ptr<Connection>;

struct Got {
  Transport::Transfer transfer{};
  std::size_t bytes = 0;
};

asio::awaitable<Got> read_some(SocketTransport& from, std::span<std::byte> bytes) {
  co_return co_await net::result_of<Got>([&from, bytes](auto done) {
    from.read_some(bytes, [done](Transport::Transfer transfer, std::size_t n) { done({transfer, n}); });
  });
}

void warn_of_handshake(const std::string& peer, const std::string& why) {
  const LogFields fields{{"client", peer}};
  log_warning(
      "HTTP: {}: the TLS handshake failed: {}; clients need https:// and the certificate "
      "server.tls_certificate",
      peer, why);
}

std::string_view view(beast::string_view text) { return {text.data(), text.size()}; }

Asked asked_by(const Request& parser, const std::string& peer) {
  const auto& request = parser.get();
  const auto only = [&](bhttp::field name) {
    return request.count(name) == 1 ? view(request[name]) : std::string_view();
  };
  return {.peer = peer,
          .target = view(request.target()),
          .authorization = view(request[bhttp::field::authorization]),
          .host = only(bhttp::field::host),
          .origin = only(bhttp::field::origin),
          .has_origins = request.count(bhttp::field::origin) > 1,
          .protocols = view(request[bhttp::field::sec_websocket_protocol]),
          .key = only(bhttp::field::sec_websocket_key),
          .is_read = request.method() == bhttp::verb::get || request.method() == bhttp::verb::head,
          .has_body = !parser.is_done(),
          .is_upgrade = beast::websocket::is_upgrade(request)};
}

}  // namespace

struct HttpServer::State : std::enable_shared_from_this<HttpServer::State> {
  State(asio::io_context& context, HttpOptions wanted, std::vector<Route> all, std::optional<Upgrade> other)
      : io(context),
        options(std::move(wanted)),
        routes(std::move(all)),
        upgrade(std::move(other)),
        acceptor(io) {
    site = {options.security && options.security->has_tls(), options.names, options.origins};
    site.names.push_back(options.address);
  }

  void listen();
  asio::awaitable<void> accept();
  /// Null: the peer has gone already, or there is no place for it.
  ConnectionPtr admit(tcp::socket socket);
  asio::awaitable<void> serve(ConnectionPtr connection);
  asio::awaitable<void> converse(Connection& connection);
  asio::awaitable<error_code> read_header(Connection& connection, beast::flat_buffer& buffer,
                                          Request& request) const;
  asio::awaitable<bool> answer(Connection& connection, const Page& page, bool head, bool keep_alive,
                               unsigned version) const;
  asio::awaitable<void> part(Connection& connection) const;
  /// What limit leaves no room for a new connection: "http.max_connections"; empty when there is room.
  std::string limit_reached(const std::string& network) const;
  bool make_room(const std::string& network, const std::string& limit);
  void turn_away(tcp::socket socket, const std::string& limit) const;
  std::chrono::nanoseconds timeout() const { return from_seconds(options.timeout_s); }
  std::chrono::nanoseconds last_timeout() const {
    return std::min<std::chrono::nanoseconds>(timeout(), std::chrono::seconds(1));
  }

  asio::io_context& io;
  HttpOptions options;
  std::vector<Route> routes;
  std::optional<Upgrade> upgrade;
  Site site;
  tcp::acceptor acceptor;
  std::string address;
  std::list<ConnectionPtr> open;
  bool stopping = false;
};

void HttpServer::State::listen() {
  try {
    net::ReservedPort reserved(options.address, options.port);
    address = reserved.address();
    acceptor.assign(reserved.is_v6() ? tcp::v6() : tcp::v4(), reserved.release());
    acceptor.listen(asio::socket_base::max_listen_connections);
  } catch (const std::exception& e) {
    throw InputError(
        fmt::format("http.port {}, http.address {}: {}; choose another port, http.port=0 (any free one) or "
                    "http.enabled=false",
                    options.port, options.address, e.what()));
  }
}

asio::awaitable<void> HttpServer::State::accept() {
  bool in_trouble = false;
  while (!stopping) {
    error_code error;
    tcp::socket socket = co_await acceptor.async_accept(asio::redirect_error(asio::use_awaitable, error));
    if (stopping) break;
    if (error) {
      if (!std::exchange(in_trouble, true))
        log_error(
            "HTTP cannot accept a connection: {}; if descriptors have run out, raise their limit "
            "(ulimit -n, LimitNOFILE=)",
            error.message());
      asio::steady_timer pause(io, std::chrono::milliseconds(200));
      co_await pause.async_wait(asio::redirect_error(asio::use_awaitable, error));
      continue;
    }
    in_trouble = false;
    const ConnectionPtr connection = admit(std::move(socket));
    if (!connection) continue;
    asio::co_spawn(
        io, [self = shared_from_this(), connection] { return self->serve(connection); },
        [self = shared_from_this()](const std::exception_ptr&) {});  // alive until then
  }
}

ConnectionPtr HttpServer::State::admit(tcp::socket socket) {
  const std::string network = security::network_of(net::host_of_peer(socket.native_handle()));
  const std::string limit = limit_reached(network);
  if (!limit.empty() && !make_room(network, limit)) {
    turn_away(std::move(socket), limit);
    return nullptr;
  }
  error_code error;
  const bool is_v6 = socket.local_endpoint(error).address().is_v6();
  if (error) return nullptr;
  const int fd = socket.release(error);
  if (error) return nullptr;
  net::watch_for_dead_peer(fd, options.dead_after_s);
  return std::make_shared<Connection>(
      io,
      std::make_unique<SocketTransport>(io, fd, is_v6, options.security ? options.security->tls() : nullptr));
}

std::string HttpServer::State::limit_reached(const std::string& network) const {
  const auto here = [](const ConnectionPtr& c) { return !c->gone; };
  if (std::ranges::count_if(open, here) >= options.max_connections) return kMostConnections;
  const auto of_host =
      std::ranges::count_if(open, [&](const ConnectionPtr& c) { return here(c) && c->network == network; });
  return of_host < options.max_connections_per_address ? "" : "http.max_connections_per_address";
}

// A connection that asks nothing has no right to a place that another wants: of the host that holds most of
// them, the oldest goes.
bool HttpServer::State::make_room(const std::string& network, const std::string& limit) {
  std::vector<std::string> idle;
  for (const ConnectionPtr& c : open)
    if (!c->asked && !c->gone && (limit == kMostConnections || c->network == network))
      idle.push_back(c->network);
  if (idle.empty()) return false;
  const std::string most = security::most_crowded(idle);
  const ConnectionPtr oldest = *std::ranges::find_if(
      open, [&](const ConnectionPtr& c) { return !c->asked && !c->gone && c->network == most; });
  const LogFields fields{{"client", oldest->peer}};
  log_warning(
      "HTTP: {} sent no request and was closed for a new connection: {} reached; raise that limit, or look "
      "at the open connections",
      oldest->peer, limit);
  oldest->gone = true;
  oldest->close();
  return true;
}

// In plain words also where TLS is spoken: a handshake for each would be what a flood wants.
void HttpServer::State::turn_away(tcp::socket socket, const std::string& limit) const {
  const std::string peer = net::endpoint_of_peer(socket.native_handle());
  const LogFields fields{{"client", peer}};
  log_warning(
      "HTTP: a connection from {} was refused: {} reached; raise that limit, or look at the open connections",
      peer, limit);
  Page page = error_page(503, limit + " reached");
  // By then connections that ask nothing have made room.
  page.retry_after_s = static_cast<int>(std::ceil(options.timeout_s));
  error_code ignored;
  socket.non_blocking(true, ignored);
  asio::write(socket, asio::buffer(response_text(page, false, false, 11)), ignored);
  socket.shutdown(tcp::socket::shutdown_send, ignored);
  // A request that has come already and was not read would make the kernel reset the connection.
  std::array<char, 4096> unwanted;
  socket.read_some(asio::buffer(unwanted), ignored);
}

// GCC 12 bug: it always evaluates a co_await on the right of && or ||. Never use one there.
asio::awaitable<void> HttpServer::State::serve(ConnectionPtr connection) {
  Connection& c = *connection;
  // Also when memory runs out half way.
  const auto place = open.insert(open.end(), connection);
  const std::shared_ptr<void> entry(nullptr, [this, place](void*) { open.erase(place); });
  try {
    c.limit(timeout());
    const auto start =
        co_await net::result_of<Transport::Start>([&c](auto done) { c.transport->start(std::move(done)); });
    if (start == Transport::Start::ready) {
      co_await converse(c);
    } else {
      const bool plain = start == Transport::Start::plain_peer;
      warn_of_handshake(c.peer, plain ? "it does not speak TLS" : c.transport->description());
      if (!plain) co_return c.close();
      (void)co_await answer(c, error_page(400, "this port speaks HTTPS only: https://"), false, false, 11);
    }
    if (c.transport) co_await part(c);
  } catch (const std::exception& e) {
    const LogFields fields{{"client", c.peer}};
    log_error("HTTP: {}: connection ended: {}; if memory runs out, load less terrain or lower the limits",
              c.peer, failure_text(e));
  }
}

asio::awaitable<void> HttpServer::State::converse(Connection& connection) {
  beast::flat_buffer buffer(options.max_header_bytes);
  for (int served = 1; !stopping; ++served) {
    Request request;
    request.header_limit(options.max_header_bytes);
    connection.limit(timeout());  // for the whole header, however it dribbles in
    const error_code error = co_await read_header(connection, buffer, request);
    if (error) {
      const auto page = header_refusal(error);
      if (page) (void)co_await answer(connection, *page, false, false, 11);
      break;
    }
    connection.asked = true;
    const Asked asked = asked_by(request, connection.peer);
    std::optional<Page> page = foreign_page(asked, site);
    if (!page && upgrade && path_of(asked.target) == upgrade->path) {
      page = upgrade_refusal(asked, *upgrade);
      if (!page) {
        connection.deadline.cancel();
        std::ostringstream header;
        header << request.get().base();
        upgrade->take(std::move(connection.transport), header.str(), beast::buffers_to_string(buffer.data()));
        co_return;
      }
    }
    if (!page) page = page_of(asked, routes, options.security.get());
    const bool head = request.get().method() == bhttp::verb::head;
    // A body is never read: what follows it could not be told from it.
    const bool keep = request.is_done() && request.get().keep_alive() && served < options.max_requests;
    const bool more = co_await answer(connection, *page, head, keep, request.get().version());
    connection.asked = false;
    if (!more) break;
  }
}

asio::awaitable<error_code> HttpServer::State::read_header(Connection& connection, beast::flat_buffer& buffer,
                                                           Request& request) const {
  constexpr std::size_t kAtOnce = 4096;
  while (true) {
    error_code error = bhttp::error::need_more;
    if (buffer.size() > 0) buffer.consume(request.put(buffer.data(), error));
    if (error != bhttp::error::need_more) co_return error;
    const std::size_t room = std::min(kAtOnce, buffer.max_size() - buffer.size());
    if (room == 0) co_return bhttp::error::header_limit;
    const auto space = buffer.prepare(room);
    const Got got =
        co_await read_some(*connection.transport, {static_cast<std::byte*>(space.data()), space.size()});
    if (got.transfer != Transport::Transfer::done) co_return bhttp::error::end_of_stream;
    buffer.commit(got.bytes);
  }
}

// False when the connection is to end.
asio::awaitable<bool> HttpServer::State::answer(Connection& connection, const Page& page, bool head,
                                                bool keep_alive, unsigned version) const {
  const std::string text = response_text(page, head, keep_alive, version);
  connection.limit(timeout());
  const auto put = co_await net::result_of<Transport::Transfer>(
      [&](auto done) { connection.transport->write(std::as_bytes(std::span(text)), std::move(done)); });
  co_return put == Transport::Transfer::done ? keep_alive : false;
}

// Bytes left unread when a socket is closed make the kernel reset the connection, and the peer would lose the
// answer: reads on for a while.
asio::awaitable<void> HttpServer::State::part(Connection& connection) const {
  connection.limit(last_timeout());
  Got got{co_await net::result_of<Transport::Transfer>(
      [&](auto done) { connection.transport->finish(std::move(done)); })};
  std::array<std::byte, 4096> unwanted;
  for (int reads = 0; reads < 256 && got.transfer == Transport::Transfer::done; ++reads)
    got = co_await read_some(*connection.transport, unwanted);
  connection.close();
}

HttpServer::HttpServer(asio::io_context& io, HttpOptions options, std::vector<Route> routes,
                       std::optional<Upgrade> upgrade)
    : state_(std::make_shared<State>(io, std::move(options), std::move(routes), std::move(upgrade))) {
  state_->listen();
  asio::co_spawn(
      io, [state = state_] { return state->accept(); }, asio::detached);
}

HttpServer::~HttpServer() { stop(); }

std::uint16_t HttpServer::port() const {
  const std::string& text = state_->address;
  return static_cast<std::uint16_t>(std::stoi(text.substr(text.rfind(':') + 1)));
}

const std::string& HttpServer::address() const { return state_->address; }

std::string HttpServer::url() const {
  // A server that listens on all addresses is found at the loopback.
  const std::string bound = state_->address.substr(0, state_->address.rfind(':'));
  const std::string host = bound == "0.0.0.0" ? "127.0.0.1" : bound == "[::]" ? "[::1]" : bound;
  return fmt::format("{}://{}:{}/", state_->site.tls ? "https" : "http", host, port());
}

void HttpServer::stop() {
  asio::post(state_->io, [state = state_] {
    if (state->stopping) return;
    state->stopping = true;
    error_code ignored;
    state->acceptor.close(ignored);
    for (const ConnectionPtr& connection : state->open) connection->close();
  });
}

}  // namespace obliq::http
