#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "server/frontier/frontier_run.h"
#include "terrain/world.h"

namespace obliq {

/// Names everything that the lines of a frontier's table depend on: scene, samplings, options, machine and
/// version. A run with another key is another run. world: the truth's.
std::uint64_t frontier_key(const SceneConfig& config, const std::string& radar,
                           const FrontierOptions& options, const FrontierHeader& header,
                           const std::vector<SamplingCase>& cases, const World& world);

}  // namespace obliq
