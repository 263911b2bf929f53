#pragma once
#include <cstdint>
#include <string>

#include "server/flight/window.h"

namespace obliq {

/// What the files of a scene have for an antenna.
struct GroundThere {
  double coverage = 1;  ///< part of the disc within r_max for which there are files; voids are not looked for
  std::string warning;  ///< empty: the place itself is covered
};

/// What a SceneKeeper does and has done.
struct KeeperState {
  bool building = false;
  std::uint64_t swaps = 0;     ///< windows and reloads that serve or served
  std::uint64_t failures = 0;  ///< windows and reloads that could not be loaded
  std::string last_error;  ///< why ground is missing, or a reload was refused, at present; empty: all is well
  std::string last_failure;  ///< the newest, however long ago
  double well_s = 0;         ///< since it was over; 0: it is not, or there was none
  double last_build_s = 0;
  SceneWindow window;  ///< of the scene that serves
};

}  // namespace obliq
