#pragma once
// Addresses and networks as an operator writes them.
#include <string>
#include <vector>

namespace obliq::security {

/// "127.0.0.1", "::1" and their like, or "localhost". Other names are not looked up: false.
bool is_loopback_address(const std::string& address);

/// "10.1.2.3", "10.0.0.0/24", "fd00::/8". False for one with bits beyond its prefix: one of the two
/// is wrong.
bool is_network(const std::string& text);

/// True when the address lies in one of the networks. A mapped IPv4 address (::ffff:10.1.2.3) counts as the
/// IPv4 one.
bool is_within(const std::string& address, const std::vector<std::string>& networks);

/// Whether only this machine can reach a port bound to that address: 127.0.0.0/8, ::1, or a name of which all
/// addresses are such. A name that is unknown counts as exposed.
bool resolves_to_loopback(const std::string& address);

/// The part of an address that one host can fill at will, in canonical text: an IPv4 address (also from its
/// IPv6 form), the /64 network of an IPv6 address. Other text comes back as it is.
std::string network_of(const std::string& host);

/// The network with most connections, of one entry for each connection; of equals the first by text. There
/// must be one.
std::string most_crowded(const std::vector<std::string>& networks);

/// Off loopback, a port needs all of `protections` (keys of the configuration, with whether they are set) or
/// `unprotected_key` = true. Throws InputError that names address and keys.
struct Protection {
  std::string key;
  bool is_set = false;
};
void require_protection(const std::string& address_key, const std::string& address,
                        const std::vector<Protection>& protections, const std::string& unprotected_key,
                        bool unprotected);

}  // namespace obliq::security
