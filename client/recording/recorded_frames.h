#pragma once
// The frames of a recording, one after the other, and what is wrong with it in sentences.
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/frame_assembler.h"
#include "client/recording/recording_reader.h"

namespace obliq::wire {
class ScanPass;
}

namespace obliq::client {

/// When a wedge was sent: its last block's time. Of azimuths that a scanning antenna missed: the frame's end.
struct RecordedWedge {
  std::uint32_t index = 0;
  std::uint32_t first_azimuth = 0;
  std::uint32_t n_azimuth = 0;
  std::int64_t utc_ns = 0;
  bool missed = false;
  /// Of its first block: pose, times by the server's monotonic clock. Null: missed.
  std::shared_ptr<const wire::WedgeBlock> block{};
};

struct RecordedFrame {
  AssembledFrame frame;
  std::int64_t begin_utc_ns = 0;      ///< when the server encoded its FrameBegin
  std::int64_t end_utc_ns = 0;        ///< and its FrameEnd
  std::int64_t first_wedge_ns = 0;    ///< from the start of rendering to the first block
  std::uint64_t bytes = 0;            ///< on the wire
  std::vector<RecordedWedge> wedges;  ///< in the order in which they came; none of a frame's window
  std::shared_ptr<const wire::ScanPass> scan{};  ///< of a scanning antenna; null: all of the sector at once
  std::int64_t clock_offset_ns = 0;  ///< UTC less the server's monotonic clock, by its first block
};

/// What a recording begins with.
struct RecordingStart {
  RecordingStart();
  ~RecordingStart();
  RecordingStart(RecordingStart&&) noexcept;
  RecordingStart& operator=(RecordingStart&&) noexcept;
  std::string radar;
  wire::PlaneSet planes = 0;  ///< of the first frame that brought any
  std::int64_t utc_ns = 0;    ///< of the first frame
  std::unique_ptr<wire::FrameDescriptor> descriptor;
};

/// What is missing in a recording, but for the frame that its end cut.
struct RecordingLosses {
  std::uint64_t frames = 0;   ///< that began, or of which something came, and are not whole
  std::uint64_t damages = 0;  ///< places where bytes are no message

  bool any() const { return frames > 0 || damages > 0; }
  std::string text() const;
};
/// Of the same recording, read twice and perhaps not to its end.
const RecordingLosses& more_of(const RecordingLosses& a, const RecordingLosses& b);

/// Reads as far as the end of the first frame that has values. `radar` empty: whichever comes first.
/// bad_stream when no frame of it begins.
Status read_start(RecordingReader& reader, const std::string& radar, RecordingStart& start);

/// Whole frames of one radar. One frame is held at a time. For one thread at a time.
class RecordedFrames {
 public:
  /// max_bytes: a frame whose planes need more is left out.
  RecordedFrames(std::unique_ptr<RecordingReader> reader, std::string radar, wire::PlaneSet planes,
                 std::uint64_t max_bytes = std::uint64_t{2} << 30);
  ~RecordedFrames();

  enum class Found {
    frame,  ///< in `frame`
    note,   ///< note() says what is missing here: a frame that was aborted, a damaged place
    end,    ///< note() says how the recording ends, where it does so in the middle of something
  };
  Found next(RecordedFrame& frame);
  const std::string& note() const { return note_; }

  const RecordingLosses& losses() const { return losses_; }
  /// Frames that the server ended by a FrameAbort.
  std::uint64_t aborted() const { return aborted_; }
  bool cut() const { return cut_; }
  std::uint64_t frames_of_others() const;
  const RecordingReader& reader() const { return *reader_; }

 private:
  class Collector;

  /// Where a frame of the radar was last seen, whole or not.
  struct Seen {
    std::optional<std::uint32_t> stream_id;  ///< of this connection
    std::uint64_t frame_id = 0;
  };

  std::string frame_in_hand() const;
  std::string lose();
  bool take_message(RecordedFrame& frame, Found& found);

  std::unique_ptr<RecordingReader> reader_;
  std::string radar_;
  wire::PlaneSet planes_;
  std::uint64_t max_bytes_;
  std::unique_ptr<Collector> collector_;
  std::string note_;
  RecordingLosses losses_;
  Seen seen_;
  std::uint64_t aborted_ = 0;
  std::uint64_t others_ = 0;
  bool cut_ = false;
};

}  // namespace obliq::client
