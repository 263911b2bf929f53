#include "server/http/answering.h"

#include <fmt/core.h>

#include <algorithm>
#include <boost/asio/ip/address.hpp>
#include <boost/beast/core/string.hpp>
#include <boost/beast/http.hpp>
#include <sstream>
#include <utility>

#include "server/log/log.h"
#include "server/log/service_log.h"
#include "server/security/security.h"
#include "terrain/base/text.h"

namespace obliq::http {

namespace bhttp = boost::beast::http;

namespace {

bool same(std::string_view a, std::string_view b) {
  return boost::beast::iequals({a.data(), a.size()}, {b.data(), b.size()});
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// "[::1]:7480" without its port; empty when what stands behind the colon is none.
std::string_view without_port(std::string_view host) {
  const std::size_t bracket = host.rfind(']');
  const std::size_t colon = host.rfind(':');
  if (colon == std::string_view::npos || (bracket != std::string_view::npos && colon < bracket)) return host;
  return std::ranges::all_of(host.substr(colon + 1), is_digit) ? host.substr(0, colon) : std::string_view();
}

bool is_address(std::string_view host) {
  boost::system::error_code error;
  if (host.starts_with('[') && host.ends_with(']')) {
    (void)boost::asio::ip::make_address_v6(std::string(host.substr(1, host.size() - 2)), error);
  } else {
    (void)boost::asio::ip::make_address_v4(std::string(host), error);
  }
  return !error;
}

bool may_read(const Route& route, std::string_view authorization, const security::Security* security) {
  if (route.is_open || security == nullptr || !security->needs_token()) return true;
  constexpr std::string_view kScheme = "Bearer ";  // RFC 6750; schemes are written in any case (RFC 9110)
  const std::string_view scheme = authorization.substr(0, kScheme.size());
  if (!boost::beast::iequals({scheme.data(), scheme.size()}, {kScheme.data(), kScheme.size()})) return false;
  return security->grant(authorization.substr(kScheme.size())).has_value();  // any role may look
}

/// Whether a list such as "chat, obliq.v1.json" names it.
bool names(std::string_view list, std::string_view wanted) {
  while (!list.empty()) {
    const std::string_view one = list.substr(0, list.find(','));
    list.remove_prefix(std::min(one.size() + 1, list.size()));
    if (trimmed(one) == wanted) return true;
  }
  return false;
}

/// 16 bytes of base64 (RFC 6455 section 4.1).
bool is_key(std::string_view key) {
  constexpr std::string_view kPadding = "==";
  constexpr std::size_t kLetters = 22;
  const auto is_letter = [](char c) {
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '+' || c == '/';
  };
  return key.size() == kLetters + kPadding.size() && key.ends_with(kPadding) &&
         std::ranges::all_of(key.substr(0, kLetters), is_letter);
}

/// Of a field that a stranger wrote, what a log line and an answer show.
std::string shown(std::string_view field) {
  constexpr std::size_t kMost = 200;
  return printable_text(field, kMost);
}

}  // namespace

std::string_view path_of(std::string_view target) {
  constexpr std::string_view kMark = "://";
  const std::size_t mark = target.starts_with('/') ? std::string_view::npos : target.find(kMark);
  if (mark != std::string_view::npos) {
    const std::size_t path = target.find_first_of("/?", mark + kMark.size());
    target = path == std::string_view::npos || target[path] == '?' ? "/" : target.substr(path);
  }
  return target.substr(0, target.find('?'));
}

std::optional<Page> header_refusal(const boost::system::error_code& error) {
  if (error == bhttp::error::header_limit || error == bhttp::error::buffer_overflow)
    return error_page(431, "the header is too long");
  if (error == bhttp::error::body_limit) return error_page(413, "a request has no body here");
  if (error == bhttp::error::end_of_stream || error == bhttp::error::partial_message) return std::nullopt;
  if (error.category() == bhttp::make_error_code(bhttp::error::end_of_stream).category())
    return error_page(400, "this is no HTTP request: " + error.message());
  return std::nullopt;  // timed out, reset
}

std::optional<Page> upgrade_refusal(const Asked& asked, const Upgrade& upgrade) {
  if (!asked.is_upgrade)
    return error_page(426, upgrade.path + " is a WebSocket with the subprotocol " + upgrade.protocol);
  if (asked.has_body) return error_page(413, "a request has no body here");
  if (!names(asked.protocols, upgrade.protocol))
    return error_page(400, fmt::format("Sec-WebSocket-Protocol: found \"{}\"; allowed: {}",
                                       shown(asked.protocols), upgrade.protocol));
  if (!is_key(asked.key))
    return error_page(400,
                      fmt::format("Sec-WebSocket-Key: found \"{}\"; allowed: one field, 16 bytes of base64",
                                  shown(asked.key)));
  return upgrade.obstacle();
}

Page error_page(int status, const std::string& text) {
  return {status, "text/plain; charset=utf-8", text + "\n"};
}

std::optional<Page> foreign_page(const Asked& asked, const Site& site) {
  if (asked.host.empty()) return error_page(400, "a request needs one field Host");
  if (asked.has_origins) return error_page(400, "a request has at most one field Origin");
  const LogFields fields{{"client", asked.peer}};
  if (!is_own_host(asked.host, site)) {
    log_warning("HTTP: {} was refused: it asked for the host \"{}\"; name it in http.names if it is this one",
                asked.peer, shown(asked.host));
    return error_page(403, fmt::format("Host: found {}; allowed: an address, localhost, or one of http.names",
                                       shown(asked.host)));
  }
  if (asked.origin.empty() || is_own_origin(asked.origin, asked.host, site)) return std::nullopt;
  log_warning("HTTP: {} was refused: a page of {} asked; name that in http.origins if it may", asked.peer,
              shown(asked.origin));
  return error_page(
      403, fmt::format("Origin: found {}; allowed: this server's own, {}://{}, or one of http.origins",
                       shown(asked.origin), site.tls ? "https" : "http", asked.host));
}

Page page_of(const Asked& asked, const std::vector<Route>& routes, const security::Security* security) {
  const std::string_view path = path_of(asked.target);
  for (const Route& route : routes) {
    if (route.path != path) continue;
    if (!asked.is_read) return error_page(405, "GET and HEAD only");
    if (asked.has_body) return error_page(413, "a request has no body here");
    if (!may_read(route, asked.authorization, security)) {
      const LogFields fields{{"client", asked.peer}};
      log_warning(
          "HTTP: {} refused to {}: no token, or one that is not in server.tokens; give that client a "
          "viewer's token",
          route.path, asked.peer);
      return error_page(401, "Authorization: Bearer TOKEN is needed");
    }
    return route.page();
  }
  std::string known;
  for (const Route& route : routes) known += (known.empty() ? "" : ", ") + route.path;
  return error_page(404, "nothing here; there are " + known);
}

std::string response_text(const Page& page, bool head, bool keep_alive, unsigned http_version) {
  bhttp::response<bhttp::empty_body> response(static_cast<bhttp::status>(page.status), http_version);
  response.set(bhttp::field::content_type, page.type);
  response.set(bhttp::field::cache_control, "no-store");
  response.set("X-Content-Type-Options", "nosniff");
  response.set("Content-Security-Policy", "default-src 'self'; connect-src 'self'; frame-ancestors 'none'");
  response.set("Referrer-Policy", "no-referrer");
  if (page.status == 401) response.set(bhttp::field::www_authenticate, "Bearer");
  if (page.status == 405) response.set(bhttp::field::allow, "GET, HEAD");
  if (page.status == 426) response.set(bhttp::field::upgrade, "websocket");
  if (page.retry_after_s > 0) response.set(bhttp::field::retry_after, std::to_string(page.retry_after_s));
  response.content_length(page.body.size());
  response.keep_alive(keep_alive);
  std::ostringstream header;
  header << response.base();
  return head ? header.str() : header.str() + page.body;
}

Page health_page() { return {200, "text/plain; charset=utf-8", "ok\n"}; }

Page readiness_page(const Readiness::State& state) {
  Page page;
  switch (state.phase) {
    case Readiness::Phase::loading: {
      const int percent = static_cast<int>(100 * std::clamp(state.fraction, 0.0, 1.0));
      page.body = fmt::format("loading: {}, {} %\n", state.stage, percent);
      break;
    }
    case Readiness::Phase::ready:
      page.body = "ready\n";
      break;
    case Readiness::Phase::stopping:
      page.body = "stopping\n";
      break;
  }
  page.status = state.phase == Readiness::Phase::ready ? 200 : 503;
  return page;
}

Page metrics_page(std::string text) {
  return {200, "text/plain; version=0.0.4; charset=utf-8", std::move(text)};
}

bool is_own_host(std::string_view host, const Site& site) {
  const std::string_view name = without_port(host);
  if (is_address(name) || same(name, "localhost")) return true;
  return std::ranges::any_of(site.names, [&](const std::string& own) { return same(own, name); });
}

bool is_own_origin(std::string_view origin, std::string_view host, const Site& site) {
  if (same(origin, (site.tls ? "https://" : "http://") + std::string(host))) return true;
  return std::ranges::any_of(site.origins, [&](const std::string& other) { return same(other, origin); });
}

}  // namespace obliq::http
