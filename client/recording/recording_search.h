#pragma once
// Finds a frame of a recording by its time, without reading what lies before it: the file has no index, but
// its messages prove themselves, wherever one begins to read.
#include <cstdint>
#include <fstream>
#include <memory>
#include <optional>
#include <string>

#include "client/recording/recording_reader.h"

namespace obliq::client {

/// A frame's FrameBegin in the file.
struct RecordedPlace {
  std::uint64_t offset = 0;
  std::int64_t utc_ns = 0;                    ///< when the server encoded it
  std::optional<std::int64_t> sim_time_ns{};  ///< of its pose
  bool is_pass = false;                       ///< of a scanning antenna
};

/// Times that rise through the file are taken for granted; where the server's clock was set while it
/// recorded, a search ends somewhere. A search reads a header for each message of some twenty frames. For one
/// thread at a time.
class RecordingSearch {
 public:
  /// Looks at the ends. bad_argument, bad_stream: it cannot be opened, or holds no frame of that radar.
  static Status open(const std::string& path, const std::string& radar,
                     std::unique_ptr<RecordingSearch>& out);

  const RecordedPlace& first() const { return first_; }
  /// Of the last message of any frame.
  std::int64_t end_utc_ns() const { return end_utc_ns_; }

  /// A frame and the one before it; of the first frame: itself.
  struct Found {
    RecordedPlace frame;
    RecordedPlace before;
  };
  /// The last frame that begins at or before that time; the first where none does.
  Found at_utc(std::int64_t utc_ns);
  /// The same by the poses' own clock; nothing when the frame there has no such time.
  std::optional<Found> at_sim_time(std::int64_t sim_time_ns);

 private:
  RecordingSearch(const std::string& path, std::string radar);

  using Reached = bool (*)(const RecordedPlace& place, std::int64_t time);
  Found search(Reached is_reached, std::int64_t time);
  std::optional<std::uint64_t> sync(std::uint64_t offset);
  std::optional<wire::MessageHeader> header_at(std::uint64_t offset);
  std::optional<RecordedPlace> place_at(std::uint64_t offset, const wire::MessageHeader& header);
  std::optional<RecordedPlace> next_frame(std::uint64_t offset, std::uint64_t end, bool on_a_message);
  std::optional<RecordedPlace> after(const RecordedPlace& place);
  RecordedPlace before(const RecordedPlace& place);
  void find_end();

  std::string radar_;
  std::ifstream file_;
  std::unique_ptr<RecordingReader> reader_;
  std::uint64_t size_ = 0;
  RecordedPlace first_;
  std::int64_t end_utc_ns_ = 0;
};

}  // namespace obliq::client
