#include "server/radar/targets/target_place.h"

#include <cmath>

#include "server/radar/profile/plumb_line.h"
#include "server/radar/targets/target_motion.h"

namespace obliq {

std::optional<TargetPlace> place_target(const World& world, const Target& target, double age_s) {
  const auto motion = target_motion(target, age_s);
  if (!motion) return std::nullopt;
  const PlumbLine line(world.frame, motion->at.latitude_rad, motion->at.longitude_rad);
  double height_m = motion->at.height_m;
  if (motion->over_ground)
    if (const auto ground = line.meet(world.grid)) height_m += ground->height_m;
  const TargetPlace place{line.at_height(height_m), motion->heading_rad + line.north_rad(), height_m};
  const double sum = place.foot_m.x + place.foot_m.y + place.foot_m.z + place.heading_rad;
  if (!std::isfinite(sum)) return std::nullopt;
  return place;
}

}  // namespace obliq
