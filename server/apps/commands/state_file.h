#pragma once
// The file of an exercise's state: TOML with the keys of a scene file, for each radar all of them.
#include <filesystem>
#include <string>

namespace obliq::wire {
class ExerciseState;
}

namespace obliq {

/// Throws InputError where the server's values are none of ours.
std::string state_text(const wire::ExerciseState& state);

/// Throws InputError "FILE:LINE: ..." for a file that is not a state, of a later version, cut, or has values
/// out of their limits. What goes with the scene that is served the server says.
wire::ExerciseState read_state_file(const std::filesystem::path& path);

}  // namespace obliq
