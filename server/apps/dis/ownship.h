#pragma once
// Where a simulator's own aircraft or ship is, as datagrams say it: obliq's own of fixed size, and the Entity
// State PDU of DIS. Pure functions of bytes; docs: server/apps/dis/README.md.
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>

#include "server/apps/dis/entity_state.h"

namespace obliq {

/// Of a body, against the vertical and its own heading.
struct Attitude {
  double roll_deg = 0;   ///< right side down positive
  double pitch_deg = 0;  ///< nose up positive
  bool operator==(const Attitude&) const = default;
};
/// Of roll and pitch, either way: antenna.roll_deg, antenna.pitch_deg.
constexpr double kMostAttitude_deg = 60;

/// Why this is no attitude that a radar takes; empty: it is one.
std::string fault_of(const Attitude& attitude);

/// Degrees, metres above whatever the receiver is told (--height-reference); of a PDU above the ellipsoid.
struct OwnshipPose {
  double latitude_deg = 0;
  double longitude_deg = 0;
  double height_m = 0;
  double heading_deg = 0;                             ///< of the nose, true, -180 to 180
  std::optional<std::array<double, 3>> velocity_m_s;  ///< north, east, up; empty: not said
  std::optional<Attitude> attitude;                   ///< empty: not said
  std::int64_t sim_time_ns = 0;
  std::uint64_t pose_id = 0;
};

constexpr std::size_t kPoseDatagramBytes = 56;    ///< version 1
constexpr std::size_t kMotionDatagramBytes = 96;  ///< version 2: with velocity and attitude
/// obliq's own: little-endian, README.md has the table. Numbers outside a pose's limits are no pose.
std::variant<OwnshipPose, NoPose> read_pose_datagram(std::span<const std::byte> bytes);

/// Where the entity is so long after the PDU, by its dead reckoning (dead_reckoning.h). Its attitude is
/// against the vertical of the place where the PDU had it; one beyond the limits is not said. What stands
/// without being frozen has the velocity that it was sent with.
OwnshipPose dead_reckoned(const EntityState& state, double after_s);
/// Its roll and pitch as they were sent, of any size.
Attitude attitude_of(const EntityState& state);
/// Why this is no place that a radar takes; empty: it is one.
std::string fault_of(const OwnshipPose& pose);

}  // namespace obliq
