#pragma once
#include <string>
#include <vector>

#include "server/control/mount.h"

namespace obliq::net {

struct LiveRadar;

/// What live radars ride on: one pose moves all of them. It is held as their poses are, all together.
struct Platform {
  std::string name;
  PoseSettings initial;  ///< as the scene file has it
  PoseSettings pose;     ///< the newest, as it was sent
  std::vector<LiveRadar*> radars;
};

}  // namespace obliq::net
