#pragma once
// Who may come: addresses and networks as an operator writes them.
#include <string>
#include <vector>

namespace obliq {

/// "127.0.0.1", "::1" and their like, or "localhost". Other names count as far away.
bool is_loopback_address(const std::string& address);

/// "10.1.2.3", "10.0.0.0/24", "fd00::/8". A network with bits beyond its prefix is none: one of the two is
/// wrong.
bool is_network(const std::string& text);

/// True when the address lies in one of the networks. An IPv4 address in IPv6 clothes (::ffff:10.1.2.3) is
/// the IPv4 one.
bool is_within(const std::string& address, const std::vector<std::string>& networks);

}  // namespace obliq
