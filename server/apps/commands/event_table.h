#pragma once
// The log of an exercise as a table, or as a line of JSON an event.
#include <cstdint>
#include <string>

namespace obliq::wire {
class ExerciseEvent;
}

namespace obliq {

/// "sets receiver.gain_db = 6.0", "takes pose from ...", "bookmark: ...".
std::string event_words(const wire::ExerciseEvent& event);

/// A line: seconds from `start_ns`, number, time, client, radar, what.
std::string event_line(const wire::ExerciseEvent& event, std::int64_t start_ns);
/// What stands above them.
std::string event_heading();

/// Prints the log of a recording. Throws InputError, and PartlyDone where the file is damaged.
void print_recorded_events(const std::string& file, bool json);

}  // namespace obliq
