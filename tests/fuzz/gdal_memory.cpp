#include "tests/fuzz/gdal_memory.h"

#include <cpl_conv.h>
#include <cpl_vsi.h>
#include <gdal_priv.h>

#include <algorithm>

#include "terrain/dem/gdal_messages.h"

namespace obliq::fuzz {

void keep_drivers(const std::vector<std::string>& names) {
  const GdalMessages registered;  // later calls find them registered and leave them so
  // An input may ask for any size; what we would not load anyway need not be allocated.
  CPLSetConfigOption("GDAL_CACHEMAX", "16");
  CPLSetConfigOption("CPL_VSIL_CURL_ALLOWED_EXTENSIONS", "{none}");
  CPLSetConfigOption("GDAL_DISABLE_READDIR_ON_OPEN", "EMPTY_DIR");
  GDALDriverManager& manager = *GetGDALDriverManager();
  for (int i = manager.GetDriverCount() - 1; i >= 0; --i) {
    GDALDriver* driver = manager.GetDriver(i);
    if (std::find(names.begin(), names.end(), driver->GetDescription()) == names.end()) {
      manager.DeregisterDriver(driver);
      delete driver;
    }
  }
}

MemoryFile::MemoryFile(const std::string& name, std::span<const std::byte> bytes)
    : path_("/vsimem/" + name), bytes_(bytes.begin(), bytes.end()) {
  // GDAL reads the buffer where it is, and never writes: everything is opened read-only.
  VSILFILE* file = VSIFileFromMemBuffer(path_.c_str(), reinterpret_cast<GByte*>(bytes_.data()),
                                        static_cast<vsi_l_offset>(bytes_.size()), FALSE);
  if (file != nullptr) VSIFCloseL(file);
}

MemoryFile::~MemoryFile() { VSIUnlink(path_.c_str()); }

}  // namespace obliq::fuzz
