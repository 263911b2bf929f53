#include "proto/ground_record.h"

#include <bit>
#include <cstring>

#include "proto/limits.h"

namespace obliq::wire {

static_assert(std::endian::native == std::endian::little, "values are written as they lie in memory");
static_assert(kMaxQueryPoints * kGroundRecordBytes <= kMaxPlaneBytes);

namespace {

/// The members in their order on the wire, for a writer and for a reader.
template <typename Record, typename Use>
void each_member(Record& record, const Use& use) {
  use(record.latitude_deg);
  use(record.longitude_deg);
  use(record.height_m);
  use(record.surface_height_m);
  use(record.point_height_m);
  use(record.slope_deg);
  use(record.downhill_deg);
  use(record.clearance_deg);
  use(record.obstacle_range_m);
  use(record.building);
  use(record.state);
  use(record.sight);
  use(record.material);
}

}  // namespace

std::vector<std::byte> encode_ground_records(std::span<const GroundRecord> records) {
  std::vector<std::byte> bytes(records.size() * kGroundRecordBytes);
  std::byte* at = bytes.data();
  for (const GroundRecord& record : records) {
    each_member(record, [&](const auto& member) {
      std::memcpy(at, &member, sizeof member);
      at += sizeof member;
    });
    *at++ = std::byte{record.water};
  }
  return bytes;
}

bool decode_ground_records(std::span<const std::byte> bytes, std::uint32_t points, std::uint32_t record_bytes,
                           std::vector<GroundRecord>& records) {
  records.clear();
  if (points > kMaxQueryPoints || record_bytes < kGroundRecordBytes || record_bytes > kMaxPlaneBytes ||
      bytes.size() != std::size_t{points} * record_bytes)
    return false;
  records.resize(points);
  const std::byte* from = bytes.data();
  for (GroundRecord& record : records) {
    const std::byte* at = from;
    each_member(record, [&](auto& member) {
      std::memcpy(&member, at, sizeof member);
      at += sizeof member;
    });
    record.water = *at != std::byte{0};
    from += record_bytes;
  }
  return true;
}

}  // namespace obliq::wire
