#pragma once
#include <cstdint>

#include "server/radar/simd/buildings/sub_columns.h"
#include "server/radar/simd/lanes/kernel.h"

namespace obliq {

/// Bits of the edges of a part that are walls, face the antenna, and of whose direction less than a share
/// lies ahead at the tangent `middle`; most_along2: the square of that share.
OBLIQ_KERNEL(std::uint64_t, square_walls, const ConvexShape&, float middle, float most_along2);

}  // namespace obliq
