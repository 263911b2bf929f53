#pragma once
#include "server/explain/explanation.h"

namespace obliq {

class FramePlan;

constexpr double kStandardEarth = 4.0 / 3;

/// What a scene is made of, as a plan of its own frame finds it; without what the measuring adds.
SceneFacts facts_of(const ExplainInput& input, const FramePlan& own);

}  // namespace obliq
