#include "proto/ground_record.h"

#include "proto/limits.h"
#include "proto/record_codec.h"

namespace obliq::wire {

static_assert(kMaxQueryPoints * kGroundRecordBytes <= kMaxPlaneBytes);

namespace {

constexpr auto kEachOfGround = [](auto& record, const auto& use) {
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
  use(record.water);
};

}  // namespace

std::vector<std::byte> encode_ground_records(std::span<const GroundRecord> records) {
  return encode_records(records, kGroundRecordBytes, kEachOfGround);
}

bool decode_ground_records(std::span<const std::byte> bytes, std::uint32_t points, std::uint32_t record_bytes,
                           std::vector<GroundRecord>& records) {
  records.clear();
  return points <= kMaxQueryPoints && record_bytes <= kMaxPlaneBytes &&
         decode_records(bytes, points, record_bytes, kGroundRecordBytes, kEachOfGround, records);
}

}  // namespace obliq::wire
