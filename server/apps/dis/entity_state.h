#pragma once
// What PDUs of DIS say: where an entity is, and what a simulation's manager asks of it. Pure functions of
// bytes, which may be any.
#include <compare>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <string>
#include <variant>

#include "server/apps/dis/earth_axes.h"
#include "server/control/sections/dis_pattern.h"

namespace obliq {

/// Why a datagram is not taken, for a log: "found ...; allowed: ...".
struct NoPose {
  std::string why;
};

/// Which entity of a DIS exercise.
struct EntityId {
  std::uint16_t site = 0;
  std::uint16_t application = 0;
  std::uint16_t entity = 0;
  bool operator==(const EntityId&) const = default;
  auto operator<=>(const EntityId&) const = default;
};

/// SITE:APP:ENTITY, each 0 to 65535.
std::optional<EntityId> parse_entity_id(const std::string& text);
std::string text_of(const EntityId& id);

constexpr std::size_t kEntityStateBytes = 144;  ///< without variable parameters
/// A state of IEEE 1278.1-2012, 7.2.2. Vectors are in the earth's axes: metres, metres a second, radians a
/// second; the PDU has the turn in the body's, and with algorithms 6 to 9 velocity and acceleration too.
struct EntityState {
  EntityId id;
  std::uint8_t exercise = 0;
  std::uint8_t force = 0;
  DisEntityType type;
  std::string marking;  ///< what of it is printable ASCII
  std::uint32_t timestamp = 0;
  glm::dvec3 location_m{0.0};
  glm::dvec3 velocity_m_s{0.0};
  glm::dvec3 acceleration_m_s2{0.0};
  glm::dvec3 turn_rad_s{0.0};
  BodyAxes body;
  std::uint8_t dead_reckoning = 1;  ///< algorithm, 0 to 9
  bool frozen = false;              ///< by its simulation: it stands
  bool active = true;               ///< else it has left the exercise
};

/// What a simulation manager asks of an entity: IEEE 1278.1-2012, 7.5.3 to 7.5.5.
struct SimulationOrder {
  enum class What { remove, go_on, stop } what = What::stop;
  std::uint8_t exercise = 0;
  EntityId receiver;
};

using Pdu = std::variant<EntityState, SimulationOrder, NoPose>;
/// An Entity State or one of those orders, by the PDU's type; NoPose for others. Articulated parts and other
/// variable parameters are skipped.
Pdu read_pdu(std::span<const std::byte> bytes);

/// The first PDU of a datagram, which is taken from it: several may stand in one, each as long as it says.
/// What follows and does not begin like a PDU belongs to the one before.
std::span<const std::byte> take_pdu(std::span<const std::byte>& datagram);

/// Whether an order is for this entity: each part of the receiver is its own, or stands for all, or, of the
/// entity, for none in particular (6.2.28: 65535, 0).
bool is_for(const EntityId& receiver, const EntityId& entity);

}  // namespace obliq
