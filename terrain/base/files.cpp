#include "terrain/base/files.h"

#include <filesystem>

#include "terrain/base/errors.h"

namespace obliq {

std::string endless_file(const std::string& path) {
  std::error_code absent;
  switch (std::filesystem::status(path, absent).type()) {
    case std::filesystem::file_type::fifo:
      return "a pipe";
    case std::filesystem::file_type::socket:
      return "a socket";
    case std::filesystem::file_type::character:
    case std::filesystem::file_type::block:
      return "a device";
    default:
      return {};
  }
}

void refuse_endless_file(const std::string& where, const std::string& path) {
  const std::string found = endless_file(path);
  if (!found.empty()) throw InputError(where + ": found " + found + "; allowed: a regular file");
}

}  // namespace obliq
