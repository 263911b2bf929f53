#pragma once
// The server whose session is recorded: a small scene, two radars, limits that are soon reached, and no time
// limit that is.
#include <memory>
#include <vector>

#include "server/control/sections/radar.h"
#include "server/net/options.h"
#include "server/scene/scene.h"
#include "tests/integration/net_fixture.h"

namespace obliq::test {

/// Marched: the bits depend on no version of Embree.
std::shared_ptr<const Scene> session_scene();

/// "main", and "scan", which has two dwells of 1.5 s each, so that a slow machine misses none.
std::vector<RadarConfig> session_radars();

/// Rendering stops at the gate before the second wedge of every frame.
net::ServerOptions session_options(Gate& gate);

}  // namespace obliq::test
