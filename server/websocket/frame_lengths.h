#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace obliq::websocket {

/// Follows a peer's frames (RFC 6455 section 5.2). The highest bit of a length of eight bytes must be 0;
/// Beast 1.74 takes such a length as it is, and would wait for a payload that no memory holds.
class FrameLengths {
 public:
  /// The next bytes of the peer, in any pieces. A length with that bit becomes 0, which Beast refuses as it
  /// does all that eight bytes are too many for: with a close 1002.
  void pass(std::span<std::byte> bytes);

 private:
  std::size_t header_bytes() const;
  std::uint64_t length() const;

  std::array<std::byte, 14> header_{};
  std::size_t have_ = 0;       ///< of the header
  std::uint64_t payload_ = 0;  ///< still to come
};

}  // namespace obliq::websocket
