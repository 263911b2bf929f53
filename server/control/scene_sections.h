#pragma once
// The parts of a scene file, one reader each; scene_file.cpp calls them in order.
#include <filesystem>

#include "server/control/complaints.h"
#include "server/control/config_tree.h"
#include "server/control/scene_config.h"
#include "server/control/section_reader.h"

namespace obliq {

/// What the readers share.
struct SceneReading {
  SceneConfig& config;
  SectionReader& top;
  Complaints& complaints;
  std::filesystem::path folder;  ///< of the scene file, absolute
};

void read_scene_entries(SceneReading& reading);  ///< [terrain] [earth] [run] [server], their plain keys too
void read_materials(SceneReading& reading);      ///< before those that name materials
void read_buildings(SceneReading& reading);
void read_prisms(SceneReading& reading);
void read_surfaces(SceneReading& reading);

/// Which radars name no position of their own (by index): they get the terrain's centre.
struct MissingPosition {
  std::size_t radar;
  bool latitude;
  bool longitude;
};
std::vector<MissingPosition> read_radars(SceneReading& reading);

}  // namespace obliq
