#pragma once
#include "server/explain/explanation.h"

namespace obliq {

/// Frame times that differ by less are not told apart: a twentieth, or what repetitions of any of them and
/// the scene itself from the first to the last measurement differed by. In whole milliseconds, rounded up.
double frame_repeats_within_s(const Explanation& all);

/// Completes a comparison: the verdict, the threshold for this scene's own numbers with its formula, and both
/// in words.
void judge(Comparison& comparison, const Explanation& all);

}  // namespace obliq
