#include "tests/unit/stream/encoder_fixture.h"

#include <gtest/gtest.h>

#include "proto/limits.h"
#include "proto/obliq.pb.h"

namespace obliq::net {

client::Status feed(client::FrameAssembler& frames, const stream::Block& block) {
  wire::MessageView view;
  if (wire::decode_message(block.bytes, wire::kMaxPayloadBytes, view) != wire::MessageStatus::ok) {
    return client::Status::failure(client::Outcome::bad_stream, "does not decode");
  }
  const auto parsed = [&](auto message) {
    EXPECT_TRUE(wire::parse_descriptor(view.descriptor, message));
    return message;
  };
  switch (view.header.type) {
    case wire::MessageType::frame_begin:
      return frames.on_begin(view.header, parsed(wire::FrameBegin()));
    case wire::MessageType::wedge_block:
      return frames.on_block(view.header, parsed(wire::WedgeBlock()), view.plane);
    case wire::MessageType::frame_end:
      return frames.on_end(view.header, parsed(wire::FrameEnd()));
    default:
      return frames.on_abort(view.header, parsed(wire::FrameAbort()));
  }
}

BinBlock filled(int first, int n_azimuth, int n_range) {
  BinBlock bins(first, n_azimuth, n_range);
  for (std::size_t i = 0; i < bins.iq.size(); ++i) {
    const auto azimuth = static_cast<std::size_t>(first) + i / static_cast<std::size_t>(n_range);
    const auto range = i % static_cast<std::size_t>(n_range);
    bins.power_w[i] = static_cast<double>(azimuth) * 1e6 + static_cast<double>(range);
    bins.iq[i] = {static_cast<float>(azimuth), static_cast<float>(range)};
    bins.count[i] = static_cast<std::uint32_t>(range * 7 + azimuth);
    bins.state[i] = static_cast<std::uint8_t>((range + azimuth) % 4);
  }
  return bins;
}

wire::FrameDescriptor descriptor(int n_azimuth, int n_range) {
  wire::FrameDescriptor made;
  made.mutable_settings()->set_azimuth_bins(n_azimuth);
  made.mutable_settings()->set_range_bins(n_range);
  return made;
}

}  // namespace obliq::net
