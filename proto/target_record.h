#pragma once
// What a TargetBlock says of one target: a record of fixed size, little-endian, in the order of its members.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace obliq::wire {

/// What hides a target, or part of it.
enum class HiddenBy : std::uint8_t {
  nothing = 0,
  ground = 1,
  building = 2,
  horizon = 3,
  unknown_ground = 4,  ///< nothing known hides it, but the line passes over ground that is not known
};

struct TargetRecord {
  std::uint64_t id = 0;
  double latitude_deg = 0;  ///< of its foot, as are the next
  double longitude_deg = 0;
  double height_m = 0;      ///< above the datum
  double bearing_deg = 0;   ///< clockwise from the antenna's true north, 0 to 360
  double range_m = 0;       ///< slant
  float elevation_deg = 0;  ///< at the antenna, about its own vertical
  float closing_m_s = 0;    ///< of target and antenna together; positive: the range falls
  float snr_db = 0;    ///< in the middle of beam and pulse, before gain and STC; -1000: nothing of it is seen
  float rcs_dbsm = 0;  ///< as drawn for this look
  float share_seen = 0;           ///< 0 to 1
  std::int32_t azimuth_bin = -1;  ///< that holds it; -1: none
  std::int32_t range_bin = -1;
  HiddenBy hidden_by = HiddenBy::nothing;
  bool is_power = false;  ///< snr_db is the echo's power in dBW: the receiver has no noise
  std::uint16_t reserved = 0;
};

constexpr std::uint32_t kTargetRecordBytes = 80;
constexpr float kLeastSnr_db = -1000;
/// Of one block.
constexpr std::uint32_t kMaxTargetRecords = 10000;

/// Records as they follow a TargetBlock.
std::vector<std::byte> encode_target_records(std::span<const TargetRecord> records);

/// Of so many records of record_bytes each, which may be longer in a later version. False when the bytes are
/// not so many, or shorter than a record.
[[nodiscard]] bool decode_target_records(std::span<const std::byte> bytes, std::uint32_t n,
                                         std::uint32_t record_bytes, std::vector<TargetRecord>& records);

}  // namespace obliq::wire
