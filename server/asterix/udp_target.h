#pragma once
// Where datagrams go: an IPv4 address, of one receiver or of a multicast group.
#include <netinet/in.h>

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "terrain/base/files.h"

namespace obliq::asterix {

struct UdpOptions {
  std::string to;            ///< HOST:PORT, HOST an IPv4 address or a name
  std::string interface {};  ///< IPv4 address of this machine to send from; empty: the system's choice
  int ttl = 1;               ///< routers that a datagram may pass, and one
};

/// For one thread at a time.
class UdpTarget {
 public:
  /// Throws InputError.
  explicit UdpTarget(const UdpOptions& options);

  bool is_multicast() const;
  /// "239.192.24.1:8600".
  std::string text() const;

  /// Hands datagrams to the kernel, without waiting, and returns how many of them, from the first on, it
  /// took. Fewer than given: `error` is the errno of the next one.
  std::size_t send(std::span<const std::vector<std::byte>> datagrams, int& error);

 private:
  sockaddr_in to_{};
  UniqueFd socket_;
};

}  // namespace obliq::asterix
