#pragma once
// Targets to and from their messages.
#include <string>
#include <vector>

#include "server/control/sections/target_config.h"
#include "terrain/base/errors.h"

namespace obliq::wire {
class Target;
class TargetType;
}  // namespace obliq::wire

namespace obliq {

/// Takes over the fields that the message carries; its times are the caller's. A type that is new to the
/// target brings its size. A place or a motion without a route ends the one that there was. Returns what does
/// not fit its field, a type that is none of these and what validate() finds; never throws on what a peer may
/// send.
[[nodiscard]] std::vector<FieldError> merge_message(const wire::Target& message,
                                                    const std::vector<TargetType>& types,
                                                    TargetConfig& target);
/// Whether it says where the target is or how it moves: a place, a velocity, a route. How it lies, and a
/// time, are neither.
bool says_motion(const wire::Target& message);

/// Every field but the times.
void write_message(const TargetConfig& target, wire::Target& message);
void write_message(const TargetType& type, wire::TargetType& message);
/// What write_message wrote.
TargetType read_message(const wire::TargetType& message);

}  // namespace obliq
