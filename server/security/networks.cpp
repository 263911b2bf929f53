#include "server/security/networks.h"

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/address.hpp>
#include <boost/asio/ip/network_v4.hpp>
#include <boost/asio/ip/network_v6.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <map>
#include <optional>
#include <variant>

#include "terrain/base/errors.h"

namespace obliq::security {

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

bool resolves_to_loopback(const std::string& address) {
  if (parse_address(address)) return is_loopback_address(address);
  error_code error;
  boost::asio::io_context io;
  ip::tcp::resolver resolver(io);
  const auto found = resolver.resolve(address, "", error);
  return !error && !found.empty() && std::ranges::all_of(found, [](const auto& entry) {
    return is_loopback_address(entry.endpoint().address().to_string());
  });
}

std::string network_of(const std::string& host) {
  const auto address = parse_address(host);
  if (!address) return host;
  if (address->is_v4()) return address->to_string();
  return ip::network_v6(address->to_v6(), 64).canonical().to_string();
}

std::string most_crowded(const std::vector<std::string>& networks) {
  std::map<std::string, int> connections;
  for (const std::string& network : networks) ++connections[network];
  return std::ranges::max_element(connections, {}, [](const auto& entry) { return entry.second; })->first;
}

void require_protection(const std::string& address_key, const std::string& address,
                        const std::vector<Protection>& protections, const std::string& unprotected_key,
                        bool unprotected) {
  if (unprotected || resolves_to_loopback(address)) return;
  std::string missing;
  for (const Protection& protection : protections) {
    if (!protection.is_set) missing += (missing.empty() ? "" : " and ") + protection.key;
  }
  if (missing.empty()) return;
  throw InputError(address_key + ": found " + address + ", which other machines can reach, without " +
                   missing + "; allowed: 127.0.0.1 or ::1, or with " + missing + ", or with " +
                   unprotected_key + " = true, which lets any client in");
}

}  // namespace obliq::security
