#include "server/http/site.h"

#include <algorithm>
#include <boost/asio/ip/address.hpp>
#include <boost/beast/core/string.hpp>

namespace obliq::http {
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

}  // namespace

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
