#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>
#include <span>

namespace obliq {

/// The number of that byte order at an offset, which must lie inside.
template <typename Number, std::endian order>
Number number_at(std::span<const std::byte> bytes, std::size_t offset) {
  std::array<std::byte, sizeof(Number)> raw;
  std::memcpy(raw.data(), bytes.data() + offset, sizeof raw);
  if constexpr (order != std::endian::native) std::ranges::reverse(raw);
  return std::bit_cast<Number>(raw);
}

template <typename Number>
Number little(std::span<const std::byte> bytes, std::size_t offset) {
  return number_at<Number, std::endian::little>(bytes, offset);
}
template <typename Number>
Number big(std::span<const std::byte> bytes, std::size_t offset) {
  return number_at<Number, std::endian::big>(bytes, offset);
}

}  // namespace obliq
