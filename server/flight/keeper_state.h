#pragma once
#include <cstdint>
#include <string>

#include "server/flight/window.h"

namespace obliq {

/// What a SceneKeeper does and has done.
struct KeeperState {
  bool building = false;
  std::uint64_t swaps = 0;     ///< windows and reloads that serve or served
  std::uint64_t failures = 0;  ///< windows and reloads that could not be loaded
  std::string last_error;      ///< of the newest attempt; empty: it succeeded
  double last_build_s = 0;
  SceneWindow window;  ///< of the scene that serves
};

}  // namespace obliq
