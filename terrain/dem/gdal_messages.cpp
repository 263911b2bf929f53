#include "terrain/dem/gdal_messages.h"

#include <GeographicLib/Config.h>
#include <cpl_conv.h>
#include <cpl_error.h>
#include <fmt/core.h>
#include <gdal.h>
#include <ogr_srs_api.h>

#include <algorithm>
#include <mutex>

namespace obliq {

namespace {

// Called from inside GDAL: nothing may be thrown through it.
void CPL_STDCALL on_message(CPLErr severity, CPLErrorNum, const char* message) {
  if (severity < CE_Failure) return;
  static_cast<GdalMessages*>(CPLGetErrorHandlerUserData())->keep(message);
}

}  // namespace

GdalMessages::GdalMessages() {
  static std::once_flag registered;
  std::call_once(registered, [] {
    GDALAllRegister();
    // Never map a GeoTIFF into memory, whatever the environment says: if the file is cut short meanwhile, the
    // next look at it is a SIGBUS. (https://gdal.org/drivers/raster/gtiff.html, GTIFF_VIRTUAL_MEM_IO.)
    CPLSetConfigOption("GTIFF_VIRTUAL_MEM_IO", "NO");
  });
  CPLPushErrorHandlerEx(on_message, this);
}

GdalMessages::~GdalMessages() { CPLPopErrorHandler(); }

void GdalMessages::keep(const char* message) {
  if (!failure_.empty()) return;
  try {
    failure_ = message;
    std::replace(failure_.begin(), failure_.end(), '\n', ' ');
  } catch (...) {
    failure_.clear();  // out of memory while reporting: the caller has its own wording
  }
}

std::string GdalMessages::reason_without(const std::string& path, const char* fallback) const {
  std::string text = reason(fallback);
  for (const std::string& beginning : {path + ": ", path + ", band 1: ", "`" + path + "' "})
    if (text.starts_with(beginning)) text.erase(0, beginning.size());
  if (text.ends_with('.')) text.pop_back();
  return text;
}

std::string gdal_version() { return GDALVersionInfo("RELEASE_NAME"); }

std::string terrain_library_versions() {
  int proj[3] = {0, 0, 0};
  OSRGetPROJVersion(&proj[0], &proj[1], &proj[2]);
  return fmt::format("GDAL {}, PROJ {}.{}.{}{}", gdal_version(), proj[0], proj[1], proj[2],
                     ", GeographicLib " GEOGRAPHICLIB_VERSION_STRING);
}

}  // namespace obliq
