#include "server/apps/dis/ownship.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <utility>

#include "server/apps/dis/byte_reader.h"
#include "server/apps/dis/dead_reckoning.h"
#include "server/radar/settings.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

// Limits of a pose: server/control/PARAMETERS.md, antenna.*.
constexpr double kLeastHeight_m = -1000;
constexpr double kMostHeight_m = 100000;
constexpr std::int64_t kMostTime_ns = 4'000'000'000'000'000'000;
std::string outside(const char* name, double value, double least, double most) {
  return value >= least && value <= most  // not so for NaN
             ? std::string()
             : fmt::format("{}: found {}; allowed: {} to {}", name, value, least, most);
}

struct Angles {
  double heading_deg;
  Attitude attitude;
};

/// Of a body against the axes of its place.
Angles angles_of(const BodyAxes& body, const LocalAxes& local) {
  return {std::atan2(glm::dot(body.nose, local.east), glm::dot(body.nose, local.north)) / kDegree_rad,
          {std::atan2(-glm::dot(body.right, local.up), -glm::dot(body.below, local.up)) / kDegree_rad,
           std::asin(std::clamp(glm::dot(body.nose, local.up), -1.0, 1.0)) / kDegree_rad}};
}

}  // namespace

std::string fault_of(const Attitude& attitude) {
  const std::string roll = outside("roll", attitude.roll_deg, -kMostAttitude_deg, kMostAttitude_deg);
  return roll.empty() ? outside("pitch", attitude.pitch_deg, -kMostAttitude_deg, kMostAttitude_deg) : roll;
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
    if (std::string fault = fault_of(*pose.attitude); !fault.empty()) return fault;
  if (pose.sim_time_ns < -kMostTime_ns || pose.sim_time_ns > kMostTime_ns)
    return fmt::format("sim_time_ns: found {}; allowed: {} to {}", pose.sim_time_ns, -kMostTime_ns,
                       kMostTime_ns);
  return {};
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

Attitude attitude_of(const EntityState& state) {
  return angles_of(state.body, local_axes(place_of(state.location_m))).attitude;
}

OwnshipPose dead_reckoned(const EntityState& state, double after_s) {
  const EntityMotion motion = reckoned(state, after_s);
  const Place at = place_of(motion.location_m);
  const auto [heading_deg, attitude] = angles_of(motion.body, local_axes(place_of(state.location_m)));
  OwnshipPose pose;
  pose.latitude_deg = at.latitude_deg;
  pose.longitude_deg = at.longitude_deg;
  pose.height_m = at.height_m;
  pose.heading_deg = heading_deg;
  if (fault_of(attitude).empty()) pose.attitude = attitude;
  const bool is_moved = state.frozen || (state.dead_reckoning >= 2 && state.dead_reckoning <= 9);
  const glm::dvec3 velocity_m_s = is_moved ? motion.velocity_m_s : state.velocity_m_s;
  const LocalAxes local = local_axes(at);
  if (glm::length(velocity_m_s) <= kMostSpeed_m_s)
    pose.velocity_m_s = {glm::dot(velocity_m_s, local.north), glm::dot(velocity_m_s, local.east),
                         glm::dot(velocity_m_s, local.up)};
  return pose;
}

}  // namespace obliq
