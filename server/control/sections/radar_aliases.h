#pragma once
#include <map>
#include <string>

#include "server/control/sections/section.h"

namespace obliq {

/// Reads second names of parameters (kKeyAliases), which stand in the radar's own table, `own`, after all
/// else of it. Both names from one source with two values are a complaint; of two sources the one that beats
/// the other counts. set_at: where each parameter was set, by its first name.
void read_aliases(SceneReading& scene, SectionReader& own, RadarConfig& radar,
                  std::map<std::string, std::string>& set_at);

}  // namespace obliq
