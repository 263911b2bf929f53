// What a recording begins with: its first frame, just enough of it to know what follows.
#include "client/frame_dispatch.h"
#include "client/recording/recorded_frames.h"
#include "proto/obliq.pb.h"

namespace obliq::client {

RecordingStart::RecordingStart() = default;
RecordingStart::~RecordingStart() = default;
RecordingStart::RecordingStart(RecordingStart&&) noexcept = default;
RecordingStart& RecordingStart::operator=(RecordingStart&&) noexcept = default;

namespace {

/// Reads a radar's frames up to the first that has values, to learn its planes.
class FirstFrame : public FrameHandler {
 public:
  FirstFrame(const std::string& radar, RecordingStart& start) : radar_(radar), start_(start) {}

  Status on_begin(const wire::MessageHeader& header, const wire::FrameBegin& begin) override {
    if (start_.planes != 0 || (!radar_.empty() && begin.frame().radar() != radar_)) return {};
    if (start_.descriptor) {
      // A frame without any value came before it: all of its dwells were missed, or it was given up.
      if (begin.frame().radar() == start_.radar) stream_id_ = header.stream_id;
      return {};
    }
    start_.radar = begin.frame().radar();
    start_.utc_ns = header.utc_ns;
    start_.descriptor = std::make_unique<wire::FrameDescriptor>(begin.frame());
    stream_id_ = header.stream_id;
    return {};
  }
  Status on_block(const wire::MessageHeader& header, const wire::WedgeBlock& block,
                  std::span<const std::byte>) override {
    const auto plane = wire::plane_from_number(block.plane());
    if (start_.descriptor && header.stream_id == stream_id_ && plane)
      start_.planes = static_cast<wire::PlaneSet>(start_.planes | wire::plane_bit(*plane));
    return {};
  }
  Status on_end(const wire::MessageHeader& header, const wire::FrameEnd&) override {
    done_ = start_.planes != 0 && header.stream_id == stream_id_;
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
  if (reader.messages() == 0 && reader.fault().bytes == 0)
    text = (reader.offset() == 0 ? "it is empty, so " : "it is not what `obliq record` writes: ") + text;
  return Status::failure(
      Outcome::bad_stream,
      text + "begins in it; it has " + std::to_string(reader.messages()) + " whole messages" +
          (reader.fault().bytes == 0
               ? ""
               : ", and " + std::to_string(reader.fault().bytes) + " bytes behind them that are none"));
}

}  // namespace obliq::client
