#include "server/apps/daemon/reload.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>

#include "server/control/print_config.h"
#include "server/control/scene_keys.h"

namespace obliq {
namespace {

/// Sections that a scene is built from, or that its keeper reads.
constexpr std::array<std::string_view, 4> kSceneSections{"terrain.", "earth.", "accuracy.", "flight."};

bool is_of_scene(std::string_view key) {
  return std::ranges::any_of(kSceneSections, [&](std::string_view part) { return key.starts_with(part); });
}

/// The configuration with nothing in it but what a scene is built from, as text. Of the radars that is how
/// far they look, for so much ground is loaded.
std::string scene_text(SceneConfig config) {
  const SceneConfig defaults;
  config.server = defaults.server;
  config.stream = defaults.stream;
  config.http = defaults.http;
  config.log = defaults.log;
  config.modbus = defaults.modbus;
  config.threads = defaults.threads;
  for (RadarConfig& radar : config.radars)
    radar = RadarConfig{.name = radar.name, .settings = {.r_max_m = radar.settings.r_max_m}, .pose = {}};
  return print_config(config);
}

}  // namespace

std::string radar_names(const SceneConfig& config) {
  std::string all;
  for (const RadarConfig& radar : config.radars) all += (all.empty() ? "" : ", ") + radar.name;
  return all;
}

std::vector<std::string> keys_for_restart(const SceneConfig& running, const SceneConfig& wanted) {
  std::vector<std::string> keys;
  SceneConfig one = running;
  SceneConfig other = wanted;
  // What is taken over makes no difference.
  one.log = wanted.log;
  static_cast<ServerLimits&>(one.server) = wanted.server;
  for (const auto& [key, slot] : scene_entries()) {
    if (is_of_scene(key.name)) continue;
    if (load(key, slot(one)) != load(key, slot(other))) keys.emplace_back(key.name);
  }
  if (running.modbus.allow != wanted.modbus.allow) keys.emplace_back("modbus.allow");
  if (radar_names(one) != radar_names(other))
    keys.push_back(fmt::format("the radars (running: {}; wanted: {})", radar_names(one), radar_names(other)));
  return keys;
}

std::string scene_signature(const SceneConfig& config) {
  std::string text = scene_text(config);
  const auto add = [&](const std::string& path) {
    std::error_code absent;  // a URL, or a file that is on its way: then the name alone counts
    const auto size = std::filesystem::file_size(path, absent);
    const auto time = std::filesystem::last_write_time(path, absent);
    if (!absent) text += fmt::format("{} {} {}\n", path, size, time.time_since_epoch().count());
  };
  for (const std::string& path : config.world.terrain.dem) add(path);
  for (const BuildingSourceSpec& spec : config.world.buildings) add(spec.source);
  for (const PrismSpec& spec : config.world.prisms) add(spec.within);
  for (const SurfaceSpec& spec : config.world.surfaces) add(spec.source);
  return text;
}

}  // namespace obliq
