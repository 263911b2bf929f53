#include "server/radar/targets/target_motion.h"

#include <cmath>
#include <glm/geometric.hpp>

#include "server/radar/simd/lanes/exact_math.h"
#include "server/radar/targets/route.h"
#include "terrain/base/units.h"
#include "terrain/tangent_step.h"

namespace obliq {
namespace {

constexpr double kFarthest_m = 10e6;
/// Of a target that is valid for a while: by the poses' clock it may be from so far ahead, and so much older
/// than it is valid. What is further off is of another clock.
constexpr double kMostAhead_s = 2;
constexpr double kMostBehind_s = 12;

double over_datum_m(const Target& target, double height_m) {
  return target.height_reference == HeightReference::ellipsoid ? height_m - target.geoid_undulation_m
                                                               : height_m;
}

}  // namespace

double seconds_between(std::int64_t from_ns, std::int64_t to_ns) {
  std::int64_t difference = 0;
  if (!__builtin_sub_overflow(to_ns, from_ns, &difference)) return static_cast<double>(difference) * 1e-9;
  return (static_cast<double>(to_ns) - static_cast<double>(from_ns)) * 1e-9;
}

std::optional<double> target_age(const Target& target, std::int64_t sim_time_ns, const TargetMoment& at) {
  const double since_arrival_s = seconds_between(target.arrived_ns, at.server_ns);
  if (target.valid_s > 0 && since_arrival_s > target.valid_s) return std::nullopt;
  if (!target.is_timed || !at.pose_is_timed) return since_arrival_s;
  const double age_s = seconds_between(target.sim_time_ns, sim_time_ns);
  if (target.valid_s > 0 && (age_s < -kMostAhead_s || age_s > target.valid_s + kMostBehind_s))
    return std::nullopt;
  return age_s;
}

std::optional<TargetMotion> target_motion(const Target& target, double age_s) {
  TargetMotion motion;
  motion.over_ground = target.height_reference == HeightReference::ground;
  double course_rad = 0;
  if (target.route) {
    const Route::Place place = target.route->at(age_s);
    motion.at = {place.latitude_deg * kDegree_rad, place.longitude_deg * kDegree_rad,
                 over_datum_m(target, place.height_m)};
    course_rad = place.course_deg * kDegree_rad;
  } else {
    const glm::dvec3 step_m = target.velocity_m_s * age_s + target.acceleration_m_s2 * (age_s * age_s / 2);
    if (!(glm::length(step_m) < kFarthest_m)) return std::nullopt;
    motion.at = {target.latitude_deg * kDegree_rad, target.longitude_deg * kDegree_rad,
                 motion.over_ground ? 0 : over_datum_m(target, target.height_m)};
    const glm::dvec3 level_m(step_m.x, motion.over_ground ? 0 : step_m.y, step_m.z);
    if (level_m != glm::dvec3(0.0)) motion.at = moved(motion.at, level_m);
    if (motion.over_ground) motion.at.height_m = target.height_m + step_m.y;
    const glm::dvec3 course = target.velocity_m_s + target.acceleration_m_s2 * age_s;
    course_rad = bearing_of(course.x, course.z);
  }
  const double heading_rad = target.heading_deg ? *target.heading_deg * kDegree_rad : course_rad;
  motion.heading_rad =
      std::remainder(heading_rad + target.heading_rate_deg_s * kDegree_rad * age_s, 360 * kDegree_rad);
  return motion;
}

std::optional<Target> brought_to(const Target& target, double age_s) {
  const auto motion = target_motion(target, age_s);
  if (!motion) return std::nullopt;
  Target there = target;
  there.latitude_deg = motion->at.latitude_rad / kDegree_rad;
  there.longitude_deg = motion->at.longitude_rad / kDegree_rad;
  there.height_m = motion->at.height_m;
  if (target.height_reference == HeightReference::ellipsoid) there.height_m += target.geoid_undulation_m;
  there.velocity_m_s += target.acceleration_m_s2 * age_s;
  if (target.heading_deg) there.heading_deg = motion->heading_rad / kDegree_rad;
  return there;
}

}  // namespace obliq
