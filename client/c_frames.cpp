#include "client/c_frames.h"

#include <utility>

#include "proto/obliq.pb.h"

namespace obliq::client {

void FramesOfStreams::watch(const std::string& radar, wire::PlaneSet planes) {
  of_radar_[radar] = planes;
  std::erase_if(whole, [&](const AssembledFrame& frame) {
    return frame.request_id == 0 && frame.descriptor->radar() == radar;  // it may have other planes
  });
}

Status FramesOfStreams::on_begin(const wire::MessageHeader& header, const wire::FrameBegin& begin) {
  const auto asked = of_request.find(begin.request_id());
  const auto watched = of_radar_.find(begin.frame().radar());
  if (asked == of_request.end() && watched == of_radar_.end()) return {};  // no longer wanted
  const wire::PlaneSet planes = asked != of_request.end() ? asked->second : watched->second;
  Stream& stream = streams_[header.stream_id];
  if (stream.frames == nullptr || stream.planes != planes)
    stream = {planes, std::make_unique<FrameAssembler>(planes)};
  return stream.frames->on_begin(header, begin);
}

Status FramesOfStreams::on_block(const wire::MessageHeader& header, const wire::WedgeBlock& block,
                                 std::span<const std::byte> values) {
  const auto stream = streams_.find(header.stream_id);
  return stream == streams_.end() ? Status{} : stream->second.frames->on_block(header, block, values);
}

Status FramesOfStreams::on_targets(const wire::MessageHeader& header, const wire::TargetBlock& block,
                                   std::span<const wire::TargetRecord> records) {
  const auto stream = streams_.find(header.stream_id);
  return stream == streams_.end() ? Status{} : stream->second.frames->on_targets(header, block, records);
}

Status FramesOfStreams::on_end(const wire::MessageHeader& header, const wire::FrameEnd& end) {
  const auto stream = streams_.find(header.stream_id);
  if (stream == streams_.end()) return {};
  FrameAssembler& frames = *stream->second.frames;
  if (Status status = frames.on_end(header, end); !status.ok()) return status;
  if (frames.state() != FrameAssembler::State::complete) return {};
  AssembledFrame frame = frames.take();
  if (frame.request_id != 0) {
    of_request.erase(frame.request_id);
    streams_.erase(stream);
  } else {
    const auto is_older = [&](const AssembledFrame& other) {
      return other.request_id == 0 && other.descriptor->radar() == frame.descriptor->radar();
    };
    for (const AssembledFrame& other : whole)
      if (is_older(other)) frame.frames_skipped += other.frames_skipped + 1;
    std::erase_if(whole, is_older);
  }
  whole.push_back(std::move(frame));
  return {};
}

Status FramesOfStreams::on_abort(const wire::MessageHeader& header, const wire::FrameAbort& abort) {
  streams_.erase(header.stream_id);
  if (of_request.erase(abort.request_id()) > 0) aborted = abort.reason();
  return {};
}

}  // namespace obliq::client
