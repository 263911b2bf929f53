#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "server/control/scene_config.h"

namespace obliq {

struct LoadOptions {
  /// KEY=VALUE, or NAME:KEY=VALUE for one radar: what `--set` was given, in order. They beat the environment
  /// (OBLIQ_RADAR_R_MAX_M), which beats the file, which beats the defaults.
  std::vector<std::string> set;
};

/// Reads a scene file. Throws InputError with everything that is wrong, one complaint a line:
/// "FILE:LINE: KEY: found ...; allowed: ...". Opens the elevation models only to find their centre, and only
/// when an antenna names no position. Relative paths in the file are relative to its folder.
SceneConfig load_scene_file(const std::filesystem::path& path, const LoadOptions& options = {});
/// As load_scene_file, of a text that would stand in the file of that path.
SceneConfig load_scene_text(const std::string& text, const std::filesystem::path& path,
                            const LoadOptions& options = {});

}  // namespace obliq
