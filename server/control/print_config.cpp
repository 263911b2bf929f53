#include "server/control/print_config.h"

#include "server/control/sections/materials.h"
#include "server/control/sections/section.h"

namespace obliq {

std::string print_config(const SceneConfig& config) {
  return "# Scene " + toml_string(config.name) +
         ", complete. Live: changes with the next frame. Reload: read again at SIGHUP. Restart: read once, "
         "at "
         "start.\n" +
         printed_sections(config) + printed_list(kBuildings, config) + printed_list(kPrisms, config) +
         printed_list(kSurfaces, config) + printed_radars(config) + printed_materials(config);
}

}  // namespace obliq
