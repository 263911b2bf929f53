#include "server/http/http_server.h"

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <boost/asio.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/ssl.hpp>
#include <chrono>
#include <cmath>
#include <list>
#include <optional>
#include <utility>
#include <vector>

#include "server/http/answering.h"
#include "server/log/service_log.h"
#include "server/net/tcp.h"
#include "server/security/networks.h"
#include "server/security/security.h"
#include "terrain/base/errors.h"
#include "terrain/base/seconds.h"

namespace obliq::http {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace bhttp = boost::beast::http;
using asio::ip::tcp;
using boost::system::error_code;

namespace {

constexpr const char* kMostConnections = "http.max_connections";

using PlainStream = beast::tcp_stream;
using TlsStream = beast::ssl_stream<beast::tcp_stream>;
using Response = bhttp::response<bhttp::string_body>;
using Request = bhttp::request_parser<bhttp::empty_body>;

/// A connection that is served.
struct Connection {
  std::string peer;     ///< "127.0.0.1:50000"
  std::string network;  ///< what max_connections_per_address counts
  beast::tcp_stream* stream = nullptr;
  bool asked = false;  ///< a request of it is being answered
  bool gone = false;   ///< it is being closed, and counts no more
};

std::string_view view(beast::string_view text) { return {text.data(), text.size()}; }

Asked asked_by(const Request& parser, std::string peer) {
  const auto& request = parser.get();
  return {
      .peer = std::move(peer),
      .target = view(request.target()),
      .authorization = view(request[bhttp::field::authorization]),
      .host = request.count(bhttp::field::host) == 1 ? view(request[bhttp::field::host]) : std::string_view(),
      .origin = view(request[bhttp::field::origin]),
      .is_read = request.method() == bhttp::verb::get || request.method() == bhttp::verb::head,
      .has_body = !parser.is_done()};
}

/// What answers a header that cannot be read; none when the client is gone.
std::optional<Page> refusal(const error_code& error) {
  if (error == bhttp::error::header_limit || error == bhttp::error::buffer_overflow)
    return error_page(431, "the header is too long");
  if (error == bhttp::error::body_limit) return error_page(413, "a request has no body here");
  if (error == bhttp::error::end_of_stream || error == bhttp::error::partial_message) return std::nullopt;
  if (error.category() == bhttp::make_error_code(bhttp::error::end_of_stream).category())
    return error_page(400, "this is no HTTP request: " + error.message());
  return std::nullopt;  // timed out, reset
}

}  // namespace

struct HttpServer::State : std::enable_shared_from_this<HttpServer::State> {
  State(asio::io_context& context, asio::io_context& for_pages, HttpOptions wanted, std::vector<Route> all)
      : io(context), pages(for_pages), options(std::move(wanted)), routes(std::move(all)), acceptor(io) {
    site = {options.security && options.security->has_tls(), options.names, options.origins};
    site.names.push_back(options.address);
  }

  void listen();
  asio::awaitable<void> accept();
  asio::awaitable<void> serve(tcp::socket socket);
  asio::awaitable<void> serve_tls(TlsStream& stream, Connection& connection);
  template <typename Stream>
  asio::awaitable<void> converse(Stream& stream, Connection& connection);
  asio::awaitable<Page> page_for(const Request& request, const std::string& peer);
  template <typename Stream>
  asio::awaitable<bool> answer(Stream& stream, const Page& page, bool head, bool keep_alive,
                               unsigned version);
  asio::awaitable<void> part(PlainStream& stream);
  /// What limit leaves no room for a new connection: "http.max_connections"; empty when there is room.
  std::string limit_reached(const std::string& network) const;
  bool make_room(const std::string& network, const std::string& limit);
  void turn_away(tcp::socket socket, const std::string& limit) const;
  std::chrono::nanoseconds timeout() const { return from_seconds(options.timeout_s); }

  asio::io_context& io;
  asio::io_context& pages;
  HttpOptions options;
  std::vector<Route> routes;
  Site site;
  tcp::acceptor acceptor;
  std::string address;
  std::list<Connection> open;
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
      if (!std::exchange(in_trouble, true)) {
        spdlog::error(
            "HTTP cannot accept a connection: {}; if descriptors have run out, raise their limit "
            "(ulimit -n, LimitNOFILE=)",
            error.message());
      }
      asio::steady_timer pause(io, std::chrono::milliseconds(200));
      co_await pause.async_wait(asio::redirect_error(asio::use_awaitable, error));
      continue;
    }
    in_trouble = false;
    const std::string network = net::network_of(net::host_of_peer(socket.native_handle()));
    const std::string limit = limit_reached(network);
    if (!limit.empty() && !make_room(network, limit)) {
      turn_away(std::move(socket), limit);
      continue;
    }
    asio::co_spawn(
        io,
        [self = shared_from_this(), taken = std::move(socket)]() mutable {
          return self->serve(std::move(taken));
        },
        [self = shared_from_this()](const std::exception_ptr&) {});  // alive until then
  }
}

std::string HttpServer::State::limit_reached(const std::string& network) const {
  const auto here = [](const Connection& c) { return !c.gone; };
  if (std::ranges::count_if(open, here) >= options.max_connections) return kMostConnections;
  const auto of_host =
      std::ranges::count_if(open, [&](const Connection& c) { return here(c) && c.network == network; });
  return of_host < options.max_connections_per_address ? "" : "http.max_connections_per_address";
}

// A connection that asks nothing has no right to a place that another wants: of the host that holds most of
// them, the oldest goes.
bool HttpServer::State::make_room(const std::string& network, const std::string& limit) {
  std::vector<std::string> idle;
  for (const Connection& c : open)
    if (!c.asked && !c.gone && (limit == kMostConnections || c.network == network)) idle.push_back(c.network);
  if (idle.empty()) return false;
  const std::string most = net::most_crowded(idle);
  const auto oldest = std::ranges::find_if(
      open, [&](const Connection& c) { return !c.asked && !c.gone && c.network == most; });
  const LogFields fields{{"client", oldest->peer}};
  spdlog::warn(
      "HTTP: {} sent no request and was closed for a new connection: {} reached; raise that limit, or look "
      "at the open connections",
      oldest->peer, limit);
  oldest->gone = true;
  oldest->stream->close();
  return true;
}

// In plain words also where TLS is spoken: a handshake for each would be what a flood wants.
void HttpServer::State::turn_away(tcp::socket socket, const std::string& limit) const {
  const std::string peer = net::endpoint_of_peer(socket.native_handle());
  const LogFields fields{{"client", peer}};
  spdlog::warn(
      "HTTP: a connection from {} was refused: {} reached; raise that limit, or look at the open connections",
      peer, limit);
  bhttp::response<bhttp::string_body> answer(bhttp::status::service_unavailable, 11, limit + " reached");
  answer.set(bhttp::field::content_type, "text/plain");
  // By then connections that ask nothing have made room.
  const auto later_s = static_cast<long>(std::ceil(options.timeout_s));
  answer.set(bhttp::field::retry_after, std::to_string(later_s));
  answer.keep_alive(false);
  answer.prepare_payload();
  error_code ignored;
  socket.non_blocking(true, ignored);
  bhttp::write(socket, answer, ignored);
  socket.shutdown(tcp::socket::shutdown_send, ignored);
  // A request that has come already and was not read would make the kernel reset the connection.
  std::array<char, 4096> unwanted;
  socket.read_some(asio::buffer(unwanted), ignored);
}

// GCC 12 evaluates a co_await on the right of && or || whatever the left says: none stands there below.
asio::awaitable<void> HttpServer::State::serve(tcp::socket socket) {
  const std::string peer = net::endpoint_of_peer(socket.native_handle());
  const std::string network = net::network_of(net::host_of_peer(socket.native_handle()));
  const auto tls = options.security ? options.security->tls() : nullptr;
  std::optional<TlsStream> protected_stream;
  std::optional<PlainStream> plain_stream;
  if (tls) {
    protected_stream.emplace(std::move(socket), *tls);
  } else {
    plain_stream.emplace(std::move(socket));
  }
  PlainStream& lowest = tls ? protected_stream->next_layer() : *plain_stream;
  // Also when memory runs out half way.
  const auto place = open.insert(open.end(), {peer, network, &lowest});
  const std::shared_ptr<void> entry(nullptr, [this, place](void*) { open.erase(place); });
  try {
    if (tls) {
      co_await serve_tls(*protected_stream, *place);
    } else {
      co_await converse(*plain_stream, *place);
    }
    co_await part(lowest);
  } catch (const std::exception& e) {
    const LogFields fields{{"client", peer}};
    spdlog::error("HTTP: {}: connection ended: {}; if memory runs out, load less terrain or lower the limits",
                  peer, failure_text(e));
  }
}

asio::awaitable<void> HttpServer::State::serve_tls(TlsStream& stream, Connection& connection) {
  error_code error;
  stream.next_layer().expires_after(timeout());
  co_await stream.async_handshake(asio::ssl::stream_base::server,
                                  asio::redirect_error(asio::use_awaitable, error));
  if (error) {
    const LogFields fields{{"client", connection.peer}};
    spdlog::warn(
        "HTTP: {}: the TLS handshake failed: {}; clients need https:// and the certificate "
        "server.tls_certificate",
        connection.peer, error.message());
    co_return;
  }
  co_await converse(stream, connection);
  stream.next_layer().expires_after(std::min<std::chrono::nanoseconds>(timeout(), std::chrono::seconds(1)));
  co_await stream.async_shutdown(asio::redirect_error(asio::use_awaitable, error));
}

template <typename Stream>
asio::awaitable<void> HttpServer::State::converse(Stream& stream, Connection& connection) {
  beast::flat_buffer buffer(options.max_header_bytes);
  for (int served = 1; !stopping; ++served) {
    Request request;
    request.header_limit(options.max_header_bytes);
    error_code error;
    beast::get_lowest_layer(stream).expires_after(timeout());  // for the whole header, however it dribbles in
    co_await bhttp::async_read_header(stream, buffer, request,
                                      asio::redirect_error(asio::use_awaitable, error));
    if (error) {
      const auto page = refusal(error);
      if (page) (void)co_await answer(stream, *page, false, false, 11);
      break;
    }
    connection.asked = true;
    const bool head = request.get().method() == bhttp::verb::head;
    // A body is never read: what follows it could not be told from it.
    const bool keep = request.is_done() && request.get().keep_alive() && served < options.max_requests;
    const Page page = co_await page_for(request, connection.peer);
    const bool more = co_await answer(stream, page, head, keep, request.get().version());
    connection.asked = false;
    if (!more) break;
  }
}

asio::awaitable<Page> HttpServer::State::page_for(const Request& request, const std::string& peer) {
  const Asked asked = asked_by(request, peer);
  if (auto refused = foreign_page(asked, site)) co_return std::move(*refused);
  const auto make = [&] { return page_of(asked, routes, options.security.get()); };
  if (&pages == &io) co_return make();
  co_return co_await asio::co_spawn(
      pages, [&]() -> asio::awaitable<Page> { co_return make(); }, asio::use_awaitable);
}

// False when the connection is to end.
template <typename Stream>
asio::awaitable<bool> HttpServer::State::answer(Stream& stream, const Page& page, bool head, bool keep_alive,
                                                unsigned version) {
  Response response(static_cast<bhttp::status>(page.status), version);
  response.set(bhttp::field::content_type, page.type);
  response.set(bhttp::field::cache_control, "no-store");
  response.set("X-Content-Type-Options", "nosniff");
  response.set("Content-Security-Policy", "default-src 'self'; connect-src 'self'; frame-ancestors 'none'");
  response.set("Referrer-Policy", "no-referrer");
  if (page.status == 401) response.set(bhttp::field::www_authenticate, "Bearer");
  if (page.status == 405) response.set(bhttp::field::allow, "GET, HEAD");
  response.content_length(page.body.size());
  if (!head) response.body() = page.body;
  response.keep_alive(keep_alive);
  bhttp::response_serializer<bhttp::string_body> serializer(response);
  error_code error;
  beast::get_lowest_layer(stream).expires_after(timeout());
  if (head) {
    co_await bhttp::async_write_header(stream, serializer, asio::redirect_error(asio::use_awaitable, error));
  } else {
    co_await bhttp::async_write(stream, serializer, asio::redirect_error(asio::use_awaitable, error));
  }
  co_return !error && keep_alive;
}

// Bytes left unread when a socket is closed make the kernel reset the connection, and the peer would lose the
// answer: reads on for a while.
asio::awaitable<void> HttpServer::State::part(PlainStream& stream) {
  error_code error;
  stream.socket().shutdown(tcp::socket::shutdown_send, error);
  std::array<char, 4096> unwanted;
  stream.expires_after(std::min<std::chrono::nanoseconds>(timeout(), std::chrono::seconds(1)));
  for (int reads = 0; reads < 256 && !error; ++reads) {
    co_await stream.async_read_some(asio::buffer(unwanted), asio::redirect_error(asio::use_awaitable, error));
  }
  stream.socket().close(error);
}

HttpServer::HttpServer(asio::io_context& io, HttpOptions options, std::vector<Route> routes,
                       asio::io_context* pages)
    : state_(std::make_shared<State>(io, pages == nullptr ? io : *pages, std::move(options),
                                     std::move(routes))) {
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
  std::string host = state_->address.substr(0, state_->address.rfind(':'));
  if (host == "0.0.0.0") host = "127.0.0.1";
  if (host == "[::]") host = "[::1]";
  return fmt::format("{}://{}:{}/", state_->site.tls ? "https" : "http", host, port());
}

void HttpServer::stop() {
  asio::post(state_->io, [state = state_] {
    if (state->stopping) return;
    state->stopping = true;
    error_code ignored;
    state->acceptor.close(ignored);
    for (const Connection& connection : state->open) connection.stream->close();
  });
}

}  // namespace obliq::http
