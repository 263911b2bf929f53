#pragma once
// Which buildings a frame missed (design section 3).
#include <cstdint>
#include <functional>
#include <vector>

#include "server/truth/reference.h"
#include "terrain/buildings/buildings.h"

namespace obliq {

struct BuildingErrors {
  std::uint32_t visible = 0;  ///< the truth sees them (truth_sees_building)
  std::uint32_t missed = 0;   ///< of those, no sample carries their id
};

constexpr std::uint32_t kNoBuilding = 0xffffffffu;

/// truth[i] is of building i of the truth's world; seen(i) whether the frame has a sample of it.
BuildingErrors missed_buildings(const std::vector<BuildingTruth>& truth,
                                const std::function<bool(std::uint32_t)>& seen);

/// For each building of one world the index of the building with the same outline in another, kNoBuilding
/// where there is none. The two differ in cell size: roofs then differ, outlines do not.
std::vector<std::uint32_t> match_buildings(const Buildings& from, const Buildings& to);

}  // namespace obliq
