#pragma once
#include <string>

namespace obliq {

/// Release of the GDAL in use, "3.6.2".
std::string gdal_version();

/// Of everything that a grid's heights go through.
std::string terrain_library_versions();

}  // namespace obliq
