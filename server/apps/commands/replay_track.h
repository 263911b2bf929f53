#pragma once
// `obliq replay FILE --track OUT.csv`: where the recorded antenna was, for `obliq fly`.
#include <string>

namespace obliq {

/// Writes the poses of a radar's frames and dwells. out "-": standard output. Throws InputError, PartlyDone
/// where the recording is damaged.
void write_track(const std::string& recording, const std::string& radar, const std::string& out);

}  // namespace obliq
