#pragma once
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

namespace obliq {

/// Owns a file descriptor and closes it at the end; negative: none.
class UniqueFd {
 public:
  UniqueFd() = default;
  explicit UniqueFd(int fd) : fd_(fd) {}
  ~UniqueFd() { reset(); }
  UniqueFd(UniqueFd&& other) noexcept : fd_(other.release()) {}
  UniqueFd& operator=(UniqueFd&& other) noexcept {
    reset(other.release());
    return *this;
  }

  int get() const { return fd_; }
  explicit operator bool() const { return fd_ >= 0; }
  /// The descriptor, which is the caller's from now on.
  int release() { return std::exchange(fd_, -1); }
  void reset(int fd = -1) {
    if (const int old = std::exchange(fd_, fd); old >= 0) ::close(old);
  }

 private:
  int fd_ = -1;
};

/// Reads from byte `at` on; how many bytes: fewer where the file ends or cannot be read.
std::size_t read_at(int fd, void* to, std::size_t size, std::uint64_t at);

/// Where this name stands for what may not be opened, as opening or reading it may never end: "a pipe", "a
/// socket", "a device"; empty for all else. A folder is for its reader to judge (GDAL has formats that are
/// one), and so is what is not there: a URL, or one of GDAL's own names (/vsizip/...).
std::string endless_file(const std::string& path);

/// Throws InputError "WHERE: found a pipe; allowed: a regular file" for such a name.
void refuse_endless_file(const std::string& where, const std::string& path);

}  // namespace obliq
