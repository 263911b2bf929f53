#pragma once
// Reads a recording: the messages of a stream, one after the other, in a file. Knows no sockets and no
// frames. PROTOCOL.md, "Recordings".
#include <cstdint>
#include <iosfwd>
#include <memory>
#include <string>

#include "client/status.h"
#include "proto/message_codec.h"

namespace obliq::client {

/// Bytes of a recording that are no whole message.
struct RecordingFault {
  std::uint64_t offset = 0;
  std::uint64_t bytes = 0;
  std::string reason;
};

/// Holds two of the largest messages at most, however long the recording. For one thread at a time.
class RecordingReader {
 public:
  explicit RecordingReader(std::unique_ptr<std::istream> in);
  ~RecordingReader();

  /// bad_argument when the file cannot be opened, or is a folder, a device, a pipe.
  static Status open(const std::string& path, std::unique_ptr<RecordingReader>& out);

  enum class Found {
    message,  ///< message() is whole and its CRC is right
    damage,   ///< fault() says what was skipped; the next whole message follows, if there is one
    end,      ///< fault() holds what is left over behind the last whole message: a cut; bytes 0: none
  };
  /// After `end`, `end` again.
  Found next();

  /// Goes on from there, which need not be where a message begins: bytes before the first whole one are then
  /// a damage.
  void seek(std::uint64_t offset);

  /// Valid until next() is called again.
  const wire::MessageView& message() const { return view_; }
  /// Of message(), from the start of the file.
  std::uint64_t offset() const { return offset_; }
  const RecordingFault& fault() const { return fault_; }
  /// Whole messages so far.
  std::uint64_t messages() const { return messages_; }

 private:
  std::span<const std::byte> window() const;
  void drop(std::size_t bytes);
  bool hold(std::size_t bytes);
  bool seek_whole_message();
  Found skip_damage(wire::MessageStatus status);

  std::unique_ptr<std::istream> in_;
  wire::Bytes buffer_;
  std::size_t begin_ = 0;  ///< of what is not yet used, in the buffer
  std::size_t end_ = 0;
  bool at_end_ = false;       ///< the file has no more than the buffer
  std::uint64_t offset_ = 0;  ///< of buffer_[begin_] in the file
  wire::MessageView view_;
  RecordingFault fault_;
  std::uint64_t messages_ = 0;
  std::uint64_t searched_bytes_ = 0;
  bool read_failed_ = false;
};

}  // namespace obliq::client
