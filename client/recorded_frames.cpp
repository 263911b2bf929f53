#include "client/recorded_frames.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "client/frame_dispatch.h"
#include "proto/obliq.pb.h"

namespace obliq::client {

using wire::MessageType;

RecordingStart::RecordingStart() = default;
RecordingStart::~RecordingStart() = default;
RecordingStart::RecordingStart(RecordingStart&&) noexcept = default;
RecordingStart& RecordingStart::operator=(RecordingStart&&) noexcept = default;

// ---- One frame at a time ----

/// Assembles the frames of one radar and keeps their times. What is of another radar is counted.
class RecordedFrames::Collector : public FrameAssembler {
 public:
  Collector(const std::string& radar, wire::PlaneSet planes, std::uint64_t max_bytes, std::uint64_t& others)
      : FrameAssembler(planes, max_bytes), radar_(radar), planes_(planes), others_(others) {}

  Status on_begin(const wire::FrameHeader& header, const wire::FrameBegin& begin) override {
    if (begin.frame().radar() != radar_) {
      ++others_;
      return {};
    }
    if (state() == State::receiving && header.stream_id != stream_id_) return {};
    if (begin.frame().has_window()) {
      return Status::failure(Outcome::bad_stream, "a part of a frame; allowed: whole frames");
    }
    const Status status = FrameAssembler::on_begin(header, begin);
    if (!status.ok()) return status;
    stream_id_ = header.stream_id;
    frame_id_ = begin.frame_id();
    azimuths_.assign(static_cast<std::size_t>(frame().n_azimuth), {});
    times_ = {};
    times_.begin_utc_ns = header.utc_ns;
    times_.bytes = size_of(header);
    return status;
  }
  Status on_block(const wire::FrameHeader& header, const wire::WedgeBlock& block,
                  std::span<const std::byte> values) override {
    if (!is_mine(header, block.frame_id())) return {};
    const Status status = FrameAssembler::on_block(header, block, values);
    if (!status.ok()) return status;
    times_.bytes += size_of(header);
    if (times_.first_wedge_ns == 0) times_.first_wedge_ns = block.send_ns() - block.render_start_ns();
    // Nothing in it, or nothing that was looked at: not a place in the frame.
    const auto plane = wire::plane_from_number(block.plane());
    if (!plane || !(planes_ & wire::plane_bit(*plane)) || values.empty()) return status;
    for (std::size_t row = 0; row < block.n_azimuth(); ++row) {
      const std::size_t at = block.first_azimuth() + row;
      if (at >= azimuths_.size()) break;
      const std::int64_t utc_ns = azimuths_[at].seen ? azimuths_[at].utc_ns : header.utc_ns;
      azimuths_[at] = {true, block.wedge_index(), std::max(utc_ns, header.utc_ns)};
    }
    return status;
  }
  Status on_end(const wire::FrameHeader& header, const wire::FrameEnd& end) override {
    if (is_mine(header, end.frame_id())) {
      times_.end_utc_ns = header.utc_ns;
      times_.bytes += size_of(header);
    }
    return FrameAssembler::on_end(header, end);
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
          azimuths_[i].wedge != azimuths_[i - 1].wedge) {
        whole.wedges.push_back({azimuths_[i].wedge, i, 0, azimuths_[i].utc_ns});
      }
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
    std::int64_t utc_ns = 0;  ///< of the last block with it
  };
  bool is_mine(const wire::FrameHeader& header, std::uint64_t frame_id) const {
    return state() == State::receiving && header.stream_id == stream_id_ && frame_id == frame_id_;
  }
  static std::uint64_t size_of(const wire::FrameHeader& header) {
    return std::uint64_t{header.header_length} + header.payload_length;
  }

  const std::string& radar_;
  const wire::PlaneSet planes_;
  std::uint64_t& others_;
  std::uint32_t stream_id_ = 0;
  std::uint64_t frame_id_ = 0;
  RecordedFrame times_;
  std::vector<Azimuth> azimuths_;  ///< [n_azimuth]
};

namespace {

/// Hears the first frame of a radar, just enough to know its planes.
class FirstFrame : public FrameHandler {
 public:
  FirstFrame(const std::string& radar, RecordingStart& start) : radar_(radar), start_(start) {}

  Status on_begin(const wire::FrameHeader& header, const wire::FrameBegin& begin) override {
    if (start_.descriptor || (!radar_.empty() && begin.frame().radar() != radar_)) return {};
    start_.radar = begin.frame().radar();
    start_.utc_ns = header.utc_ns;
    start_.descriptor = std::make_unique<wire::FrameDescriptor>(begin.frame());
    stream_id_ = header.stream_id;
    return {};
  }
  Status on_block(const wire::FrameHeader& header, const wire::WedgeBlock& block,
                  std::span<const std::byte>) override {
    const auto plane = wire::plane_from_number(block.plane());
    if (start_.descriptor && header.stream_id == stream_id_ && plane) {
      start_.planes = static_cast<wire::PlaneSet>(start_.planes | wire::plane_bit(*plane));
    }
    return {};
  }
  Status on_end(const wire::FrameHeader& header, const wire::FrameEnd&) override {
    done_ = start_.descriptor && header.stream_id == stream_id_;
    return {};
  }
  bool done() const { return done_; }

 private:
  const std::string& radar_;
  RecordingStart& start_;
  std::uint32_t stream_id_ = 0;
  bool done_ = false;
};

}  // namespace

Status read_start(RecordingReader& reader, const std::string& radar, RecordingStart& start) {
  FirstFrame first(radar, start);
  for (;;) {
    const auto found = reader.next();
    if (found == RecordingReader::Found::end || first.done()) break;
    if (found != RecordingReader::Found::message) continue;
    const wire::MessageView& message = reader.message();
    (void)dispatch_frame(message.header, message.descriptor, message.plane, first).ok();
  }
  if (start.descriptor) return {};
  std::string text = "no frame ";
  if (!radar.empty()) text += "of radar \"" + radar + "\" ";
  return Status::failure(
      Outcome::bad_stream,
      text + "begins in it; it has " + std::to_string(reader.messages()) + " whole messages" +
          (reader.fault().bytes == 0
               ? ""
               : ", and " + std::to_string(reader.fault().bytes) + " bytes behind them that are none"));
}

// ---- All frames ----

RecordedFrames::RecordedFrames(std::unique_ptr<RecordingReader> reader, std::string radar,
                               wire::PlaneSet planes, std::uint64_t max_bytes)
    : reader_(std::move(reader)),
      radar_(std::move(radar)),
      planes_(planes),
      max_bytes_(max_bytes),
      collector_(std::make_unique<Collector>(radar_, planes_, max_bytes_, others_)) {}
RecordedFrames::~RecordedFrames() = default;

std::uint64_t RecordedFrames::frames_of_others() const { return others_; }

std::string RecordedFrames::frame_in_hand() const {
  if (collector_->state() != FrameAssembler::State::receiving) return {};
  // Rounded down: what is not whole never reads as 100 %.
  const int percent = static_cast<int>(std::floor(100 * collector_->fraction()));
  return "; frame " + std::to_string(collector_->frame_id()) + " is incomplete, " + std::to_string(percent) +
         " % of it arrived";
}

// True when the caller is to hear of it.
bool RecordedFrames::take_message(RecordedFrame& frame, Found& found) {
  const wire::MessageView& message = reader_->message();
  found = Found::note;
  if (message.header.type == MessageType::welcome) {
    // Another connection, whose streams may have other numbers: nothing of the last one follows.
    const std::string lost = frame_in_hand();
    collector_ = std::make_unique<Collector>(radar_, planes_, max_bytes_, others_);
    if (!lost.empty()) {
      note_ = "at offset " + std::to_string(reader_->offset()) + ": the connection was lost there" + lost;
    }
    return !lost.empty();
  }
  if (!is_frame(message.header.type)) return false;
  const Status status = dispatch_frame(message.header, message.descriptor, message.plane, *collector_);
  if (!status.ok()) {
    note_ = "at offset " + std::to_string(reader_->offset()) + ": " + status.text + frame_in_hand();
    collector_ = std::make_unique<Collector>(radar_, planes_, max_bytes_, others_);
    // A frame whose end is missing does not cost the one behind it.
    if (message.header.type == MessageType::frame_begin) {
      (void)dispatch_frame(message.header, message.descriptor, message.plane, *collector_).ok();
    }
    return true;
  }
  if (collector_->state() == FrameAssembler::State::aborted) {
    note_ = "frame " + std::to_string(collector_->frame_id()) + ": aborted, " + collector_->abort_reason();
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
        ++damages_;
        note_ = "damaged at offset " + std::to_string(fault.offset) + ": " + fault.reason + "; " +
                std::to_string(fault.bytes) + " bytes skipped" + frame_in_hand();
        // A block of it may be among what was skipped.
        collector_ = std::make_unique<Collector>(radar_, planes_, max_bytes_, others_);
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
