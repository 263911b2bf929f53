#include "terrain/base/files.h"

#include <cerrno>
#include <filesystem>

#include "terrain/base/errors.h"

namespace obliq {

std::size_t read_at(int fd, void* to, std::size_t size, std::uint64_t at) {
  std::size_t done = 0;
  while (done < size) {
    const ssize_t n = ::pread(fd, static_cast<char*>(to) + done, size - done, static_cast<off_t>(at + done));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    done += static_cast<std::size_t>(n);
  }
  return done;
}

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
