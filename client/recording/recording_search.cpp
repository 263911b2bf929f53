#include "client/recording/recording_search.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <system_error>
#include <utility>

#include "client/frame_dispatch.h"
#include "proto/limits.h"
#include "proto/obliq.pb.h"

namespace obliq::client {

namespace {

// A part of the file so short is gone through frame by frame.
constexpr std::uint64_t kShort_bytes = std::uint64_t{64} << 10;

// The end is looked for in the last part of this size, then in ones four times as long.
constexpr std::uint64_t kFirstTail_bytes = std::uint64_t{256} << 10;

std::uint64_t size_of(const wire::MessageHeader& header) {
  return std::uint64_t{header.header_length} + header.payload_length;
}

}  // namespace

RecordingSearch::RecordingSearch(const std::string& path, std::string radar) : radar_(std::move(radar)) {
  file_.rdbuf()->pubsetbuf(nullptr, 0);  // a header is read at a time, each from somewhere else
  file_.open(path, std::ios::binary);
  std::error_code none;
  size_ = std::filesystem::file_size(path, none);
  if (none) size_ = 0;
}

Status RecordingSearch::open(const std::string& path, const std::string& radar,
                             std::unique_ptr<RecordingSearch>& out) {
  std::unique_ptr<RecordingSearch> search(new RecordingSearch(path, radar));
  if (Status status = RecordingReader::open(path, search->reader_); !status.ok()) return status;
  const auto first = search->next_frame(0, search->size_, false);
  if (!first)
    return Status::failure(Outcome::bad_stream, path + ": no frame of radar " + radar + " begins in it");
  search->first_ = *first;
  search->find_end();
  out = std::move(search);
  return {};
}

// Where the first whole message at or behind an offset begins.
std::optional<std::uint64_t> RecordingSearch::sync(std::uint64_t offset) {
  reader_->seek(offset);
  for (;;) {
    const auto found = reader_->next();
    if (found == RecordingReader::Found::message) return reader_->offset();
    if (found == RecordingReader::Found::end) return std::nullopt;
  }
}

// Of a message that begins there; its CRC is left alone, and so is what follows it.
std::optional<wire::MessageHeader> RecordingSearch::header_at(std::uint64_t offset) {
  std::array<std::byte, wire::kHeaderBytes> bytes;
  file_.clear();
  file_.seekg(static_cast<std::streamoff>(offset));
  if (!file_.read(reinterpret_cast<char*>(bytes.data()), bytes.size())) return std::nullopt;
  wire::MessageHeader header;
  if (wire::decode_header(bytes, wire::kMaxPayloadBytes, header) != wire::HeaderStatus::ok)
    return std::nullopt;
  return header;
}

std::optional<RecordedPlace> RecordingSearch::place_at(std::uint64_t offset,
                                                       const wire::MessageHeader& header) {
  if (header.type != wire::MessageType::frame_begin) return std::nullopt;
  wire::Bytes descriptor(header.descriptor_length);
  file_.clear();
  file_.seekg(static_cast<std::streamoff>(offset + header.header_length));
  wire::FrameBegin begin;
  if (!file_.read(reinterpret_cast<char*>(descriptor.data()),
                  static_cast<std::streamsize>(descriptor.size())) ||
      !wire::parse_descriptor(descriptor, begin) || begin.frame().radar() != radar_)
    return std::nullopt;
  RecordedPlace place{offset, header.utc_ns};
  place.is_pass = begin.has_scan();
  const wire::Pose& pose = begin.frame().pose();
  // A pose that never had one has 0 (its settings' default).
  if (pose.sim_time_ns() != 0) place.sim_time_ns = pose.sim_time_ns();
  return place;
}

// The first frame of the radar that begins in [offset, end).
std::optional<RecordedPlace> RecordingSearch::next_frame(std::uint64_t offset, std::uint64_t end,
                                                         bool on_a_message) {
  std::optional<std::uint64_t> at = on_a_message ? offset : sync(offset);
  while (at && *at < end) {
    const auto header = header_at(*at);
    if (!header || *at + size_of(*header) > size_) {
      // Damage, or a cut: the next whole message goes on.
      at = sync(*at);
      if (!at || *at >= end) return std::nullopt;
      const auto again = header_at(*at);
      if (!again) return std::nullopt;
      if (const auto place = place_at(*at, *again)) return place;
      *at += size_of(*again);
      continue;
    }
    if (const auto place = place_at(*at, *header)) return place;
    *at += size_of(*header);
  }
  return std::nullopt;
}

void RecordingSearch::find_end() {
  end_utc_ns_ = first_.utc_ns;
  for (std::uint64_t tail = kFirstTail_bytes;; tail *= 4) {
    const std::uint64_t from = tail < size_ - first_.offset ? size_ - tail : first_.offset;
    bool found = false;
    for (auto at = sync(from); at && *at < size_;) {
      const auto header = header_at(*at);
      if (!header || *at + size_of(*header) > size_) break;
      if (is_frame(header->type)) {
        found = true;
        end_utc_ns_ = std::max(end_utc_ns_, header->utc_ns);
      }
      *at += size_of(*header);
    }
    if (found || from == first_.offset) return;
  }
}

// The next frame of the radar, wherever it is.
std::optional<RecordedPlace> RecordingSearch::after(const RecordedPlace& place) {
  const auto header = header_at(place.offset);
  if (!header) return std::nullopt;
  return next_frame(place.offset + size_of(*header), size_, true);
}

// The frame before; of the first: itself.
RecordedPlace RecordingSearch::before(const RecordedPlace& place) {
  for (std::uint64_t back = kShort_bytes;; back *= 4) {
    const std::uint64_t from = back < place.offset - first_.offset ? place.offset - back : first_.offset;
    std::optional<RecordedPlace> last;
    for (auto next = next_frame(from, place.offset, false); next; next = after(*next)) {
      if (next->offset >= place.offset) break;
      last = next;
    }
    if (last || from == first_.offset) return last.value_or(place);
  }
}

RecordingSearch::Found RecordingSearch::search(Reached is_reached, std::int64_t time) {
  RecordedPlace frame = first_;
  // The frame is that one or behind it, and begins before `end`.
  std::uint64_t end = size_;
  while (end - frame.offset > kShort_bytes) {
    const std::uint64_t middle = frame.offset + (end - frame.offset) / 2;
    const auto place = next_frame(middle, end, false);
    if (place && is_reached(*place, time)) {
      frame = *place;
    } else {
      end = middle;
    }
  }
  for (auto next = after(frame); next && is_reached(*next, time); next = after(*next)) frame = *next;
  return {frame, before(frame)};
}

RecordingSearch::Found RecordingSearch::at_utc(std::int64_t utc_ns) {
  return search([](const RecordedPlace& place, std::int64_t time) { return place.utc_ns <= time; }, utc_ns);
}

std::optional<RecordingSearch::Found> RecordingSearch::at_sim_time(std::int64_t sim_time_ns) {
  const Found found = search(
      [](const RecordedPlace& place, std::int64_t time) { return place.sim_time_ns.value_or(time) <= time; },
      sim_time_ns);
  if (!found.frame.sim_time_ns) return std::nullopt;
  return found;
}

}  // namespace obliq::client
