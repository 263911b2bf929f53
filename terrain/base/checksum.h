#pragma once
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "terrain/base/hash.h"

namespace obliq {

/// 64 bits over some bytes, at memory's speed: four lanes of 8-byte words, each lane a chain of bijections. A
/// change within one word always changes the sum, any other goes unseen once in 2^64. Not against people who
/// want it to go unseen. `seed`: the sum of what comes before.
inline std::uint64_t checksum(const void* data, std::size_t size, std::uint64_t seed = 0) {
  constexpr std::uint64_t kOdd = 0x9fb21c651e98df25u;
  std::uint64_t lane[4];
  for (std::uint64_t k = 0; k < 4; ++k) lane[k] = mix64(seed + k);
  const auto* bytes = static_cast<const unsigned char*>(data);
  const auto take = [&](const unsigned char* at) {
    std::uint64_t word[4];
    std::memcpy(word, at, sizeof word);
    for (int k = 0; k < 4; ++k) lane[k] = std::rotl((lane[k] ^ word[k]) * kOdd, 29);
  };
  const std::size_t whole = size / 32 * 32;
  for (std::size_t at = 0; at < whole; at += 32) take(bytes + at);
  unsigned char rest[32] = {};
  if (size > whole) std::memcpy(rest, bytes + whole, size - whole);
  take(rest);
  std::uint64_t sum = mix64(size);
  for (const std::uint64_t value : lane) sum = mix64(sum ^ value);
  return sum;
}

}  // namespace obliq
