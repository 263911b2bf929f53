#include "server/apps/scene_loading.h"

#include <unistd.h>

#include <cstdio>

#include "terrain/errors.h"

namespace obliq {

const RadarConfig& choose_radar(const SceneConfig& config, const std::string& name) {
  std::string names;
  for (const RadarConfig& radar : config.radars) {
    if (radar.name == name || (name.empty() && config.radars.size() == 1)) return radar;
    names += (names.empty() ? "" : ", ") + radar.name;
  }
  throw InputError("--radar: found " + (name.empty() ? "nothing" : "\"" + name + "\"") +
                   "; allowed: " + names);
}

Pose place_radar(const World& world, const RadarConfig& radar) {
  std::vector<FieldError> errors;
  const auto pose = place_antenna(world, radar.pose, errors);
  if (pose) return *pose;
  std::string text;
  for (const FieldError& error : errors) text += (text.empty() ? "" : "; ") + error.text();
  throw InputError("radar \"" + radar.name + "\": " + text);
}

Progress terminal_progress() {
  if (!isatty(STDERR_FILENO)) return {};
  return [](std::string_view stage, double fraction) {
    std::fprintf(stderr, "\r\033[K%.*s %3.0f %%", static_cast<int>(stage.size()), stage.data(),
                 100 * fraction);
    if (fraction >= 1) std::fputs("\r\033[K", stderr);
  };
}

std::shared_ptr<const World> load_world_with_report(const SceneConfig& config) {
  auto world = std::make_shared<const World>(load_world(config.world, terminal_progress()));
  const HeightGrid& grid = world->grid;
  std::fprintf(stderr, "terrain: %d x %d posts of %.5g m (%.1f x %.1f km)", grid.nx, grid.nz, grid.cell_m,
               (grid.nx - 1) * grid.cell_m / 1000, (grid.nz - 1) * grid.cell_m / 1000);
  if (!world->buildings.list.empty()) std::fprintf(stderr, ", %zu buildings", world->buildings.list.size());
  std::fputc('\n', stderr);
  for (const std::string& note : world->report.notes) std::fprintf(stderr, "  %s\n", note.c_str());
  return world;
}

}  // namespace obliq
