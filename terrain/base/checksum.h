#pragma once
#include <cstddef>
#include <cstdint>

namespace obliq {

/// 64 bits over some bytes, at memory's speed (XXH3 of xxHash). Accidents go unseen once in 2^64; it is no
/// protection against forgery. `seed`: the sum of what comes before.
std::uint64_t checksum(const void* data, std::size_t size, std::uint64_t seed = 0);

}  // namespace obliq
