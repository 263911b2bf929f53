#pragma once
// Where a simulator's own aircraft or ship is, as datagrams say it: obliq's own of fixed size, and the Entity
// State PDU of DIS. Pure functions of bytes; docs: server/apps/ownship/README.md.
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>

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

/// Why a datagram is no pose, for a log: "found ...; allowed: ...".
struct NoPose {
  std::string why;
};

constexpr std::size_t kPoseDatagramBytes = 56;    ///< version 1
constexpr std::size_t kMotionDatagramBytes = 96;  ///< version 2: with velocity and attitude
/// obliq's own: little-endian, README.md has the table. Numbers outside a pose's limits are no pose.
std::variant<OwnshipPose, NoPose> read_pose_datagram(std::span<const std::byte> bytes);

/// Which entity of a DIS exercise.
struct EntityId {
  std::uint16_t site = 0;
  std::uint16_t application = 0;
  std::uint16_t entity = 0;
  bool operator==(const EntityId&) const = default;
};

/// SITE:APP:ENTITY, each 0 to 65535.
std::optional<EntityId> parse_entity_id(const std::string& text);

constexpr std::size_t kEntityStateBytes = 144;
/// A state of IEEE 1278.1-2012, 7.2.2: earth-centred metres, metres a second, metres a second squared.
struct EntityState {
  EntityId id;
  std::uint8_t exercise = 0;
  std::array<double, 3> location_m{};
  std::array<double, 3> velocity_m_s{};  ///< of algorithms 6 to 9, too, whose PDU has it in the body's axes
  std::array<double, 3> acceleration_m_s2{};
  double heading_deg = 0;
  Attitude attitude;                ///< as it was sent: of any size
  std::uint8_t dead_reckoning = 1;  ///< algorithm, 0 to 9
  bool frozen = false;              ///< by its simulation: it stands
  bool active = true;               ///< else it has left the exercise
};

/// Entity State PDUs of 144 bytes and more (articulation follows); NoPose for others.
std::variant<EntityState, NoPose> read_entity_state(std::span<const std::byte> bytes);

/// What a simulation manager asks of an entity: IEEE 1278.1-2012, 7.5.3 to 7.5.5.
struct SimulationOrder {
  enum class What { remove, go_on, stop } what = What::stop;
  std::uint8_t exercise = 0;
  EntityId receiver;
};

/// An Entity State or one of those orders, by the PDU's type; NoPose for others.
std::variant<EntityState, SimulationOrder, NoPose> read_pdu(std::span<const std::byte> bytes);

/// Whether an order is for this entity: each part of the receiver is its own, or stands for all, or, of the
/// entity, for none in particular (6.2.28: 65535, 0).
bool is_for(const EntityId& receiver, const EntityId& entity);

/// Where the entity is so long after the PDU, by its dead reckoning; a frozen one stands. Algorithms 2 and 3
/// go straight on, 4 and 5 with the acceleration, too; all others stand (6 to 9 have their velocity in body
/// axes, which is not followed). Heading and attitude stay; an attitude beyond the limits is not said.
OwnshipPose dead_reckoned(const EntityState& state, double after_s);

}  // namespace obliq
