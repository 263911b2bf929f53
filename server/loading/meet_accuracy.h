#pragma once
#include <string>

#include "server/control/scene_config.h"
#include "server/loading/terminal_progress.h"

namespace obliq {

/// When the scene has an [accuracy]: chooses each radar's pixels and, where it is "auto", the cell size, such
/// that median error and gaps, measured on a few wedges of the user's own view against the truth of the
/// finest sensible grid, stay within what is asked. `say` hears what was chosen and its measured error.
/// Without an [accuracy] it does nothing. Throws InputError, with the best that was reached, when nothing is
/// good enough.
void meet_accuracy(SceneConfig& config, const Say& say, const Progress& progress);

}  // namespace obliq
