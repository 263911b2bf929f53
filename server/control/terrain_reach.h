#pragma once
#include "server/control/scene_config.h"

namespace obliq {

/// Ground is loaded to this distance around a radar that looks this far: a quarter more, so
/// that it can move without running out of terrain.
double loaded_radius_m(double r_max_m);

/// Tells the terrain where the configured radars stand, how far they look and how finely they sample: the
/// first one's position is the scene's origin.
void set_terrain_reach(SceneConfig& config);

}  // namespace obliq
