#include "server/apps/dis/entity_target.h"

#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include "proto/obliq.pb.h"
#include "server/control/sections/target_config.h"
#include "server/radar/settings.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

/// North, east, up.
glm::dvec3 along(const LocalAxes& local, const glm::dvec3& vector) {
  return {glm::dot(vector, local.north), glm::dot(vector, local.east), glm::dot(vector, local.up)};
}

bool within(const glm::dvec3& vector, double most) {
  return glm::all(glm::lessThanEqual(glm::abs(vector), glm::dvec3(most)));
}

bool is_on_ground(const DisEntityType& type) {
  constexpr int kPlatform = 1, kLifeForm = 3, kLand = 1, kSurface = 3;  // SISO-REF-010
  return (type.kind == kPlatform || type.kind == kLifeForm) &&
         (type.domain == kLand || type.domain == kSurface);
}

/// Of the nose, d/dt atan2(east, north), degrees a second; one that points up has none.
double heading_rate_deg_s(const glm::dvec3& nose, const glm::dvec3& nose_rate) {
  const double square = nose.x * nose.x + nose.y * nose.y;
  constexpr double kSteep = 1e-6;
  return square < kSteep ? 0 : (nose.x * nose_rate.y - nose.y * nose_rate.x) / square / kDegree_rad;
}

}  // namespace

std::uint64_t target_id(const EntityId& id) {
  constexpr std::uint64_t kOfDis = std::uint64_t{1} << 48;
  return kOfDis | std::uint64_t{id.site} << 32 | std::uint64_t{id.application} << 16 | id.entity;
}

bool write_target(const EntityTable::Moving& entity, const EntityKinds::Match& kind,
                  const EntityHeights& heights, wire::Target& target) {
  const auto& [state, motion] = entity;
  const Place at = place_of(motion.location_m);
  const LocalAxes local = local_axes(at);
  glm::dvec3 velocity = along(local, motion.velocity_m_s);
  glm::dvec3 acceleration = along(local, motion.acceleration_m_s2);
  if (!(at.height_m >= kLeastTargetHeight_m && at.height_m <= kMostTargetHeight_m) ||
      !within(velocity, kMostSpeed_m_s))
    return false;
  if (!within(acceleration, kMostTargetAcceleration_m_s2)) acceleration = glm::dvec3(0.0);
  const bool on_ground = heights.on_ground && is_on_ground(state.type);
  if (on_ground) velocity.z = acceleration.z = 0;

  target.set_id(target_id(state.id));
  target.set_name(state.marking.empty() ? text_of(state.id) : state.marking);
  target.set_latitude_deg(at.latitude_deg);
  target.set_longitude_deg(at.longitude_deg);
  target.set_height_m(on_ground ? 0 : at.height_m);
  target.set_height_reference(on_ground ? wire::GROUND : wire::ELLIPSOID);
  if (!on_ground) target.set_geoid_undulation_m(heights.undulation_m);
  target.set_velocity_north_m_s(velocity.x);
  target.set_velocity_east_m_s(velocity.y);
  target.set_velocity_up_m_s(velocity.z);
  target.set_acceleration_north_m_s2(acceleration.x);
  target.set_acceleration_east_m_s2(acceleration.y);
  target.set_acceleration_up_m_s2(acceleration.z);
  const glm::dvec3 nose = along(local, motion.body.nose);
  target.set_heading_deg(std::atan2(nose.y, nose.x) / kDegree_rad);
  const double rate_deg_s =
      heading_rate_deg_s(nose, along(local, glm::cross(motion.turn_rad_s, motion.body.nose)));
  target.set_heading_rate_deg_s(std::abs(rate_deg_s) <= kMostHeadingRate_deg_s ? rate_deg_s : 0);

  if (kind.of_server) {
    target.set_type(kind.type->name);
    return true;
  }
  const TargetSize& size = kind.type->size;
  target.set_type("");
  target.set_rcs_dbsm(size.rcs_dbsm);
  target.set_swerling(size.swerling);
  target.set_length_m(size.length_m);
  target.set_width_m(size.width_m);
  target.set_top_m(size.top_m);
  return true;
}

}  // namespace obliq
