#pragma once
#include <glm/vec3.hpp>

#include "terrain/frames.h"

namespace obliq {

/// A place so far to the east, up and to the north of another, in the straight axes of that one.
Geodetic moved(const Geodetic& from, const glm::dvec3& step_m);

}  // namespace obliq
