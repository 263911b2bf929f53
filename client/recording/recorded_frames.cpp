#include "client/recording/recorded_frames.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "client/frame_dispatch.h"
#include "proto/obliq.pb.h"

namespace obliq::client {

using wire::MessageType;

std::string RecordingLosses::text() const {
  const auto counted = [](std::uint64_t n, const char* what) {
    return std::to_string(n) + " " + what + (n == 1 ? "" : "s");
  };
  std::string text = counted(frames, "frame") + " lost";
  if (damages > 0) text += ", damaged in " + counted(damages, "place");
  return text;
}

const RecordingLosses& more_of(const RecordingLosses& a, const RecordingLosses& b) {
  return a.frames + a.damages < b.frames + b.damages ? b : a;
}

// ---- One frame at a time ----

/// Assembles the frames of one radar and keeps their times. What is of another radar is counted.
class RecordedFrames::Collector : public FrameAssembler {
 public:
  Collector(const RecordedFrames& frames, Seen& seen, RecordingLosses& losses, std::uint64_t& others)
      : FrameAssembler(frames.planes_, frames.max_bytes_),
        radar_(frames.radar_),
        planes_(frames.planes_),
        seen_(seen),
        losses_(losses),
        others_(others) {}

  Status on_begin(const wire::MessageHeader& header, const wire::FrameBegin& begin) override {
    if (begin.frame().radar() != radar_) {
      ++others_;
      return {};
    }
    if (state() == State::receiving && header.stream_id != stream_id_) return {};
    seen_ = {header.stream_id, begin.frame_id()};
    const Status status = FrameAssembler::on_begin(header, begin);
    if (!status.ok()) return status;
    stream_id_ = header.stream_id;
    frame_id_ = begin.frame_id();
    azimuths_.assign(static_cast<std::size_t>(frame().n_azimuth), {});
    times_ = {};
    times_.begin_utc_ns = header.utc_ns;
    if (begin.has_scan()) times_.scan = std::make_shared<const wire::ScanPass>(begin.scan());
    newest_ = nullptr;
    times_.bytes = size_of(header);
    return status;
  }
  Status on_block(const wire::MessageHeader& header, const wire::WedgeBlock& block,
                  std::span<const std::byte> values) override {
    if (!is_mine(header, block.frame_id())) return orphan(header, block.frame_id());
    const Status status = FrameAssembler::on_block(header, block, values);
    if (!status.ok()) return status;
    times_.bytes += size_of(header);
    if (times_.first_wedge_ns == 0) {
      times_.first_wedge_ns = block.send_ns() - block.render_start_ns();
      // In a file they may be anything.
      if (__builtin_sub_overflow(header.utc_ns, block.send_ns(), &times_.clock_offset_ns))
        times_.clock_offset_ns = 0;
    }
    // Nothing in it, or nothing that was looked at: not a place in the frame.
    const auto plane = wire::plane_from_number(block.plane());
    if (!plane || !(planes_ & wire::plane_bit(*plane)) || values.empty()) return status;
    for (std::size_t row = 0; row < block.n_azimuth(); ++row) {
      const std::size_t at = block.first_azimuth() + row;
      if (at >= azimuths_.size()) break;
      Azimuth& azimuth = azimuths_[at];
      const std::int64_t utc_ns = azimuth.seen ? azimuth.utc_ns : header.utc_ns;
      azimuth.seen = true;
      azimuth.wedge = block.wedge_index();
      azimuth.utc_ns = std::max(utc_ns, header.utc_ns);
      if (!azimuth.block) azimuth.block = shared(block);
    }
    return status;
  }
  Status on_end(const wire::MessageHeader& header, const wire::FrameEnd& end) override {
    if (!is_mine(header, end.frame_id())) return orphan(header, end.frame_id());
    times_.end_utc_ns = header.utc_ns;
    times_.bytes += size_of(header);
    return FrameAssembler::on_end(header, end);
  }
  Status on_abort(const wire::MessageHeader& header, const wire::FrameAbort& abort) override {
    if (!is_mine(header, abort.frame_id())) return orphan(header, abort.frame_id());
    return FrameAssembler::on_abort(header, abort);
  }

  std::uint64_t frame_id() const { return frame_id_; }
  RecordedFrame take_recorded() {
    RecordedFrame whole = std::exchange(times_, {});
    whole.frame = take();
    if (whole.frame.descriptor->has_window()) return whole;
    // Each azimuth is in one wedge, whatever order its planes came in.
    for (std::uint32_t i = 0; i < azimuths_.size(); ++i) {
      // What a scanning antenna missed is known at the end.
      if (!azimuths_[i].seen) azimuths_[i].utc_ns = whole.end_utc_ns;
      if (i == 0 || azimuths_[i].seen != azimuths_[i - 1].seen ||
          azimuths_[i].wedge != azimuths_[i - 1].wedge)
        whole.wedges.push_back(
            {azimuths_[i].wedge, i, 0, azimuths_[i].utc_ns, !azimuths_[i].seen, azimuths_[i].block});
      RecordedWedge& wedge = whole.wedges.back();
      ++wedge.n_azimuth;
      wedge.utc_ns = std::max(wedge.utc_ns, azimuths_[i].utc_ns);
    }
    std::ranges::stable_sort(whole.wedges, {}, &RecordedWedge::utc_ns);
    return whole;
  }

 private:
  struct Azimuth {
    bool seen = false;
    std::uint32_t wedge = 0;
    std::int64_t utc_ns = 0;                          ///< of the last block with it
    std::shared_ptr<const wire::WedgeBlock> block{};  ///< the first with it
  };
  // One for all azimuths of a wedge: its planes come one behind the other.
  std::shared_ptr<const wire::WedgeBlock> shared(const wire::WedgeBlock& block) {
    if (!newest_ || newest_->wedge_index() != block.wedge_index())
      newest_ = std::make_shared<const wire::WedgeBlock>(block);
    return newest_;
  }
  bool is_mine(const wire::MessageHeader& header, std::uint64_t frame_id) const {
    return state() == State::receiving && header.stream_id == stream_id_ && frame_id == frame_id_;
  }
  // What belongs to no current frame: of a stream that is the radar's, the first of a frame whose FrameBegin
  // is missing is told.
  Status orphan(const wire::MessageHeader& header, std::uint64_t frame_id) {
    if (state() == State::receiving || seen_.stream_id != header.stream_id || seen_.frame_id == frame_id)
      return {};
    seen_.frame_id = frame_id;
    ++losses_.frames;
    return Status::failure(Outcome::bad_stream,
                           "frame " + std::to_string(frame_id) + " is lost, its beginning is missing");
  }
  static std::uint64_t size_of(const wire::MessageHeader& header) {
    return std::uint64_t{header.header_length} + header.payload_length;
  }

  const std::string& radar_;
  const wire::PlaneSet planes_;
  Seen& seen_;
  RecordingLosses& losses_;
  std::uint64_t& others_;
  std::uint32_t stream_id_ = 0;
  std::uint64_t frame_id_ = 0;
  RecordedFrame times_;
  std::vector<Azimuth> azimuths_;  ///< [n_azimuth]
  std::shared_ptr<const wire::WedgeBlock> newest_;
};

// ---- All frames ----

RecordedFrames::RecordedFrames(std::unique_ptr<RecordingReader> reader, std::string radar,
                               wire::PlaneSet planes, std::uint64_t max_bytes)
    : reader_(std::move(reader)),
      radar_(std::move(radar)),
      planes_(planes),
      max_bytes_(max_bytes),
      collector_(std::make_unique<Collector>(*this, seen_, losses_, others_)) {}
RecordedFrames::~RecordedFrames() = default;

std::uint64_t RecordedFrames::frames_of_others() const { return others_; }

std::string RecordedFrames::frame_in_hand() const {
  if (collector_->state() != FrameAssembler::State::receiving) return {};
  // Rounded down: what is not whole never reads as 100 %.
  const int percent = static_cast<int>(std::floor(100 * collector_->fraction()));
  return "; frame " + std::to_string(collector_->frame_id()) + " is incomplete, " + std::to_string(percent) +
         " % of it arrived";
}

// Message for an incomplete frame.
std::string RecordedFrames::lose() {
  const std::string text = frame_in_hand();
  if (!text.empty()) ++losses_.frames;
  collector_ = std::make_unique<Collector>(*this, seen_, losses_, others_);
  return text;
}

// True when the caller is to hear of it.
bool RecordedFrames::take_message(RecordedFrame& frame, Found& found) {
  const wire::MessageView& message = reader_->message();
  const auto dispatch = [&] {
    return dispatch_frame(message.header, message.descriptor, message.plane, *collector_);
  };
  const std::string at = "at offset " + std::to_string(reader_->offset()) + ": ";
  found = Found::note;
  if (message.header.type == MessageType::welcome) {
    // Another connection, whose streams may have other numbers: nothing of the last one follows.
    const std::string lost = lose();
    seen_ = {};
    if (!lost.empty()) note_ = at + "the connection was lost there" + lost;
    return !lost.empty();
  }
  if (!is_frame(message.header.type)) return false;
  const std::uint64_t lost_before = losses_.frames;
  const Status status = dispatch();
  if (!status.ok()) {
    note_ = at + status.text + lose();
    // A frame whose end is missing does not cost the one behind it.
    const bool begins = message.header.type == MessageType::frame_begin;
    if (begins && !dispatch().ok()) ++losses_.frames;
    if (!begins && losses_.frames == lost_before) ++losses_.damages;  // of an unknown frame
    return true;
  }
  if (collector_->state() == FrameAssembler::State::aborted) {
    note_ = "frame " + std::to_string(collector_->frame_id()) + ": aborted, " + collector_->abort_reason();
    ++aborted_;
    (void)collector_->take();
    return true;
  }
  if (collector_->state() != FrameAssembler::State::complete) return false;
  found = Found::frame;
  frame = collector_->take_recorded();
  return true;
}

RecordedFrames::Found RecordedFrames::next(RecordedFrame& frame) {
  note_.clear();
  for (;;) {
    switch (reader_->next()) {
      case RecordingReader::Found::message:
        if (Found found{}; take_message(frame, found)) return found;
        break;
      case RecordingReader::Found::damage: {
        const RecordingFault& fault = reader_->fault();
        ++losses_.damages;
        // A block of the current frame may be among what was skipped.
        note_ = "damaged at offset " + std::to_string(fault.offset) + ": " + fault.reason + "; " +
                std::to_string(fault.bytes) + " bytes skipped" + lose();
        return Found::note;
      }
      case RecordingReader::Found::end: {
        const RecordingFault& fault = reader_->fault();
        const std::string frame_text = frame_in_hand();
        cut_ = fault.bytes > 0 || !frame_text.empty();
        if (fault.bytes > 0) {
          note_ = "cut at offset " + std::to_string(fault.offset + fault.bytes) + ": the last " +
                  std::to_string(fault.bytes) + " bytes, from offset " + std::to_string(fault.offset) +
                  ", are no whole message" + frame_text;
        } else if (cut_) {
          note_ =
              "cut at offset " + std::to_string(reader_->offset()) + ", behind a whole message" + frame_text;
        }
        return Found::end;
      }
    }
  }
}

}  // namespace obliq::client
