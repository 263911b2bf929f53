#pragma once
#include <string>
#include <vector>

#include "server/control/complaints.h"
#include "server/control/config_tree.h"

namespace obliq {

/// Lays the environment (OBLIQ_RADAR_R_MAX_M and its like) and then the flags over a scene file's tree, each
/// as a layer of its own. A flag is KEY=VALUE, for all radars, or NAME:KEY=VALUE, for the radar of that name.
/// Values are TOML; texts need no quotes. Whatever its place, frustum.quality is laid before the other
/// variables and before the other flags, so that they beat it.
void apply_overrides(ConfigNode& root, const std::vector<std::string>& flags, Complaints& complaints);

}  // namespace obliq
