#pragma once
#include <cstdint>
#include <vector>

#include "server/radar/settings.h"
#include "terrain/errors.h"

namespace obliq::wire {
class Pose;
}

namespace obliq::net {

void append(std::vector<FieldError>& errors, std::vector<FieldError> more);

/// More bins than a frame may have.
std::vector<FieldError> frame_size_faults(const RadarSettings& settings, std::int64_t max_bins);

/// What a frame of its own cannot do without.
std::vector<FieldError> missing_position(const wire::Pose& pose);

}  // namespace obliq::net
