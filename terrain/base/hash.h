#pragma once
#include <cstddef>
#include <cstdint>

namespace obliq {

/// Finaliser of SplitMix64 (Steele, Lea and Flood, "Fast splittable pseudorandom number generators", 2014):
/// a bijection of 64 bits whose outputs pass the usual tests of randomness. Of a std::uint64_t, or of eight
/// side by side (server/radar/simd/lanes/lanes.h says why it is always inlined).
template <typename Word>
[[gnu::always_inline]] constexpr Word mix_words(Word v) {
  v += 0x9e3779b97f4a7c15u;
  v = (v ^ (v >> 30)) * 0xbf58476d1ce4e5b9u;
  v = (v ^ (v >> 27)) * 0x94d049bb133111ebu;
  return v ^ (v >> 31);
}
constexpr std::uint64_t mix64(std::uint64_t v) { return mix_words(v); }

/// Hash of a seed and two whole numbers, such as the indices of a cell.
constexpr std::uint64_t hash_cell(std::uint64_t seed, std::int64_t i, std::int64_t j) {
  return mix64(mix64(mix64(seed) ^ static_cast<std::uint64_t>(i)) ^ static_cast<std::uint64_t>(j));
}

/// Uniform in [0, 1): the top 53 bits of a hash.
constexpr double unit_from_hash(std::uint64_t hash) { return static_cast<double>(hash >> 11) * 0x1p-53; }

/// 64 bits over some bytes, at memory's speed (XXH3 of xxHash). Accidents go unseen once in 2^64; it is no
/// protection against forgery. `seed`: the sum of what comes before.
std::uint64_t checksum(const void* data, std::size_t size, std::uint64_t seed = 0);

}  // namespace obliq
