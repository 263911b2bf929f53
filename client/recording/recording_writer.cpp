#include "client/recording/recording_writer.h"

#include <cerrno>
#include <system_error>
#include <utility>

#include "client/system_file.h"

namespace obliq::client {
namespace {

std::string reason(int error) { return std::generic_category().message(error); }

}  // namespace

RecordingWriter::~RecordingWriter() {
  if (fd_ >= 0) (void)close_file(fd_);
}

Status RecordingWriter::open(const std::string& path, bool overwrite) {
  path_ = path;
  bytes_ = 0;
  int error = 0;
  fd_ = create_file(path, overwrite, error);
  if (fd_ >= 0) return {};
  if (error == EEXIST) return Status::failure(Outcome::bad_argument, path + ": exists already");
  return Status::failure(Outcome::bad_argument, path + ": cannot be made: " + reason(error));
}

Status RecordingWriter::write(std::span<const std::byte> header, std::span<const std::byte> payload) {
  if (fd_ < 0) return Status::failure(Outcome::bad_argument, path_ + ": not open");
  const int error = append_to_file(fd_, header, payload);
  if (error == 0) {
    bytes_ += header.size() + payload.size();
    return {};
  }
  const bool valid = cut_file(fd_, bytes_);
  (void)close_file(std::exchange(fd_, -1));
  return Status::failure(Outcome::bad_argument, path_ + ": cannot be written: " + reason(error) +
                                                    "; it holds the " + std::to_string(bytes_) +
                                                    " bytes of whole messages until then" +
                                                    (valid ? "" : ", and a part of another behind them"));
}

Status RecordingWriter::close() {
  if (fd_ < 0) return {};
  int error = flush_file(fd_);
  const int of_close = close_file(std::exchange(fd_, -1));
  if (error == 0) error = of_close;
  if (error == 0) return {};
  return Status::failure(Outcome::bad_argument, path_ + ": cannot be written: " + reason(error));
}

}  // namespace obliq::client
