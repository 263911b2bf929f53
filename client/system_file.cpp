#include "client/system_file.h"

#include <fcntl.h>

#ifdef _WIN32
#include <io.h>
#include <share.h>
#include <sys/stat.h>
#else
#include <sys/uio.h>
#include <unistd.h>
#endif

#include <algorithm>
#include <array>
#include <cerrno>

namespace obliq::client {
namespace {

#ifdef _WIN32
constexpr int kFlags = _O_WRONLY | _O_CREAT | _O_BINARY | _O_NOINHERIT;

int open_native(const char* path, int flags) {
  int file = -1;
  return ::_sopen_s(&file, path, flags, _SH_DENYNO, _S_IREAD | _S_IWRITE) == 0 ? file : -1;
}

/// Of one of both; below 0: errno has the error.
std::int64_t write_some(int file, std::span<const std::byte> first, std::span<const std::byte> second) {
  constexpr std::size_t kMost = 1 << 30;
  const std::span<const std::byte> part = first.empty() ? second : first;
  return ::_write(file, part.data(), static_cast<unsigned>(std::min(part.size(), kMost)));
}

bool cut_native(int file, std::uint64_t bytes) {
  return ::_chsize_s(file, static_cast<std::int64_t>(bytes)) == 0 && ::_lseeki64(file, 0, SEEK_END) >= 0;
}
int flush_native(int file) { return ::_commit(file); }
int close_native(int file) { return ::_close(file); }
#else
constexpr int kFlags = O_WRONLY | O_CREAT | O_CLOEXEC;

int open_native(const char* path, int flags) {
  constexpr mode_t kMode = 0644;
  return ::open(path, flags, kMode);
}

std::int64_t write_some(int file, std::span<const std::byte> first, std::span<const std::byte> second) {
  std::array<iovec, 2> parts{iovec{const_cast<std::byte*>(first.data()), first.size()},
                             iovec{const_cast<std::byte*>(second.data()), second.size()}};
  return ::writev(file, parts.data(), static_cast<int>(parts.size()));
}

bool cut_native(int file, std::uint64_t bytes) { return ::ftruncate(file, static_cast<off_t>(bytes)) == 0; }
int flush_native(int file) { return ::fsync(file); }
int close_native(int file) { return ::close(file); }
#endif

}  // namespace

int create_file(const std::string& path, bool overwrite, int& error) {
  const int file = open_native(path.c_str(), kFlags | (overwrite ? O_TRUNC : O_EXCL));
  if (file < 0) error = errno;
  return file;
}

int append_to_file(int file, std::span<const std::byte> first, std::span<const std::byte> second) {
  while (!first.empty() || !second.empty()) {
    const std::int64_t n = write_some(file, first, second);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return n < 0 ? errno : ENOSPC;
    const auto written = static_cast<std::size_t>(n);
    const std::size_t of_first = std::min(written, first.size());
    first = first.subspan(of_first);
    second = second.subspan(written - of_first);
  }
  return 0;
}

bool cut_file(int file, std::uint64_t bytes) { return cut_native(file, bytes); }
int flush_file(int file) { return flush_native(file) != 0 && errno != EINVAL && errno != EROFS ? errno : 0; }
int close_file(int file) { return close_native(file) != 0 ? errno : 0; }

}  // namespace obliq::client
