#pragma once
#include "terrain/base/progress.h"

namespace obliq {

/// How far a long stage has come, on stderr: a line that is written over on a terminal, elsewhere a line now
/// and then, from the second second on. The time left is counted from where the fraction last fell.
Progress terminal_progress();

}  // namespace obliq
