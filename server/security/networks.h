#pragma once
// Addresses and networks as an operator writes them.
#include <string>
#include <vector>

namespace obliq {

/// "127.0.0.1", "::1" and their like, or "localhost". Other names are not looked up: false.
bool is_loopback_address(const std::string& address);

/// "10.1.2.3", "10.0.0.0/24", "fd00::/8". False for one with bits beyond its prefix: one of the two
/// is wrong.
bool is_network(const std::string& text);

/// True when the address lies in one of the networks. A mapped IPv4 address (::ffff:10.1.2.3) counts as the
/// IPv4 one.
bool is_within(const std::string& address, const std::vector<std::string>& networks);

}  // namespace obliq
