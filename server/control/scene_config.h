#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "server/control/accuracy_wish.h"
#include "server/control/flight_config.h"
#include "server/control/http_config.h"
#include "server/control/log_config.h"
#include "server/control/modbus_config.h"
#include "server/control/radar_config.h"
#include "server/control/server_config.h"
#include "server/control/stream_config.h"
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
  std::vector<RadarConfig> radars;  ///< at least one; valid; names differ
  int threads = 0;                  ///< 0: all cores
  RayMethod rays = RayMethod::march;
  ServerConfig server;
  StreamConfig stream;
  HttpConfig http;
  LogConfig log;
  FlightConfig flight;
  ModbusConfig modbus;
  std::vector<std::string> notes;  ///< what the user did not say and was chosen for him, a sentence each
  AccuracyWish
      accuracy;  ///< what the pixels and the cell size are to be chosen by (server/loading/meet_accuracy.h)
};

}  // namespace obliq
