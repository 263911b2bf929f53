#include "server/security/networks.h"

#include <algorithm>
#include <boost/asio/ip/address.hpp>
#include <boost/asio/ip/network_v4.hpp>
#include <boost/asio/ip/network_v6.hpp>
#include <optional>
#include <variant>

namespace obliq {
namespace {

namespace ip = boost::asio::ip;
using boost::system::error_code;

/// A mapped IPv4 address becomes the IPv4 one; scopes are dropped.
std::optional<ip::address> parse_address(const std::string& text) {
  error_code error;
  const ip::address address = ip::make_address(text, error);
  if (error) return std::nullopt;
  if (address.is_v4()) return address;
  const ip::address_v6 v6 = address.to_v6();
  if (v6.is_v4_mapped()) return ip::make_address_v4(ip::v4_mapped, v6);
  return ip::address_v6(v6.to_bytes());
}

using Network = std::variant<ip::network_v4, ip::network_v6>;

std::optional<Network> parse_network(const std::string& text) {
  if (text.find('/') == std::string::npos) {
    const auto address = parse_address(text);
    if (!address) return std::nullopt;
    if (address->is_v4()) return ip::network_v4(address->to_v4(), 32);
    return ip::network_v6(address->to_v6(), 128);
  }
  error_code error;
  const ip::network_v4 v4 = ip::make_network_v4(text, error);
  if (!error && v4 == v4.canonical()) return v4;
  const ip::network_v6 v6 = ip::make_network_v6(text, error);
  if (!error && v6 == v6.canonical()) return v6;
  return std::nullopt;
}

bool holds(const Network& network, const ip::address& address) {
  if (const auto* v4 = std::get_if<ip::network_v4>(&network))
    return address.is_v4() && ip::network_v4(address.to_v4(), v4->prefix_length()).canonical() == *v4;
  const auto& v6 = std::get<ip::network_v6>(network);
  return address.is_v6() && ip::network_v6(address.to_v6(), v6.prefix_length()).canonical() == v6;
}

}  // namespace

bool is_loopback_address(const std::string& address) {
  if (address == "localhost") return true;
  const auto parsed = parse_address(address);
  return parsed && parsed->is_loopback();
}

bool is_network(const std::string& text) { return parse_network(text).has_value(); }

bool is_within(const std::string& address, const std::vector<std::string>& networks) {
  const auto parsed = parse_address(address);
  return parsed && std::ranges::any_of(networks, [&](const std::string& text) {
           const auto network = parse_network(text);
           return network && holds(*network, *parsed);
         });
}

}  // namespace obliq
