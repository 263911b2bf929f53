#include "server/security/networks.h"

#include <algorithm>
#include <array>
#include <boost/asio/ip/address.hpp>
#include <boost/asio/ip/network_v4.hpp>
#include <boost/asio/ip/network_v6.hpp>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace obliq {
namespace {

namespace ip = boost::asio::ip;
using boost::system::error_code;

std::optional<ip::address> parse_address(const std::string& text) {
  error_code error;
  ip::address address = ip::make_address(text, error);
  if (error) return std::nullopt;
  if (address.is_v6() && address.to_v6().is_v4_mapped())
    return ip::make_address_v4(ip::v4_mapped, address.to_v6());
  return address;
}

struct Network {
  ip::address address;
  unsigned prefix = 0;
};

std::optional<Network> parse_network(const std::string& text) {
  if (text.find('/') == std::string::npos) {
    const auto address = parse_address(text);
    if (!address) return std::nullopt;
    return Network{*address, address->is_v4() ? 32U : 128U};
  }
  error_code error;
  const ip::network_v4 v4 = ip::make_network_v4(text, error);
  if (!error && v4 == v4.canonical()) return Network{v4.address(), v4.prefix_length()};
  const ip::network_v6 v6 = ip::make_network_v6(text, error);
  if (!error && v6 == v6.canonical()) return Network{v6.address(), v6.prefix_length()};
  return std::nullopt;
}

template <std::size_t n>
bool same_bits(const std::array<unsigned char, n>& a, const std::array<unsigned char, n>& b,
               unsigned prefix) {
  for (unsigned bit = 0; bit < prefix; ++bit) {
    const unsigned char mask = static_cast<unsigned char>(0x80U >> (bit % 8));
    if (((a[bit / 8] ^ b[bit / 8]) & mask) != 0) return false;
  }
  return true;
}

bool holds(const Network& network, const ip::address& address) {
  if (network.address.is_v4() != address.is_v4()) return false;
  return address.is_v4()
             ? same_bits(network.address.to_v4().to_bytes(), address.to_v4().to_bytes(), network.prefix)
             : same_bits(network.address.to_v6().to_bytes(), address.to_v6().to_bytes(), network.prefix);
}

}  // namespace

bool is_loopback(const std::string& address) {
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
