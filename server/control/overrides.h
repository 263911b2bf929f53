#pragma once
#include <string>
#include <vector>

#include "server/control/complaints.h"
#include "server/control/config_tree.h"

namespace obliq {

/// Lays the environment (OBLIQ_RADAR_R_MAX_M and its like) and then the flags over a scene file's tree. A
/// flag is KEY=VALUE, for all radars, or NAME:KEY=VALUE, for the radar of that name. Values are TOML; texts
/// need no quotes. Also writes out the short forms: frustum.pixels becomes
/// columns and rows, frustum.quality the keys that it stands for, unless the same layer names them itself. Of
/// a radar whose frustum nobody names, it is that of kDefaultQuality; `notes` says so.
void apply_overrides(ConfigNode& root, const std::vector<std::string>& flags, Complaints& complaints,
                     std::vector<std::string>& notes);

}  // namespace obliq
