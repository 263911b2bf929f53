#include "server/http/answering.h"

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <boost/beast/core/string.hpp>
#include <boost/beast/http/error.hpp>
#include <utility>

#include "server/log/service_log.h"
#include "server/security/security.h"
#include "terrain/base/text.h"

namespace obliq::http {

namespace bhttp = boost::beast::http;

namespace {

bool may_read(const Route& route, std::string_view authorization, const net::Security* security) {
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
    const std::size_t begin = one.find_first_not_of(" \t");
    if (begin == std::string_view::npos) continue;
    if (one.substr(begin, one.find_last_not_of(" \t") + 1 - begin) == wanted) return true;
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
    spdlog::warn(
        "HTTP: {} was refused: it asked for the host \"{}\"; name it in http.names if it is this one",
        asked.peer, shown(asked.host));
    return error_page(403, fmt::format("Host: found {}; allowed: an address, localhost, or one of http.names",
                                       shown(asked.host)));
  }
  if (asked.origin.empty() || is_own_origin(asked.origin, asked.host, site)) return std::nullopt;
  spdlog::warn("HTTP: {} was refused: a page of {} asked; name that in http.origins if it may", asked.peer,
               shown(asked.origin));
  return error_page(
      403, fmt::format("Origin: found {}; allowed: this server's own, {}://{}, or one of http.origins",
                       shown(asked.origin), site.tls ? "https" : "http", asked.host));
}

Page page_of(const Asked& asked, const std::vector<Route>& routes, const net::Security* security) {
  const std::string_view path = path_of(asked.target);
  for (const Route& route : routes) {
    if (route.path != path) continue;
    if (!asked.is_read) return error_page(405, "GET and HEAD only");
    if (asked.has_body) return error_page(413, "a request has no body here");
    if (!may_read(route, asked.authorization, security)) {
      const LogFields fields{{"client", asked.peer}};
      spdlog::warn(
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

}  // namespace obliq::http
