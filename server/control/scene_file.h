#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "server/control/config_tree.h"
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

/// What a program that serves without a scene needs: [server], [stream] and [http] as in a scene file, and
/// nothing else of the one of that path (empty: none, and no HTTP unless a flag says so). Flags and
/// environment count as in load_scene_file; a flag of another section is refused. Throws InputError.
SceneConfig load_serving(const std::filesystem::path& path, const LoadOptions& options);

/// Lays the environment (OBLIQ_RADAR_R_MAX_M and its like) and then the flags over a scene file's tree, each
/// as a layer of its own. A flag is KEY=VALUE, for all radars, or NAME:KEY=VALUE, for the radar of that name.
/// Values are TOML; texts need no quotes. Whatever its place, frustum.quality is laid before the other
/// variables and before the other flags, so that they beat it.
void apply_overrides(ConfigNode& root, const std::vector<std::string>& flags, Complaints& complaints);

/// The whole configuration as a scene file, every key with its unit, its limits and what a change takes.
/// Loads again to the same configuration, from any folder.
std::string print_config(const SceneConfig& config);

/// Ground is loaded to this distance around a radar that looks this far: a quarter more, so
/// that it can move without running out of terrain.
double loaded_radius_m(double r_max_m);

/// Tells the terrain where the configured radars stand, how far they look and how finely they sample: the
/// first one's position is the scene's origin.
void set_terrain_reach(SceneConfig& config);

}  // namespace obliq
