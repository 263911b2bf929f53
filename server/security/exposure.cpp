#include "server/security/exposure.h"

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/network_v6.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <map>

#include "server/security/networks.h"
#include "terrain/base/errors.h"

namespace obliq::net {

namespace ip = boost::asio::ip;
using boost::system::error_code;

bool resolves_to_loopback(const std::string& address) {
  error_code error;
  (void)ip::make_address(address, error);
  if (!error) return is_loopback_address(address);
  boost::asio::io_context io;
  ip::tcp::resolver resolver(io);
  const auto found = resolver.resolve(address, "", error);
  return !error && !found.empty() && std::ranges::all_of(found, [](const auto& entry) {
    return is_loopback_address(entry.endpoint().address().to_string());
  });
}

std::string network_of(const std::string& host) {
  error_code error;
  const ip::address address = ip::make_address(host, error);
  if (error || address.is_v4()) return host;
  const ip::address_v6 v6 = address.to_v6();
  if (v6.is_v4_mapped()) return ip::make_address_v4(ip::v4_mapped, v6).to_string();
  return ip::network_v6(ip::address_v6(v6.to_bytes()), 64).canonical().to_string();  // without the scope
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

}  // namespace obliq::net
