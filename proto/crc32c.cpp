#include "proto/crc32c.h"

#include <isa-l/crc.h>

#include <algorithm>
#include <climits>

namespace obliq::wire {

std::uint32_t crc32c(std::span<const std::byte> bytes, std::uint32_t so_far) {
  // ISA-L's function is the bare register: it neither inverts the seed nor the result, and counts in int.
  std::uint32_t state = ~so_far;
  while (!bytes.empty()) {
    const std::size_t n = std::min<std::size_t>(bytes.size(), std::size_t{1} << 30);
    // The parameter is not const, but the function only reads.
    auto* data = reinterpret_cast<unsigned char*>(const_cast<std::byte*>(bytes.data()));
    state = crc32_iscsi(data, static_cast<int>(n), state);
    bytes = bytes.subspan(n);
  }
  return ~state;
}

}  // namespace obliq::wire
