#include "tests/support/made_recording.h"

#include <cstring>
#include <span>

#include "proto/message_header.h"
#include "proto/obliq.pb.h"
#include "server/stream/frame_encoder.h"

namespace obliq::test {

void MadeRecording::add(const wire::Bytes& message, wire::MessageType type, std::uint64_t frame_id) {
  const std::size_t begin = bytes.size();
  bytes.append(reinterpret_cast<const char*>(message.data()), message.size());
  messages.push_back({begin, bytes.size(), type, frame_id});
}

double made_power(std::uint64_t frame_id, int azimuth, int range) {
  return static_cast<double>(frame_id) * 1e6 + azimuth * 1000.0 + range;
}

void add_frame(MadeRecording& recording, std::uint64_t frame_id, std::uint64_t& sequence, bool whole,
               const std::string& radar, std::uint32_t stream_id,
               const std::vector<stream::StreamChoice>& choices, std::int64_t sim_time_ns) {
  stream::FrameEncoder encoder({.stream_id = stream_id, .frame_id = frame_id, .choices = choices}, sequence);
  const auto add = [&](const stream::BlockPtr& block) { recording.add(block->bytes, block->type, frame_id); };
  wire::FrameDescriptor descriptor;
  descriptor.set_radar(radar);
  descriptor.set_frame_id(frame_id);
  descriptor.mutable_settings()->set_azimuth_bins(kMadeAzimuths);
  descriptor.mutable_settings()->set_range_bins(kMadeRanges);
  descriptor.set_azimuth_width_deg(1);
  descriptor.set_range_spacing_m(100);
  descriptor.set_radius_factor(1);
  descriptor.mutable_settings()->set_frustum(wire::POLAR);  // as of old recordings: it makes no frames now
  if (sim_time_ns != 0) descriptor.mutable_pose()->set_sim_time_ns(sim_time_ns);
  for (const auto& block : encoder.begin(descriptor)) add(block);
  for (int wedge = 0; wedge < (whole ? 2 : 1); ++wedge) {
    BinBlock bins(wedge * 8, wedge == 0 ? 8 : kMadeAzimuths - 8, kMadeRanges);
    for (int azimuth = 0; azimuth < bins.n_azimuth; ++azimuth) {
      for (int range = 0; range < kMadeRanges; ++range) {
        const auto at = static_cast<std::size_t>(azimuth * kMadeRanges + range);
        bins.power_w[at] = made_power(frame_id, bins.first_azimuth + azimuth, range);
        bins.iq[at] = {static_cast<float>(azimuth), static_cast<float>(range)};
        bins.count[at] = static_cast<std::uint32_t>(frame_id);
        bins.state[at] = static_cast<std::uint8_t>(range);
      }
    }
    for (const auto& block : encoder.wedge(wedge, bins)) add(block);
  }
  if (whole) {
    wire::FrameSummary summary;
    summary.set_frame_id(frame_id);
    add(encoder.end(summary, 0.001));
  } else {
    add(encoder.abort("made to end"));
  }
}

void set_time(MadeRecording& recording, std::size_t message, std::int64_t utc_ns) {
  const MadeMessage& at = recording.messages[message];
  std::memcpy(recording.bytes.data() + at.begin + 32, &utc_ns, sizeof utc_ns);  // PROTOCOL.md, Header
  const auto whole = std::as_bytes(std::span(recording.bytes)).subspan(at.begin, at.end - at.begin);
  const std::uint32_t crc = wire::message_crc(whole.first(48), whole.subspan(48));
  std::memcpy(recording.bytes.data() + at.begin + 40, &crc, sizeof crc);
}

MadeRecording timed_recording(int frames, std::int64_t step_ns) {
  MadeRecording recording;
  std::uint64_t sequence = 0;
  for (int k = 0; k < frames; ++k) {
    const std::size_t first = recording.messages.size();
    const std::int64_t begin_ns = k * step_ns;
    add_frame(recording, static_cast<std::uint64_t>(k + 1), sequence, true, "main", 1, {},
              kMadeSimStart_ns + begin_ns);
    // FrameBegin, four planes of each wedge, FrameEnd.
    const std::size_t messages = recording.messages.size() - first;
    for (std::size_t i = 0; i < messages; ++i) {
      const std::int64_t part = i == 0 ? 0 : i + 1 == messages ? 99 : i < messages / 2 ? 33 : 66;
      set_time(recording, first + i, kMadeStart_ns + begin_ns + part * step_ns / 100);
    }
  }
  return recording;
}

MadeRecording made_recording() {
  MadeRecording recording;
  wire::Welcome welcome;
  welcome.set_major(wire::kMajorVersion);
  welcome.set_server_name("made");
  welcome.add_radars("main");
  recording.add(wire::encode_message(wire::MessageType::welcome, {0, 1, 1}, welcome),
                wire::MessageType::welcome);
  std::uint64_t sequence = 0;
  for (std::uint64_t id = 1; id <= 4; ++id) add_frame(recording, id, sequence, id != 2);
  return recording;
}

}  // namespace obliq::test
