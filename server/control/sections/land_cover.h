#pragma once
#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "server/control/key.h"

namespace obliq {

/// One class of a land cover map.
struct LandCoverClass {
  int value;
  std::string_view material;  ///< one of those that ship; empty: no clutter table has it
};

/// All classes of a scheme that surfaces.scheme may name, in the order of its legend; nothing for other
/// names.
std::optional<std::vector<LandCoverClass>> land_cover(std::string_view scheme);

inline constexpr std::array kLandCoverSchemes{Choice{"nlcd"}, Choice{"worldcover"}};

}  // namespace obliq
