#include "proto/target_record.h"

#include "proto/limits.h"
#include "proto/record_codec.h"

namespace obliq::wire {

static_assert(kMaxTargetRecords * kTargetRecordBytes <= kMaxPlaneBytes);

namespace {

constexpr auto kEachOfTarget = [](auto& record, const auto& use) {
  use(record.id);
  use(record.latitude_deg);
  use(record.longitude_deg);
  use(record.height_m);
  use(record.bearing_deg);
  use(record.range_m);
  use(record.elevation_deg);
  use(record.closing_m_s);
  use(record.snr_db);
  use(record.rcs_dbsm);
  use(record.share_seen);
  use(record.azimuth_bin);
  use(record.range_bin);
  use(record.hidden_by);
  use(record.is_power);
  use(record.reserved);
};

}  // namespace

std::vector<std::byte> encode_target_records(std::span<const TargetRecord> records) {
  return encode_records(records, kTargetRecordBytes, kEachOfTarget);
}

bool decode_target_records(std::span<const std::byte> bytes, std::uint32_t n, std::uint32_t record_bytes,
                           std::vector<TargetRecord>& records) {
  records.clear();
  return decode_records(bytes, n, record_bytes, kTargetRecordBytes, kEachOfTarget, records);
}

}  // namespace obliq::wire
