#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

namespace obliq::wire {

/// CRC-32C (Castagnoli; RFC 3720 appendix B.4): reflected, initial value and final xor all ones, so that
/// crc32c("123456789") = 0xE3069283. To continue over more bytes, pass the value so far.
std::uint32_t crc32c(std::span<const std::byte> bytes, std::uint32_t so_far = 0);

}  // namespace obliq::wire
