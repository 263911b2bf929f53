#pragma once
// What a GroundAnswer says of one place: a record of fixed size, little-endian, in the order of its members.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace obliq::wire {

/// What is known of the ground at a place.
enum class GroundState : std::uint8_t {
  known = 0,
  unknown = 1,   ///< within the loaded terrain, but no file has a height there
  outside = 2,   ///< beyond the loaded terrain
  too_near = 3,  ///< of a bearing and range: all ground is farther away than that
};

/// Whether the antenna sees the point at a place.
enum class Sight : std::uint8_t {
  not_asked = 0,  ///< no antenna was named
  visible = 1,
  visible_over_unknown = 2,  ///< nothing known hides it, but the line passes over ground that is not known
  behind_ground = 3,
  behind_building = 4,
  below_ground = 5,  ///< the point itself
  inside_building = 6,
  no_height = 7,  ///< the point's height is counted from ground that is not known
};

/// Numbers that are not known are 0.
struct GroundRecord {
  double latitude_deg = 0;
  double longitude_deg = 0;
  double height_m = 0;          ///< of the ground, above the datum
  double surface_height_m = 0;  ///< of what is seen from straight above: a roof, else the ground
  double point_height_m = 0;    ///< of the point that is seen or not
  float slope_deg = 0;          ///< of the ground, from the horizontal there
  float downhill_deg = 0;       ///< true bearing of its steepest descent, 0 to 360; 0 where it is level
  /// Angle at the antenna from what stands highest before the point to the point; negative: hidden by it.
  float clearance_deg = 0;
  float obstacle_range_m = 0;  ///< ground distance from the antenna to what stands highest; 0: nothing
  std::uint32_t building = 0;  ///< number of the one that stands there, from 1; 0: none
  GroundState state = GroundState::known;
  Sight sight = Sight::not_asked;
  std::uint8_t material = 0;  ///< of the surface
  bool water = false;         ///< that material is "water"
};

constexpr std::uint32_t kGroundRecordBytes = 64;

/// Records as they follow a GroundAnswer.
std::vector<std::byte> encode_ground_records(std::span<const GroundRecord> records);

/// Of `points` records of record_bytes each, which may be longer in a later version. False when the bytes are
/// not so many, or shorter than a record.
[[nodiscard]] bool decode_ground_records(std::span<const std::byte> bytes, std::uint32_t points,
                                         std::uint32_t record_bytes, std::vector<GroundRecord>& records);

}  // namespace obliq::wire
