#pragma once
// Settings and poses to and from their messages, field by field through the table of parameters.
#include <vector>

#include "server/radar/settings.h"
#include "terrain/base/errors.h"

namespace obliq::wire {
class RadarSettings;
class Pose;
}  // namespace obliq::wire

namespace obliq {

/// Takes over the fields that the message carries; absent ones keep their value. Returns what does not fit
/// its field (an enumerator that does not exist); limits are validate()'s. Never throws on what a peer may
/// send.
[[nodiscard]] std::vector<FieldError> merge_message(const wire::RadarSettings& message,
                                                    RadarSettings& settings);
[[nodiscard]] std::vector<FieldError> merge_message(const wire::Pose& message, PoseSettings& pose);

/// Writes every field.
void write_message(const RadarSettings& settings, wire::RadarSettings& message);
void write_message(const PoseSettings& pose, wire::Pose& message);

}  // namespace obliq
