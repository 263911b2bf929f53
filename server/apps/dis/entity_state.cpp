#include "server/apps/dis/entity_state.h"

#include <fmt/core.h>

#include <array>
#include <charconv>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "server/apps/dis/byte_reader.h"
#include "server/radar/settings.h"

namespace obliq {
namespace {

using Bytes = std::span<const std::byte>;

constexpr std::size_t kHeaderBytes = 12;
constexpr int kOldest = 5, kNewest = 7;  // IEEE 1278.1-1995, 1278.1A-1998, 1278.1-2012: the same layout
// Heights that a target may have: server/control/PARAMETERS.md, target.height_m; and no place further from
// the earth's centre, so that the square of a coordinate still has a meaning.
constexpr double kLeastHeight_m = -1e3;
constexpr double kMostHeight_m = 1e6;
constexpr double kMostRadius_m = 7.4e6;
constexpr double kMostTurn_rad_s = 1000;

glm::dvec3 three_floats(Bytes bytes, std::size_t offset) {
  return {big<float>(bytes, offset), big<float>(bytes, offset + 4), big<float>(bytes, offset + 8)};
}

/// 6.2.54: a character set, then 11 characters, of which those behind a zero have no meaning.
std::string marking_of(Bytes bytes) {
  constexpr std::size_t kAt = 129, kCharacters = 11;
  std::string text;
  for (std::size_t k = 0; k < kCharacters; ++k) {
    const auto letter = big<char>(bytes, kAt + k);
    if (letter == '\0') break;
    if (letter >= ' ' && letter <= '~') text += letter;
  }
  text.erase(text.find_last_not_of(' ') + 1);
  return text;
}

DisEntityType type_of(Bytes bytes) {
  const auto byte = [&](std::size_t at) { return big<std::uint8_t>(bytes, at); };
  return {byte(20), byte(21), big<std::uint16_t>(bytes, 22), byte(24), byte(25), byte(26), byte(27)};
}

/// What is wrong with its size; empty: nothing.
std::string fault_of_length(Bytes bytes) {
  if (bytes.size() < kEntityStateBytes)
    return fmt::format("found {} bytes; allowed: {} or more", bytes.size(), kEntityStateBytes);
  const std::size_t length = big<std::uint16_t>(bytes, 8);
  if (length < kEntityStateBytes || length > bytes.size())
    return fmt::format("length: found {}; allowed: {} to {}", length, kEntityStateBytes, bytes.size());
  constexpr std::size_t kParameterBytes = 16;
  const std::size_t parameters = big<std::uint8_t>(bytes, 19);
  if (length < kEntityStateBytes + kParameterBytes * parameters)
    return fmt::format("length: found {} with {} variable parameters; allowed: {} or more", length,
                       parameters, kEntityStateBytes + kParameterBytes * parameters);
  return {};
}

/// The same of its numbers. Written so that NaN fails.
std::string fault_of(const EntityState& state, const glm::dvec3& orientation) {
  const auto within = [](const glm::dvec3& vector, double most) {
    return is_finite(vector) && glm::length(vector) <= most;
  };
  if (!within(state.location_m, kMostRadius_m) || glm::length(state.location_m) == 0)
    return "location: found a point that is not near the earth";
  if (!within(state.velocity_m_s, kMostSpeed_m_s) || !within(state.acceleration_m_s2, kMostSpeed_m_s) ||
      !within(state.turn_rad_s, kMostTurn_rad_s) || !is_finite(orientation))
    return "velocity, acceleration, turn or orientation: found no number, or one that is too large";
  if (const double height_m = place_of(state.location_m).height_m;
      !(height_m >= kLeastHeight_m && height_m <= kMostHeight_m))
    return fmt::format("height above the ellipsoid: found {:.0f} m; allowed: {} to {}", height_m,
                       kLeastHeight_m, kMostHeight_m);
  return {};
}

std::variant<EntityState, NoPose> read_entity_state(Bytes bytes) {
  if (std::string fault = fault_of_length(bytes); !fault.empty()) return NoPose{std::move(fault)};
  EntityState state;
  state.exercise = big<std::uint8_t>(bytes, 1);
  state.timestamp = big<std::uint32_t>(bytes, 4);
  state.id = {big<std::uint16_t>(bytes, 12), big<std::uint16_t>(bytes, 14), big<std::uint16_t>(bytes, 16)};
  state.force = big<std::uint8_t>(bytes, 18);
  state.type = type_of(bytes);
  state.velocity_m_s = three_floats(bytes, 36);
  state.location_m = {big<double>(bytes, 48), big<double>(bytes, 56), big<double>(bytes, 64)};
  const glm::dvec3 orientation = three_floats(bytes, 72);
  // Appearance of platforms, and of all other kinds that move: SISO-REF-010, bit 21 frozen, bit 23
  // deactivated.
  const auto appearance = big<std::uint32_t>(bytes, 84);
  state.frozen = (appearance >> 21 & 1) != 0;
  state.active = (appearance >> 23 & 1) == 0;
  state.dead_reckoning = big<std::uint8_t>(bytes, 88);
  state.acceleration_m_s2 = three_floats(bytes, 104);
  state.turn_rad_s = three_floats(bytes, 116);
  state.marking = marking_of(bytes);
  if (std::string fault = fault_of(state, orientation); !fault.empty()) return NoPose{std::move(fault)};
  state.body = body_axes(orientation.x, orientation.y, orientation.z);
  state.turn_rad_s = from_body(state.body, state.turn_rad_s);
  // Table "dead reckoning algorithms", annex E: what moves by 6 to 9 is said along the body's axes.
  if (state.dead_reckoning >= 6 && state.dead_reckoning <= 9) {
    state.velocity_m_s = from_body(state.body, state.velocity_m_s);
    state.acceleration_m_s2 = from_body(state.body, state.acceleration_m_s2);
  }
  return state;
}

/// Of an order, how long its PDU is: IEEE 1278.1-2012, tables of 7.5.
struct OrderType {
  std::uint8_t type;
  SimulationOrder::What what;
  std::size_t bytes;
};
constexpr OrderType kOrders[] = {{12, SimulationOrder::What::remove, 28},
                                 {13, SimulationOrder::What::go_on, 44},
                                 {14, SimulationOrder::What::stop, 40}};

bool is_version(int version) { return version >= kOldest && version <= kNewest; }

}  // namespace

std::optional<EntityId> parse_entity_id(const std::string& text) {
  std::array<std::uint16_t, 3> parts{};
  const char* at = text.data();
  const char* const end = at + text.size();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const auto [past, error] = std::from_chars(at, end, parts[i]);
    const bool last = i + 1 == parts.size();
    if (error != std::errc() || (last ? past != end : past == end || *past != ':')) return std::nullopt;
    at = past + (last ? 0 : 1);
  }
  return EntityId{parts[0], parts[1], parts[2]};
}

std::string text_of(const EntityId& id) {
  return fmt::format("{}:{}:{}", id.site, id.application, id.entity);
}

Pdu read_pdu(Bytes bytes) {
  constexpr int kEntityState = 1;  // IEEE 1278.1-2012, table of PDU types
  if (bytes.size() < kHeaderBytes)
    return NoPose{fmt::format("found {} bytes; allowed: {} or more", bytes.size(), kEntityStateBytes)};
  if (const auto version = big<std::uint8_t>(bytes, 0); !is_version(version))
    return NoPose{fmt::format("protocol version: found {}; allowed: {} to {}", version, kOldest, kNewest)};
  const int type = big<std::uint8_t>(bytes, 2);
  for (const OrderType& order : kOrders) {
    if (type != order.type) continue;
    const auto length = big<std::uint16_t>(bytes, 8);
    if (bytes.size() < order.bytes || (length != 0 && length != order.bytes))
      return NoPose{fmt::format("PDU of type {}: found {} bytes and length {}; allowed: {}", type,
                                bytes.size(), length, order.bytes)};
    return SimulationOrder{
        order.what,
        big<std::uint8_t>(bytes, 1),
        {big<std::uint16_t>(bytes, 18), big<std::uint16_t>(bytes, 20), big<std::uint16_t>(bytes, 22)}};
  }
  if (type != kEntityState)
    return NoPose{fmt::format("PDU type: found {}; allowed: 1, Entity State, or 12 to 14", type)};
  auto state = read_entity_state(bytes);
  if (auto* none = std::get_if<NoPose>(&state)) return std::move(*none);
  return std::get<EntityState>(std::move(state));
}

Bytes take_pdu(Bytes& datagram) {
  const Bytes all = std::exchange(datagram, Bytes());
  if (all.size() < kHeaderBytes) return all;
  const std::size_t length = big<std::uint16_t>(all, 8);
  if (length < kHeaderBytes || length + kHeaderBytes > all.size()) return all;
  const Bytes rest = all.subspan(length);
  const std::size_t next = big<std::uint16_t>(rest, 8);
  if (!is_version(big<std::uint8_t>(rest, 0)) || next < kHeaderBytes || next > rest.size()) return all;
  datagram = rest;
  return all.first(length);
}

bool is_for(const EntityId& receiver, const EntityId& entity) {
  constexpr std::uint16_t kAll = 0xFFFF;
  const auto fits = [](std::uint16_t asked, std::uint16_t own) { return asked == own || asked == kAll; };
  return fits(receiver.site, entity.site) && fits(receiver.application, entity.application) &&
         (fits(receiver.entity, entity.entity) || receiver.entity == 0);
}

}  // namespace obliq
