#include "client/recording/recorded_events.h"

#include <array>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>

#include "client/recording/recording_reader.h"
#include "proto/limits.h"
#include "proto/message_codec.h"
#include "proto/obliq.pb.h"

namespace obliq::client {
namespace {

/// Goes from header to header.
class Walk {
 public:
  Walk(const std::string& path, std::uint64_t size) : size_(size) {
    file_.rdbuf()->pubsetbuf(nullptr, 0);  // a header is read at a time, each from somewhere else
    file_.open(path, std::ios::binary);
  }

  /// The header there, of a message that ends within the file.
  std::optional<wire::MessageHeader> header_at(std::uint64_t offset) {
    std::array<std::byte, wire::kHeaderBytes> bytes;
    wire::MessageHeader header;
    if (!read(offset, bytes) ||
        wire::decode_header(bytes, wire::kMaxPayloadBytes, header) != wire::HeaderStatus::ok ||
        offset + length_of(header) > size_)
      return std::nullopt;
    return header;
  }

  /// False: it is damaged.
  bool events_at(std::uint64_t offset, const wire::MessageHeader& header, wire::ExerciseEvents& events) {
    wire::Bytes message(static_cast<std::size_t>(length_of(header)));
    if (!read(offset, message)) return false;
    const auto all = std::span<const std::byte>(message);
    const auto payload = all.subspan(header.header_length);
    return wire::message_crc(all.first(header.header_length), payload) == header.crc &&
           wire::parse_descriptor(payload.first(header.descriptor_length), events);
  }

  static std::uint64_t length_of(const wire::MessageHeader& header) {
    return std::uint64_t{header.header_length} + header.payload_length;
  }

 private:
  bool read(std::uint64_t offset, std::span<std::byte> bytes) {
    file_.clear();
    file_.seekg(static_cast<std::streamoff>(offset));
    return static_cast<bool>(
        file_.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size())));
  }

  std::ifstream file_;
  std::uint64_t size_;
};

}  // namespace

Status read_events(const std::string& path, const std::function<void(const wire::ExerciseEvents&)>& each,
                   RecordedLog& log) {
  std::unique_ptr<RecordingReader> reader;  // finds the next whole message behind damage
  if (Status status = RecordingReader::open(path, reader); !status.ok()) return status;
  std::error_code none;
  const std::uint64_t size = std::filesystem::file_size(path, none);
  if (none) return Status::failure(Outcome::bad_argument, path + ": " + none.message());
  Walk walk(path, size);
  std::uint64_t offset = 0;
  while (offset < size) {
    const auto header = walk.header_at(offset);
    wire::ExerciseEvents events;
    const bool has_events = header && header->type == wire::MessageType::exercise_events;
    if (header && (!has_events || walk.events_at(offset, *header, events))) {
      if (has_events) {
        ++log.messages;
        each(events);
      }
      offset += Walk::length_of(*header);
      continue;
    }
    ++log.damages;
    reader->seek(offset + 1);
    RecordingReader::Found found{};
    do found = reader->next();
    while (found == RecordingReader::Found::damage);
    if (found == RecordingReader::Found::end) return {};
    offset = reader->offset();
  }
  log.is_whole = size > 0;
  return {};
}

Status append_events(const std::string& path, const wire::ExerciseEvents& events) {
  RecordedLog log;
  if (Status status = read_events(
          path, [](const wire::ExerciseEvents&) {}, log);
      !status.ok())
    return status;
  if (!log.is_whole)
    return Status::failure(Outcome::bad_argument,
                           path + ": its end is cut: nothing can be written behind it");
  const wire::Bytes message =
      wire::encode_message(wire::MessageType::exercise_events, {0, 0, wire::utc_now_ns()}, events, {});
  std::ofstream file(path, std::ios::binary | std::ios::app);
  file.write(reinterpret_cast<const char*>(message.data()), static_cast<std::streamsize>(message.size()));
  file.flush();
  return file ? Status{} : Status::failure(Outcome::bad_argument, path + ": cannot be written");
}

}  // namespace obliq::client
