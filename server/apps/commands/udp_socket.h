#pragma once
#include <string>

#include "terrain/base/files.h"

namespace obliq {

/// A socket that listens for datagrams, of a multicast group which it joins where the address is one
/// (--listen,
/// --interface). port 0: any free one. shared: other programs of this machine may listen there, too. Does not
/// block. Throws InputError.
UniqueFd bind_udp(const std::string& address, const std::string& interface, int port, bool shared,
                  int& bound_port);

}  // namespace obliq
