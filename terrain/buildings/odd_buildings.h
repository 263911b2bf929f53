#pragma once
#include <cstdint>

#include "terrain/buildings/buildings.h"

namespace obliq {

/// Buildings that stand, and look as if their data were at fault.
struct OddBuildings {
  std::uint64_t slivers = 0;  ///< no wider on average than kSliver_m
  std::uint64_t copies = 0;   ///< where another of the same size stands, both to kSame_m
};

/// Twice the area over the circumference: what is left over where outlines were cut, or overlap.
constexpr double kSliver_m = 0.1;

/// Two data sets of the same town differ by less, and no two buildings of a size stand so close.
constexpr float kSame_m = 0.5f;

/// In a time that is proportional to their number, wherever they stand.
OddBuildings count_odd(const Buildings& buildings);

}  // namespace obliq
