#include "client/endpoint.h"

#include <charconv>

#include "proto/limits.h"

namespace obliq::client {
namespace {

constexpr std::string_view kThisMachine = "127.0.0.1";

}  // namespace

std::string Endpoint::text() const {
  const bool bracket = host.find(':') != std::string::npos;
  return (bracket ? "[" + host + "]" : host) + ":" + std::to_string(port);
}

std::optional<Endpoint> parse_endpoint(std::string_view text) {
  std::string_view host = text;
  std::optional<std::string_view> port;
  if (text.starts_with('[')) {
    const std::size_t close = text.find(']');
    if (close == std::string_view::npos) return std::nullopt;
    host = text.substr(1, close - 1);
    const std::string_view rest = text.substr(close + 1);
    if (host.empty() || (!rest.empty() && rest.front() != ':')) return std::nullopt;
    if (!rest.empty()) port = rest.substr(1);
  } else if (const std::size_t colon = text.find(':'); colon != std::string_view::npos) {
    host = text.substr(0, colon);
    port = text.substr(colon + 1);
  } else if (text.find_first_not_of("0123456789") == std::string_view::npos) {
    host = {};
    port = text;
  }
  Endpoint endpoint{std::string(host.empty() ? kThisMachine : host), wire::kDefaultPort};
  if (!port) return endpoint;
  const auto [end, error] = std::from_chars(port->data(), port->data() + port->size(), endpoint.port);
  if (error != std::errc() || end != port->data() + port->size() || endpoint.port == 0) return std::nullopt;
  return endpoint;
}

}  // namespace obliq::client
