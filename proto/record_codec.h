#pragma once
// Records of fixed size as plane data: their members one after the other, little-endian.
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

namespace obliq::wire {

static_assert(std::endian::native == std::endian::little, "values are written as they lie in memory");

/// each_member(record, use): calls use with each member in its order on the wire.
template <typename Record, typename EachMember>
std::vector<std::byte> encode_records(std::span<const Record> records, std::uint32_t record_bytes,
                                      const EachMember& each_member) {
  std::vector<std::byte> bytes(records.size() * record_bytes);
  std::byte* at = bytes.data();
  for (const Record& record : records)
    each_member(record, [&](const auto& member) {
      std::memcpy(at, &member, sizeof member);
      at += sizeof member;
    });
  return bytes;
}

/// Records may be longer in a later version. False when the bytes are not so many, or shorter than a record,
/// least_bytes.
template <typename Record, typename EachMember>
[[nodiscard]] bool decode_records(std::span<const std::byte> bytes, std::uint32_t n,
                                  std::uint32_t record_bytes, std::uint32_t least_bytes,
                                  const EachMember& each_member, std::vector<Record>& records) {
  records.clear();
  if (record_bytes < least_bytes || bytes.size() != std::size_t{n} * record_bytes) return false;
  records.resize(n);
  const std::byte* from = bytes.data();
  for (Record& record : records) {
    const std::byte* at = from;
    each_member(record, [&](auto& member) {
      if constexpr (std::is_same_v<std::remove_reference_t<decltype(member)>, bool>)
        member = *at != std::byte{0};
      else
        std::memcpy(&member, at, sizeof member);
      at += sizeof member;
    });
    from += record_bytes;
  }
  return true;
}

}  // namespace obliq::wire
