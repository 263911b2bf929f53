#pragma once
// The log of an exercise in a recording. PROTOCOL.md, "The log of an exercise".
#include <cstdint>
#include <functional>
#include <string>

#include "client/status.h"

namespace obliq::wire {
class ExerciseEvents;
}

namespace obliq::client {

struct RecordedLog {
  std::uint64_t messages = 0;  ///< with events
  std::uint64_t damages = 0;   ///< places where bytes are no message
  bool is_whole = false;       ///< the file ends with a whole message
};

/// Calls `each` for each message with events, in the order of the file. Of all other messages the headers
/// alone are read. bad_argument when the file cannot be.
Status read_events(const std::string& path, const std::function<void(const wire::ExerciseEvents&)>& each,
                   RecordedLog& log);

/// Writes a message with these events behind the last of a recording that is whole. bad_argument when it is
/// not, or cannot be written.
Status append_events(const std::string& path, const wire::ExerciseEvents& events);

}  // namespace obliq::client
