#pragma once
#include "server/explain/explanation.h"

namespace obliq {

/// Completes a comparison: the verdict, the threshold for this scene's own numbers with its formula, and both
/// in words.
void judge(Comparison& comparison, const Explanation& all);

}  // namespace obliq
