#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "client/status.h"

namespace obliq::client {

/// Writes a recording: whole messages, each handed to the kernel before the next, so that a process that is
/// killed loses at most the current one. For one thread at a time.
class RecordingWriter {
 public:
  RecordingWriter() = default;
  ~RecordingWriter();
  RecordingWriter(const RecordingWriter&) = delete;
  RecordingWriter& operator=(const RecordingWriter&) = delete;

  /// bad_argument when the file exists and `overwrite` is not set, or cannot be made.
  Status open(const std::string& path, bool overwrite);

  /// Appends one message, header and payload as they came. When that fails (disk full) the file is cut back
  /// to the last whole message, and nothing more is written.
  Status write(std::span<const std::byte> header, std::span<const std::byte> payload);

  /// Waits until the disk has everything. Fails when it could not take all.
  Status close();

  std::uint64_t bytes() const { return bytes_; }

 private:
  std::string path_;
  int fd_ = -1;
  std::uint64_t bytes_ = 0;  ///< of whole messages
};

}  // namespace obliq::client
