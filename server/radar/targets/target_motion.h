#pragma once
#include <cstdint>
#include <optional>

#include "server/radar/targets/target.h"
#include "terrain/frames.h"

namespace obliq {

/// How far a target has come.
struct TargetMotion {
  Geodetic at;  ///< its height over the ground, or over the datum, as over_ground says
  bool over_ground = false;
  double heading_rad = 0;  ///< of its nose, clockwise from true north
};

/// So long after its place was given, or before it: along its route, or straight on by velocity and
/// acceleration, p + v t + a t^2 / 2 in the axes of that place. Nothing where it would be a quarter of the
/// earth's way from there, or more.
std::optional<TargetMotion> target_motion(const Target& target, double age_s);

/// The same as a target whose place and motion are those of that moment. Its times stay.
std::optional<Target> brought_to(const Target& target, double age_s);

/// How long ago at that moment, seconds; nothing where it is not in the world then: its validity is over, or
/// its clock is not that of the pose. sim_time_ns: of the pose.
std::optional<double> target_age(const Target& target, std::int64_t sim_time_ns, const TargetMoment& at);

/// Seconds from one time to another, in nanoseconds, however far apart they are.
double seconds_between(std::int64_t from_ns, std::int64_t to_ns);

}  // namespace obliq
