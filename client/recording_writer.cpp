#include "client/recording_writer.h"

#include <fcntl.h>
#include <sys/uio.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <system_error>
#include <utility>

namespace obliq::client {
namespace {

std::string reason(int error) { return std::system_category().message(error); }

// 0, or the error that stopped it.
int write_all(int fd, std::span<const std::byte> first, std::span<const std::byte> second) {
  while (!first.empty() || !second.empty()) {
    std::array<iovec, 2> parts{iovec{const_cast<std::byte*>(first.data()), first.size()},
                               iovec{const_cast<std::byte*>(second.data()), second.size()}};
    const ssize_t n = ::writev(fd, parts.data(), static_cast<int>(parts.size()));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return n < 0 ? errno : ENOSPC;
    const auto written = static_cast<std::size_t>(n);
    const std::size_t of_first = std::min(written, first.size());
    first = first.subspan(of_first);
    second = second.subspan(written - of_first);
  }
  return 0;
}

}  // namespace

RecordingWriter::~RecordingWriter() {
  if (fd_ >= 0) ::close(fd_);
}

Status RecordingWriter::open(const std::string& path, bool overwrite) {
  path_ = path;
  bytes_ = 0;
  constexpr mode_t kMode = 0644;
  const int flags = O_WRONLY | O_CREAT | O_CLOEXEC | (overwrite ? O_TRUNC : O_EXCL);
  fd_ = ::open(path.c_str(), flags, kMode);
  if (fd_ >= 0) return {};
  if (errno == EEXIST) return Status::failure(Outcome::bad_argument, path + ": exists already");
  return Status::failure(Outcome::bad_argument, path + ": cannot be made: " + reason(errno));
}

Status RecordingWriter::write(std::span<const std::byte> header, std::span<const std::byte> payload) {
  if (fd_ < 0) return Status::failure(Outcome::bad_argument, path_ + ": not open");
  const int error = write_all(fd_, header, payload);
  if (error == 0) {
    bytes_ += header.size() + payload.size();
    return {};
  }
  const bool valid = ::ftruncate(fd_, static_cast<off_t>(bytes_)) == 0;
  ::close(std::exchange(fd_, -1));
  return Status::failure(Outcome::bad_argument, path_ + ": cannot be written: " + reason(error) +
                                                    "; it holds the " + std::to_string(bytes_) +
                                                    " bytes of whole messages until then" +
                                                    (valid ? "" : ", and a part of another behind them"));
}

Status RecordingWriter::close() {
  if (fd_ < 0) return {};
  // What is no file (a pipe, a device) has nothing to wait for.
  int error = ::fsync(fd_) != 0 && errno != EINVAL && errno != EROFS ? errno : 0;
  if (::close(std::exchange(fd_, -1)) != 0 && error == 0) error = errno;
  if (error == 0) return {};
  return Status::failure(Outcome::bad_argument, path_ + ": cannot be written: " + reason(error));
}

}  // namespace obliq::client
