#pragma once
#include <vector>

#include "terrain/base/errors.h"

namespace obliq::wire {
class Pose;
}

namespace obliq::net {

void append(std::vector<FieldError>& errors, std::vector<FieldError> more);

/// What a frame of its own cannot do without.
std::vector<FieldError> missing_position(const wire::Pose& pose);

}  // namespace obliq::net
