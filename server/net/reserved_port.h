#pragma once
#include <cstdint>
#include <string>
#include <utility>

namespace obliq::net {

/// A TCP address taken for a server that is not ready yet: bound, so that a port in use is known before
/// anything is loaded, but not listened on, so that clients are refused at once instead of left waiting.
/// Of two that load at the same time the second to listen fails.
class ReservedPort {
 public:
  /// Port 0: any free one. Throws InputError when the address is unknown or the port in use.
  ReservedPort(const std::string& address, std::uint16_t port);
  ~ReservedPort();
  ReservedPort(ReservedPort&& other) noexcept
      : fd_(std::exchange(other.fd_, -1)), is_v6_(other.is_v6_), address_(std::move(other.address_)) {}
  ReservedPort& operator=(ReservedPort&&) = delete;

  bool is_v6() const { return is_v6_; }
  const std::string& address() const { return address_; }  ///< "127.0.0.1:7420"
  /// The bound socket, which is the caller's from now on.
  int release() { return std::exchange(fd_, -1); }

 private:
  int fd_ = -1;
  bool is_v6_ = false;
  std::string address_;
};

}  // namespace obliq::net
