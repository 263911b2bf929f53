#pragma once
#include <string>

namespace obliq {

/// Release of the GDAL in use, "3.6.2".
std::string gdal_version();

}  // namespace obliq
