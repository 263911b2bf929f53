#pragma once
// `obliq replay FILE --targets OUT.csv`: the truth of a recording.
#include <string>

#include "client/recording/recorded_frames.h"

namespace obliq {

/// Writes a line for each target of each of a radar's frames. out "-": standard output. Throws InputError,
/// also where the recording has no truth, and PartlyDone where it is damaged.
void write_targets(const std::string& recording, const client::RecordingStart& start, const std::string& out);

}  // namespace obliq
