#include "server/apps/ownship/ownship.h"

#include <fmt/core.h>

#include <GeographicLib/Geocentric.hpp>
#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <numbers>
#include <utility>

#include "server/radar/settings.h"

namespace obliq {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
// Limits of a pose: server/control/PARAMETERS.md, antenna.*.
constexpr double kLeastHeight_m = -1000;
constexpr double kMostHeight_m = 100000;
constexpr std::int64_t kMostTime_ns = 4'000'000'000'000'000'000;
// Further from the earth's centre than that is no aircraft; the square of such a number still has a meaning.
constexpr double kMostRadius_m = 7e6;

template <typename Number, std::endian order>
Number number_at(std::span<const std::byte> bytes, std::size_t offset) {
  std::array<std::byte, sizeof(Number)> raw;
  std::memcpy(raw.data(), bytes.data() + offset, sizeof raw);
  if constexpr (order != std::endian::native)
    for (std::size_t i = 0; i < raw.size() / 2; ++i) std::swap(raw[i], raw[raw.size() - 1 - i]);
  return std::bit_cast<Number>(raw);
}

template <typename Number>
Number little(std::span<const std::byte> bytes, std::size_t offset) {
  return number_at<Number, std::endian::little>(bytes, offset);
}
template <typename Number>
Number big(std::span<const std::byte> bytes, std::size_t offset) {
  return number_at<Number, std::endian::big>(bytes, offset);
}

std::string outside(const char* name, double value, double least, double most) {
  return value >= least && value <= most  // not so for NaN
             ? std::string()
             : fmt::format("{}: found {}; allowed: {} to {}", name, value, least, most);
}

/// Why not; empty: within the limits of a pose.
std::string fault_of(const OwnshipPose& pose) {
  for (const std::string& fault :
       {outside("latitude", pose.latitude_deg, -90, 90), outside("longitude", pose.longitude_deg, -180, 180),
        outside("height", pose.height_m, kLeastHeight_m, kMostHeight_m),
        outside("heading", pose.heading_deg, -360, 360)})
    if (!fault.empty()) return fault;
  constexpr const char* kParts[] = {"velocity north", "velocity east", "velocity up"};
  for (std::size_t i = 0; pose.velocity_m_s && i < 3; ++i)
    if (std::string fault = outside(kParts[i], (*pose.velocity_m_s)[i], -kMostSpeed_m_s, kMostSpeed_m_s);
        !fault.empty())
      return fault;
  if (pose.attitude)
    if (std::string fault = obliq::fault_of(*pose.attitude); !fault.empty()) return fault;
  if (pose.sim_time_ns < -kMostTime_ns || pose.sim_time_ns > kMostTime_ns)
    return fmt::format("sim_time_ns: found {}; allowed: {} to {}", pose.sim_time_ns, -kMostTime_ns,
                       kMostTime_ns);
  return {};
}

std::array<double, 3> three_floats(std::span<const std::byte> bytes, std::size_t offset) {
  return {big<float>(bytes, offset), big<float>(bytes, offset + 4), big<float>(bytes, offset + 8)};
}

/// No std::hypot: libstdc++'s of three arguments, (0, 0, NaN), is 0.
double size_of(const std::array<double, 3>& v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

struct Place {
  double latitude_deg, longitude_deg, height_m;
};

Place place_of(const std::array<double, 3>& location_m) {
  Place place{};
  GeographicLib::Geocentric::WGS84().Reverse(location_m[0], location_m[1], location_m[2], place.latitude_deg,
                                             place.longitude_deg, place.height_m);
  return place;
}

using Vector = std::array<double, 3>;

double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// North, east, down of a place, in the earth's axes.
std::array<Vector, 3> local_axes(const Place& at) {
  const double phi = at.latitude_deg * kDegree;
  const double lambda = at.longitude_deg * kDegree;
  const double across = std::cos(lambda), along = std::sin(lambda);
  return {{{-std::sin(phi) * across, -std::sin(phi) * along, std::cos(phi)},
           {-along, across, 0},
           {-std::cos(phi) * across, -std::cos(phi) * along, -std::sin(phi)}}};
}

/// The body's x (nose), y (right) and z (below), in the earth's axes. IEEE 1278.1-2012, 6.2.32: the earth's
/// axes turn by psi about z, then by theta about y, then by phi about x.
std::array<Vector, 3> body_axes(double psi, double theta, double phi) {
  const Vector nose{std::cos(theta) * std::cos(psi), std::cos(theta) * std::sin(psi), -std::sin(theta)};
  const Vector level{-std::sin(psi), std::cos(psi), 0};  // y before phi
  const Vector below{std::sin(theta) * std::cos(psi), std::sin(theta) * std::sin(psi), std::cos(theta)};
  Vector right{}, under{};
  for (std::size_t i = 0; i < 3; ++i) {
    right[i] = std::cos(phi) * level[i] + std::sin(phi) * below[i];
    under[i] = std::cos(phi) * below[i] - std::sin(phi) * level[i];
  }
  return {nose, right, under};
}

/// Heading, roll and pitch of a body against the axes of its place.
void take_orientation(const std::array<Vector, 3>& body, const std::array<Vector, 3>& local,
                      EntityState& state) {
  const auto& [nose, right, under] = body;
  const auto& [north, east, down] = local;
  state.heading_deg = std::atan2(dot(nose, east), dot(nose, north)) / kDegree;
  state.attitude.pitch_deg = std::asin(std::clamp(-dot(nose, down), -1.0, 1.0)) / kDegree;
  state.attitude.roll_deg = std::atan2(dot(right, down), dot(under, down)) / kDegree;
}

}  // namespace

std::string fault_of(const Attitude& attitude) {
  const std::string roll = outside("roll", attitude.roll_deg, -kMostAttitude_deg, kMostAttitude_deg);
  return roll.empty() ? outside("pitch", attitude.pitch_deg, -kMostAttitude_deg, kMostAttitude_deg) : roll;
}

std::variant<OwnshipPose, NoPose> read_pose_datagram(std::span<const std::byte> bytes) {
  constexpr unsigned kHasVelocity = 1, kHasAttitude = 2;
  const bool has_motion = bytes.size() == kMotionDatagramBytes;
  if (bytes.size() != kPoseDatagramBytes && !has_motion)
    return NoPose{fmt::format("found {} bytes; allowed: {} of version 1, {} of version 2", bytes.size(),
                              kPoseDatagramBytes, kMotionDatagramBytes)};
  if (std::memcmp(bytes.data(), "OBLP", 4) != 0) return NoPose{"found no \"OBLP\" at its start"};
  const int allowed = has_motion ? 2 : 1;
  if (const auto version = little<std::uint16_t>(bytes, 4); version != allowed)
    return NoPose{fmt::format("version: found {} in {} bytes; allowed: {}", version, bytes.size(), allowed)};
  OwnshipPose pose;
  pose.sim_time_ns = little<std::int64_t>(bytes, 8);
  pose.latitude_deg = little<double>(bytes, 16);
  pose.longitude_deg = little<double>(bytes, 24);
  pose.height_m = little<double>(bytes, 32);
  pose.heading_deg = little<double>(bytes, 40);
  pose.pose_id = little<std::uint64_t>(bytes, 48);
  const unsigned has = has_motion ? little<std::uint16_t>(bytes, 6) : 0;
  if ((has & kHasVelocity) != 0)
    pose.velocity_m_s = {little<double>(bytes, 56), little<double>(bytes, 64), little<double>(bytes, 72)};
  if ((has & kHasAttitude) != 0) pose.attitude = {little<double>(bytes, 80), little<double>(bytes, 88)};
  if (std::string fault = fault_of(pose); !fault.empty()) return NoPose{std::move(fault)};
  return pose;
}

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

std::variant<EntityState, NoPose> read_entity_state(std::span<const std::byte> bytes) {
  constexpr std::uint8_t kEntityState =
      1;  // PDU type, and the family of entity information: IEEE 1278.1-2012, table 26
  if (bytes.size() < kEntityStateBytes)
    return NoPose{fmt::format("found {} bytes; allowed: {} or more", bytes.size(), kEntityStateBytes)};
  if (const auto type = big<std::uint8_t>(bytes, 2); type != kEntityState)
    return NoPose{fmt::format("PDU type: found {}; allowed: 1, Entity State, or 12 to 14", type)};
  if (const auto length = big<std::uint16_t>(bytes, 8); length < kEntityStateBytes || length > bytes.size())
    return NoPose{
        fmt::format("length: found {}; allowed: {} to {}", length, kEntityStateBytes, bytes.size())};
  EntityState state;
  state.exercise = big<std::uint8_t>(bytes, 1);
  state.id = {big<std::uint16_t>(bytes, 12), big<std::uint16_t>(bytes, 14), big<std::uint16_t>(bytes, 16)};
  state.velocity_m_s = three_floats(bytes, 36);
  state.location_m = {big<double>(bytes, 48), big<double>(bytes, 56), big<double>(bytes, 64)};
  const double psi = big<float>(bytes, 72);
  const double theta = big<float>(bytes, 76);
  const double phi = big<float>(bytes, 80);
  state.dead_reckoning = big<std::uint8_t>(bytes, 88);
  // Appearance of platforms, and of all other kinds that move: SISO-REF-010, bit 21 frozen, bit 23
  // deactivated.
  const auto appearance = big<std::uint32_t>(bytes, 84);
  state.frozen = (appearance >> 21 & 1) != 0;
  state.active = (appearance >> 23 & 1) == 0;
  state.acceleration_m_s2 = three_floats(bytes, 104);
  if (!(size_of(state.location_m) <= kMostRadius_m) || !(size_of(state.location_m) > 0))
    return NoPose{"location: found a point that is no place near the earth"};
  if (!(size_of(state.velocity_m_s) <= kMostSpeed_m_s) ||
      !(size_of(state.acceleration_m_s2) <= kMostSpeed_m_s) || !std::isfinite(psi) || !std::isfinite(theta) ||
      !std::isfinite(phi))
    return NoPose{"velocity, acceleration or orientation: found no number, or one that is too large"};
  const Place at = place_of(state.location_m);
  if (!(at.height_m >= kLeastHeight_m && at.height_m <= kMostHeight_m))
    return NoPose{fmt::format("height above the ellipsoid: found {:.0f} m; allowed: {} to {}", at.height_m,
                              kLeastHeight_m, kMostHeight_m)};
  const std::array<Vector, 3> body = body_axes(psi, theta, phi);
  take_orientation(body, local_axes(at), state);
  // Table "dead reckoning algorithms", annex E: the velocity of 6 to 9 is along the body's axes.
  if (state.dead_reckoning >= 6 && state.dead_reckoning <= 9) {
    const Vector along = std::exchange(state.velocity_m_s, Vector{});
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (std::size_t i = 0; i < 3; ++i) state.velocity_m_s[i] += along[axis] * body[axis][i];
  }
  return state;
}

namespace {

/// Of an order, how long its PDU is: IEEE 1278.1-2012, tables of 7.5.
struct OrderType {
  std::uint8_t type;
  SimulationOrder::What what;
  std::size_t bytes;
};
constexpr OrderType kOrders[] = {{12, SimulationOrder::What::remove, 28},
                                 {13, SimulationOrder::What::go_on, 44},
                                 {14, SimulationOrder::What::stop, 40}};

}  // namespace

std::variant<EntityState, SimulationOrder, NoPose> read_pdu(std::span<const std::byte> bytes) {
  constexpr std::size_t kHeaderBytes = 12;
  const int type = bytes.size() < kHeaderBytes ? -1 : big<std::uint8_t>(bytes, 2);
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
  auto state = read_entity_state(bytes);
  if (auto* none = std::get_if<NoPose>(&state)) return std::move(*none);
  return std::get<EntityState>(state);
}

bool is_for(const EntityId& receiver, const EntityId& entity) {
  constexpr std::uint16_t kAll = 0xFFFF;
  const auto fits = [](std::uint16_t asked, std::uint16_t own) { return asked == own || asked == kAll; };
  return fits(receiver.site, entity.site) && fits(receiver.application, entity.application) &&
         (fits(receiver.entity, entity.entity) || receiver.entity == 0);
}

OwnshipPose dead_reckoned(const EntityState& state, double after_s) {
  // IEEE 1278.1-2012, annex E.8, table E.1. FPW, RPW: velocity; RVW, FVW: acceleration, too; all in world
  // axes.
  const int algorithm = state.frozen ? 1 : state.dead_reckoning;  // 1: static
  const double velocity = algorithm >= 2 && algorithm <= 5 ? after_s : 0;
  const double acceleration = algorithm == 4 || algorithm == 5 ? 0.5 * after_s * after_s : 0;
  std::array<double, 3> location_m{};
  for (std::size_t i = 0; i < 3; ++i)
    location_m[i] =
        state.location_m[i] + state.velocity_m_s[i] * velocity + state.acceleration_m_s2[i] * acceleration;
  const Place at = place_of(location_m);
  OwnshipPose pose;
  pose.latitude_deg = at.latitude_deg;
  pose.longitude_deg = at.longitude_deg;
  pose.height_m = at.height_m;
  pose.heading_deg = state.heading_deg;
  if (fault_of(state.attitude).empty()) pose.attitude = state.attitude;
  // d/dt of the location above; one that stands without dead reckoning has the velocity that it was sent
  // with.
  const double gained_s = acceleration > 0 ? after_s : 0;
  Vector velocity_m_s = state.velocity_m_s;
  for (std::size_t i = 0; i < 3; ++i)
    velocity_m_s[i] = state.frozen ? 0 : velocity_m_s[i] + state.acceleration_m_s2[i] * gained_s;
  const auto [north, east, down] = local_axes(at);
  if (size_of(velocity_m_s) <= kMostSpeed_m_s)
    pose.velocity_m_s = {dot(velocity_m_s, north), dot(velocity_m_s, east), -dot(velocity_m_s, down)};
  return pose;
}

}  // namespace obliq
