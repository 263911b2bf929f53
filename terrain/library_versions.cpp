#include "terrain/library_versions.h"

#include <gdal.h>

namespace obliq {

std::string gdal_version() { return GDALVersionInfo("RELEASE_NAME"); }

}  // namespace obliq
