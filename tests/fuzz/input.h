#pragma once
// What the fuzz targets share: an input taken apart, and messages whose CRC is put right, since no chance
// finds a CRC.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace obliq::fuzz {

/// An input read from front to back; past its end everything is zero or empty.
class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : left_(data, size) {}

  bool empty() const { return left_.empty(); }
  std::uint8_t u8() {
    if (left_.empty()) return 0;
    const std::uint8_t value = left_.front();
    left_ = left_.subspan(1);
    return value;
  }
  std::uint16_t u16() {
    const unsigned low = u8();
    return static_cast<std::uint16_t>(low | (static_cast<unsigned>(u8()) << 8));
  }
  std::span<const std::byte> take(std::size_t bytes) {
    const auto taken = left_.first(bytes < left_.size() ? bytes : left_.size());
    left_ = left_.subspan(taken.size());
    return std::as_bytes(taken);
  }
  std::span<const std::byte> rest() { return take(left_.size()); }

 private:
  std::span<const std::uint8_t> left_;
};

/// A stream's bytes. First byte: bit 0 puts the CRCs right; the messages follow.
std::vector<std::byte> stream_of(const std::uint8_t* data, std::size_t size);

/// From its construction on protobuf does not print each message that does not parse.
struct QuietProtobuf {
  QuietProtobuf();
};

/// Gives every message in `bytes` that lies there whole the CRC that belongs to it; other bytes stay.
void mend_crcs(std::vector<std::byte>& bytes);

/// Ends the process as a crash does. For what must never happen and would not crash by itself.
[[noreturn]] void broken(const char* what);

}  // namespace obliq::fuzz
