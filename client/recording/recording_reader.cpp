#include "client/recording/recording_reader.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <utility>

#include "proto/limits.h"

namespace obliq::client {

using wire::MessageStatus;

namespace {

// Grows to twice the largest message when such a message comes.
constexpr std::size_t kFirstBufferBytes = std::size_t{64} << 10;

// The magic, as it lies in the file.
constexpr std::array<std::byte, 4> kMagicBytes{std::byte{'O'}, std::byte{'B'}, std::byte{'L'},
                                               std::byte{'Q'}};

// What the search for whole messages behind damage may check, over the whole recording. A file made to look
// like nothing but headers would otherwise cost the square of its length; at the speed of the CRC this is a
// second or so.
constexpr std::uint64_t kMaxSearchedBytes = std::uint64_t{8} << 30;

std::string reason_of(MessageStatus status, const wire::MessageHeader& header) {
  switch (status) {
    case MessageStatus::bad_crc:
      return "CRC mismatch";
    case MessageStatus::bad_magic:
      return wire::describe(wire::HeaderStatus::bad_magic, header, wire::kMaxPayloadBytes);
    case MessageStatus::version_mismatch:
      return wire::describe(wire::HeaderStatus::version_mismatch, header, wire::kMaxPayloadBytes);
    case MessageStatus::bad_length:
      return wire::describe(wire::HeaderStatus::bad_length, header, wire::kMaxPayloadBytes);
    case MessageStatus::need_more:
      return "the length in its header reaches beyond the end";
    case MessageStatus::ok:
      break;
  }
  return "?";
}

const char* name_of(std::filesystem::file_type kind) {
  switch (kind) {
    case std::filesystem::file_type::directory:
      return "a folder";
    case std::filesystem::file_type::fifo:
      return "a pipe";
    case std::filesystem::file_type::socket:
      return "a socket";
    case std::filesystem::file_type::character:
    case std::filesystem::file_type::block:
      return "a device";
    default:
      return "what is no file";
  }
}

}  // namespace

RecordingReader::RecordingReader(std::unique_ptr<std::istream> in)
    : in_(std::move(in)), buffer_(kFirstBufferBytes) {}
RecordingReader::~RecordingReader() = default;

Status RecordingReader::open(const std::string& path, std::unique_ptr<RecordingReader>& out) {
  // A replay reads it more than once, and would wait for ever for the writer of a pipe.
  std::error_code error;
  const auto kind = std::filesystem::status(path, error).type();
  if (std::filesystem::exists(std::filesystem::file_status(kind)) &&
      kind != std::filesystem::file_type::regular)
    return Status::failure(Outcome::bad_argument,
                           path + ": found " + name_of(kind) + "; allowed: a file that `obliq record` wrote");
  errno = 0;
  auto file = std::make_unique<std::ifstream>(path, std::ios::binary);
  if (!*file)
    return Status::failure(Outcome::bad_argument,
                           path + ": cannot be read: " + std::generic_category().message(errno));
  out = std::make_unique<RecordingReader>(std::move(file));
  return {};
}

void RecordingReader::seek(std::uint64_t offset) {
  in_->clear();
  in_->seekg(static_cast<std::streamoff>(offset));
  begin_ = end_ = 0;
  at_end_ = read_failed_ = false;
  offset_ = offset;
  view_ = {};
  fault_ = {};
}

std::span<const std::byte> RecordingReader::window() const {
  return std::span(buffer_).subspan(begin_, end_ - begin_);
}

void RecordingReader::drop(std::size_t bytes) {
  begin_ += bytes;
  offset_ += bytes;
}

// Reads on until the window has so many bytes. False: the file ends before.
bool RecordingReader::hold(std::size_t bytes) {
  if (end_ - begin_ >= bytes) return true;
  if (!at_end_) {
    std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
    end_ -= begin_;
    begin_ = 0;
    if (buffer_.size() < 2 * bytes) buffer_.resize(2 * bytes);
    in_->read(reinterpret_cast<char*>(buffer_.data() + end_),
              static_cast<std::streamsize>(buffer_.size() - end_));
    end_ += static_cast<std::size_t>(in_->gcount());
    at_end_ = !*in_;
    read_failed_ = in_->bad();
  }
  return end_ - begin_ >= bytes;
}

RecordingReader::Found RecordingReader::next() {
  drop(view_.size);
  view_ = {};
  fault_ = {};
  std::size_t wanted = wire::kHeaderBytes;
  for (;;) {
    const bool held = hold(wanted);
    const MessageStatus status = wire::decode_message(window(), wire::kMaxPayloadBytes, view_);
    if (status == MessageStatus::ok) {
      ++messages_;
      return Found::message;
    }
    if (status != MessageStatus::need_more || !held) return skip_damage(status);
    wanted = view_.size;
  }
}

// What stands here is no whole message. If one follows, or if these bytes cannot be the start of one, this is
// damage; else the recording was cut.
RecordingReader::Found RecordingReader::skip_damage(MessageStatus status) {
  fault_.offset = offset_;
  fault_.reason = reason_of(status, view_.header);
  view_ = {};
  const bool found = seek_whole_message();
  if (!found) drop(end_ - begin_);
  fault_.bytes = offset_ - fault_.offset;
  if (found) return Found::damage;
  if (std::exchange(read_failed_, false)) {
    fault_.reason = "the file cannot be read any further";
    return Found::damage;
  }
  return status == MessageStatus::need_more ? Found::end : Found::damage;
}

// Drops at least one byte, and all before the next whole message. False when there is none.
bool RecordingReader::seek_whole_message() {
  if (begin_ == end_) return false;
  drop(1);
  while (hold(wire::kHeaderBytes)) {
    const auto bytes = window();
    const auto at = std::search(bytes.begin(), bytes.end(), kMagicBytes.begin(), kMagicBytes.end());
    if (at == bytes.end()) {
      drop(bytes.size() - (kMagicBytes.size() - 1));  // the last ones may begin another
      continue;
    }
    drop(static_cast<std::size_t>(at - bytes.begin()));
    wire::MessageView candidate;
    if (!hold(wire::kHeaderBytes)) return false;
    MessageStatus status = wire::decode_message(window(), wire::kMaxPayloadBytes, candidate);
    if (status == MessageStatus::need_more && hold(candidate.size))
      status = wire::decode_message(window(), wire::kMaxPayloadBytes, candidate);
    if (status == MessageStatus::ok) return true;
    if (status == MessageStatus::bad_crc) searched_bytes_ += candidate.size;
    if (searched_bytes_ > kMaxSearchedBytes) {
      fault_.reason += "; too much damage to search on";
      at_end_ = true;
      return false;
    }
    drop(1);
  }
  return false;
}

}  // namespace obliq::client
