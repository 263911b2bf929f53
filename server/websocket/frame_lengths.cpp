#include "server/websocket/frame_lengths.h"

#include <algorithm>

namespace obliq::websocket {
namespace {

constexpr std::size_t kLeastHeader = 2;
constexpr std::byte kMasked{0x80};
constexpr std::byte kLength{0x7f};
constexpr std::byte kOfTwoBytes{126};
constexpr std::byte kOfEightBytes{127};
constexpr std::byte kHighestBit{0x80};

std::size_t length_bytes(std::byte second) {
  const std::byte length = second & kLength;
  return length == kOfTwoBytes ? 2 : length == kOfEightBytes ? 8 : 0;
}

}  // namespace

std::size_t FrameLengths::header_bytes() const {
  constexpr std::size_t kMaskBytes = 4;
  if (have_ < kLeastHeader) return kLeastHeader;
  return kLeastHeader + length_bytes(header_[1]) + ((header_[1] & kMasked) == kMasked ? kMaskBytes : 0);
}

std::uint64_t FrameLengths::length() const {
  const std::size_t bytes = length_bytes(header_[1]);
  if (bytes == 0) return std::to_integer<std::uint64_t>(header_[1] & kLength);
  std::uint64_t length = 0;
  for (std::size_t i = 0; i < bytes; ++i)
    length = length << 8 | std::to_integer<std::uint64_t>(header_[kLeastHeader + i]);
  return length;
}

void FrameLengths::pass(std::span<std::byte> bytes) {
  while (!bytes.empty()) {
    if (payload_ > 0) {
      const std::size_t n = std::min<std::uint64_t>(payload_, bytes.size());
      payload_ -= n;
      bytes = bytes.subspan(n);
      continue;
    }
    const bool of_eight = have_ >= kLeastHeader && length_bytes(header_[1]) == 8;
    const bool in_length = of_eight && have_ < kLeastHeader + 8;
    header_[have_] = bytes[0];
    if (in_length && (header_[kLeastHeader] & kHighestBit) == kHighestBit) bytes[0] = std::byte{0};
    bytes = bytes.subspan(1);
    if (++have_ < header_bytes()) continue;
    payload_ = length();
    have_ = 0;
  }
}

}  // namespace obliq::websocket
