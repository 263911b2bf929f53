#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "server/control/sections/modbus.h"
#include "server/control/sections/radar.h"
#include "server/control/sections/run.h"
#include "server/control/sections/server.h"
#include "server/control/sections/target_config.h"
#include "server/log/log_config.h"
#include "server/scene/materials.h"
#include "server/scene/ray_method.h"
#include "terrain/world_spec.h"

namespace obliq {

/// A scene file, read and checked: everything that a program needs to start.
struct SceneConfig {
  std::string name;                 ///< the file's name without folder and extension
  std::filesystem::path path;       ///< the file
  WorldSpec world;                  ///< origin, reaches and footprint filled in from the radars
  std::vector<Material> materials;  ///< by material id
  std::vector<std::shared_ptr<const PlatformConfig>> platforms;  ///< names differ, from the radars' too
  std::vector<TargetType> target_types;                          ///< rising by name
  std::vector<TargetConfig> targets;                             ///< names differ
  std::int64_t target_seed = 1;                                  ///< of their fluctuation
  std::vector<RadarConfig> radars;                               ///< at least one; valid; names differ
  int threads = 0;                                               ///< 0: all cores
  RayMethod rays = RayMethod::march;
  ServerConfig server;
  StreamConfig stream;
  HttpConfig http;
  LogConfig log;
  FlightConfig flight;
  ModbusConfig modbus;
  std::vector<std::string> notes;  ///< what was chosen where the file says nothing, a sentence each
  AccuracyWish
      accuracy;  ///< what the pixels and the cell size are to be chosen by (server/loading/scene_loading.h)
};

}  // namespace obliq
