#pragma once
#include <cstdint>

namespace obliq {

/// How rays find what they meet first: over ground by a march of its cells in double, with Embree for those
/// that may meet a building first; or all of them by Embree, which takes longer. Both are answered in double
/// precision, and the bits are the same but where Embree takes the other side of an edge within its rounding.
enum class RayMethod : std::uint8_t { march, embree };

}  // namespace obliq
