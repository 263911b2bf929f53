// The server's encoder against the client's assembler: two halves written apart, one format.
#include <gtest/gtest.h>

#include "client/frame_assembler.h"
#include "proto/limits.h"
#include "proto/obliq.pb.h"
#include "server/net/frame_encoder.h"

namespace obliq::net {
namespace {

using client::FrameAssembler;
using wire::MessageType;

/// Decodes a block as a client does and hands it on.
client::Status feed(FrameAssembler& frames, const Block& block) {
  wire::MessageView view;
  if (wire::decode_message(block.bytes, wire::kMaxPayloadBytes, view) != wire::MessageStatus::ok) {
    return client::Status::failure(client::Outcome::bad_stream, "does not decode");
  }
  const auto parsed = [&](auto message) {
    EXPECT_TRUE(wire::parse_descriptor(view.descriptor, message));
    return message;
  };
  switch (view.header.type) {
    case MessageType::frame_begin:
      return frames.on_begin(view.header, parsed(wire::FrameBegin()));
    case MessageType::wedge_block:
      return frames.on_block(view.header, parsed(wire::WedgeBlock()), view.plane);
    case MessageType::frame_end:
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

struct Stream {
  std::uint64_t sequence = 0;
  FrameEncoder encoder{{.stream_id = 9, .frame_id = 4, .request_id = 3}, sequence};
};

void expect_same(const client::AssembledFrame& frame, const BinBlock& whole) {
  EXPECT_EQ(frame.iq, whole.iq);
  EXPECT_EQ(frame.power_w, whole.power_w);
  EXPECT_EQ(frame.count, whole.count);
  EXPECT_EQ(frame.state, whole.state);
}

TEST(FrameEncoder, WedgesInAnyOrderMakeTheWholeFrame) {
  Stream stream;
  FrameAssembler frames;
  ASSERT_TRUE(feed(frames, *stream.encoder.begin(descriptor(20, 32), 3)).ok());
  for (const int wedge : {2, 0, 1}) {
    for (const BlockPtr& block : stream.encoder.wedge(wedge, filled(wedge * 8, wedge == 2 ? 4 : 8, 32))) {
      const client::Status status = feed(frames, *block);
      ASSERT_TRUE(status.ok()) << status.sentence();
    }
  }
  ASSERT_TRUE(feed(frames, *stream.encoder.end({}, 0)).ok());
  EXPECT_EQ(frames.frame().request_id, 3u);
  expect_same(frames.frame(), filled(0, 20, 32));
}

TEST(FrameEncoder, ALargeWedgeTakesSeveralBlocksWithinTheLimit) {
  // 3 rows of 100,000 bins: one row of iq is 0.8 MB, two are more than a block. And 200,000 bins, where one
  // row is more than a block.
  for (const int n_range : {100000, 200000}) {
    Stream stream;
    FrameAssembler frames;
    ASSERT_TRUE(feed(frames, *stream.encoder.begin(descriptor(3, n_range), 1)).ok());
    std::uint64_t sequence = 1;
    for (const BlockPtr& block : stream.encoder.wedge(0, filled(0, 3, n_range))) {
      EXPECT_EQ(block->sequence, ++sequence);
      const client::Status status = feed(frames, *block);
      ASSERT_TRUE(status.ok()) << status.sentence();
    }
    EXPECT_GE(sequence, 7u) << "no plane but the state fits one block";
    ASSERT_TRUE(feed(frames, *stream.encoder.end({}, 0)).ok());
    expect_same(frames.frame(), filled(0, 3, n_range));
  }
}

TEST(FrameAssembler, NoticesAMissingBlock) {
  Stream stream;
  FrameAssembler frames;
  ASSERT_TRUE(feed(frames, *stream.encoder.begin(descriptor(8, 32), 1)).ok());
  const auto blocks = stream.encoder.wedge(0, filled(0, 8, 32));
  for (std::size_t i = 1; i < blocks.size(); ++i) ASSERT_TRUE(feed(frames, *blocks[i]).ok());
  EXPECT_EQ(feed(frames, *stream.encoder.end({}, 0)).outcome, client::Outcome::bad_stream);
}

TEST(FrameAssembler, NoticesABlockThatComesTwiceOrLiesOutside) {
  Stream stream;
  FrameAssembler frames;
  ASSERT_TRUE(feed(frames, *stream.encoder.begin(descriptor(8, 32), 1)).ok());
  const auto blocks = stream.encoder.wedge(0, filled(0, 8, 32));
  ASSERT_TRUE(feed(frames, *blocks[0]).ok());
  EXPECT_EQ(feed(frames, *blocks[0]).outcome, client::Outcome::bad_stream);
  EXPECT_EQ(feed(frames, *stream.encoder.wedge(1, filled(8, 8, 32))[0]).outcome, client::Outcome::bad_stream);
  EXPECT_EQ(feed(frames, *stream.encoder.wedge(0, filled(0, 8, 33))[1]).outcome, client::Outcome::bad_stream);
}

TEST(FrameAssembler, RefusesFramesThatCannotBe) {
  for (const auto& [n_azimuth, n_range] :
       {std::pair{0, 32}, {8, -1}, {1 << 30, 1 << 30}, {1 << 24, 1 << 24}}) {
    Stream stream;
    FrameAssembler frames;
    EXPECT_EQ(feed(frames, *stream.encoder.begin(descriptor(n_azimuth, n_range), 1)).outcome,
              client::Outcome::bad_stream);
  }
}

TEST(FrameAssembler, AnAbortedFrameGivesWayToTheNext) {
  Stream stream;
  FrameAssembler frames;
  ASSERT_TRUE(feed(frames, *stream.encoder.begin(descriptor(8, 32), 1)).ok());
  ASSERT_TRUE(feed(frames, *stream.encoder.abort("because")).ok());
  EXPECT_EQ(frames.state(), FrameAssembler::State::aborted);
  EXPECT_EQ(frames.abort_reason(), "because");
  ASSERT_TRUE(feed(frames, *stream.encoder.begin(descriptor(8, 32), 1)).ok());
  for (const BlockPtr& block : stream.encoder.wedge(0, filled(0, 8, 32)))
    ASSERT_TRUE(feed(frames, *block).ok());
  EXPECT_TRUE(feed(frames, *stream.encoder.end({}, 0)).ok());
}

}  // namespace
}  // namespace obliq::net
