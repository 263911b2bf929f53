#pragma once
#include <string>

#include "terrain/base/files.h"

namespace obliq {

/// A socket that listens for datagrams on the address of --listen, and does not block. A multicast group is
/// joined on the network of --interface. port 0: any free one. shared: other programs of this machine may
/// listen there, too. Throws InputError.
UniqueFd bind_udp(const std::string& address, const std::string& interface, int port, bool shared,
                  int& bound_port);

}  // namespace obliq
