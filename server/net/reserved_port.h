#pragma once
#include <cstdint>
#include <string>

#include "terrain/base/unique_fd.h"

namespace obliq::net {

/// A TCP address taken for a server that is not ready yet: bound, so that a port in use is known before
/// anything is loaded, but not listened on, so that clients are refused at once instead of left waiting.
/// Of two that load at the same time the second to listen fails.
class ReservedPort {
 public:
  /// Port 0: any free one. Throws InputError when the address is unknown or the port in use.
  ReservedPort(const std::string& address, std::uint16_t port);

  bool is_v6() const { return is_v6_; }
  const std::string& address() const { return address_; }  ///< "127.0.0.1:7420"
  /// The bound socket, which is the caller's from now on.
  int release() { return fd_.release(); }

 private:
  UniqueFd fd_;
  bool is_v6_ = false;
  std::string address_;
};

}  // namespace obliq::net
