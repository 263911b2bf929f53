#include "terrain/library_versions.h"

#include <GeographicLib/Config.h>
#include <fmt/core.h>
#include <gdal.h>
#include <ogr_srs_api.h>

namespace obliq {

std::string gdal_version() { return GDALVersionInfo("RELEASE_NAME"); }

std::string terrain_library_versions() {
  int proj[3] = {0, 0, 0};
  OSRGetPROJVersion(&proj[0], &proj[1], &proj[2]);
  return fmt::format("GDAL {}, PROJ {}.{}.{}{}", gdal_version(), proj[0], proj[1], proj[2],
                     ", GeographicLib " GEOGRAPHICLIB_VERSION_STRING);
}

}  // namespace obliq
