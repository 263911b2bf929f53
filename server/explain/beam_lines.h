#pragma once
#include <string>
#include <vector>

#include "server/explain/explanation.h"

namespace obliq {

/// What the beam and the pulse of the scene do to its bins, a sentence each; nothing where they are off.
std::vector<std::string> beam_lines(const SceneFacts& facts);

}  // namespace obliq
