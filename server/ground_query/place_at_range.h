#pragma once
#include <optional>

#include "proto/ground_record.h"
#include "server/radar/geometry/pose.h"
#include "server/scene/scene.h"

namespace obliq {

/// Where a slant range from the antenna meets the ground in one direction.
struct PlaceAtRange {
  wire::GroundState state = wire::GroundState::known;
  WorldPoint place;  ///< where the state is known
};

/// The nearest place at a true bearing whose ground is range_m away. Buildings do not count.
PlaceAtRange place_at_range(const Scene& scene, const Pose& antenna, double bearing_deg, double range_m);

}  // namespace obliq
