#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace obliq::fuzz {

/// Leaves only these of GDAL's drivers: others would read files and networks that an input names (VRT), or
/// are not what anyone feeds to obliq. Call once, first.
void keep_drivers(const std::vector<std::string>& names);

/// A file in GDAL's memory, gone with this.
class MemoryFile {
 public:
  MemoryFile(const std::string& name, std::span<const std::byte> bytes);
  ~MemoryFile();
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
  std::vector<std::byte> bytes_;
};

}  // namespace obliq::fuzz
