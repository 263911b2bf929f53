#pragma once
#include <optional>
#include <vector>

#include "server/radar/settings.h"
#include "terrain/base/errors.h"
#include "terrain/world.h"

namespace obliq {

/// An antenna placed in a world. bearing_world_rad = true bearing + meridian convergence (north_rad).
struct Pose {
  WorldPoint antenna;
  double bearing_world_rad = 0;
  double north_rad = 0;
  double ground_y_m = 0;  ///< world y of the ground under the antenna; NaN where no ground is known
  PoseSettings settings;
};

/// Places an antenna. On failure (height above unknown ground, below the ground, inside a building)
/// returns nothing and appends to errors.
std::optional<Pose> place_antenna(const World& world, const PoseSettings& settings,
                                  std::vector<FieldError>& errors);

}  // namespace obliq
