// The server's encoder against the client's assembler: two halves written apart, one format.
#include <gtest/gtest.h>

#include "proto/json_text.h"
#include "proto/obliq.pb.h"
#include "tests/support/same_bits.h"
#include "tests/unit/encoder_fixture.h"

namespace obliq::net {
namespace {

using client::FrameAssembler;
using wire::MessageType;

struct Stream {
  std::uint64_t sequence = 0;
  FrameEncoder encoder{{.stream_id = 9, .frame_id = 4, .request_id = 3}, sequence};
};

TEST(FrameEncoder, WedgesInAnyOrderMakeTheWholeFrame) {
  Stream stream;
  FrameAssembler frames;
  ASSERT_TRUE(feed(frames, *stream.encoder.begin(descriptor(20, 32)).front()).ok());
  for (const int wedge : {2, 0, 1}) {
    for (const BlockPtr& block : stream.encoder.wedge(wedge, filled(wedge * 8, wedge == 2 ? 4 : 8, 32))) {
      const client::Status status = feed(frames, *block);
      ASSERT_TRUE(status.ok()) << status.sentence();
    }
  }
  ASSERT_TRUE(feed(frames, *stream.encoder.end({}, 0)).ok());
  EXPECT_EQ(frames.frame().request_id, 3u);
  test::expect_same_bits(frames.frame(), filled(0, 20, 32));
}

TEST(FrameEncoder, ALargeWedgeTakesSeveralBlocksWithinTheLimit) {
  // 3 rows of 100,000 bins: one row of iq is 0.8 MB, two are more than a block. And 200,000 bins, where one
  // row is more than a block.
  for (const int n_range : {100000, 200000}) {
    Stream stream;
    FrameAssembler frames;
    ASSERT_TRUE(feed(frames, *stream.encoder.begin(descriptor(3, n_range)).front()).ok());
    std::uint64_t sequence = 1;
    for (const BlockPtr& block : stream.encoder.wedge(0, filled(0, 3, n_range))) {
      EXPECT_EQ(block->sequence, ++sequence);
      const client::Status status = feed(frames, *block);
      ASSERT_TRUE(status.ok()) << status.sentence();
    }
    EXPECT_GE(sequence, 7u) << "no plane but the state fits one block";
    ASSERT_TRUE(feed(frames, *stream.encoder.end({}, 0)).ok());
    test::expect_same_bits(frames.frame(), filled(0, 3, n_range));
  }
}

/// What a browser must be sent before the plane of a message that all others have as `bytes`.
template <typename Descriptor>
std::string head_of(const wire::Bytes& bytes) {
  wire::MessageView view;
  Descriptor descriptor;
  EXPECT_EQ(wire::decode_message(bytes, wire::kMaxPayloadBytes, view), wire::MessageStatus::ok);
  EXPECT_TRUE(wire::parse_descriptor(view.descriptor, descriptor));
  const wire::MessageHeader& header = view.header;
  return wire::json_head(header.type, {header.stream_id, header.sequence, header.utc_ns}, descriptor,
                         view.plane.size());
}

TEST(FrameEncoder, BrowsersShareOneJsonOfAMessageAndWhatNoneWatchesHasNone) {
  const auto meter = std::make_shared<BlockMeter>();
  const StreamChoice power{.planes = wire::plane_bit(wire::Plane::power)};
  const StreamChoice state{.planes = wire::plane_bit(wire::Plane::state), .as_json = true};
  const StreamChoice both{.planes = wire::kAllPlanes};
  StreamChoice part = state;
  part.format.window.range = {4, 8, 1};
  std::uint64_t sequence = 0;
  FrameEncoder encoder({.stream_id = 9, .frame_id = 4, .choices = {power, state, both, part}, .meter = meter},
                       sequence);
  std::vector<BlockPtr> blocks = encoder.begin(descriptor(8, 32));
  ASSERT_EQ(blocks.size(), 2u) << "two windows";
  for (const BlockPtr& begin : blocks) EXPECT_EQ(begin->json_head, head_of<wire::FrameBegin>(begin->bytes));
  int as_json = 0;
  for (const BlockPtr& block : encoder.wedge(0, filled(0, 8, 32))) {
    const bool watched = block->planes == state.planes;
    EXPECT_EQ(block->json_head, watched ? head_of<wire::WedgeBlock>(block->bytes) : "");
    EXPECT_TRUE(std::ranges::equal(block->plane(), std::span(block->bytes).last(block->plane_bytes)));
    if (watched) ++as_json;
    blocks.push_back(block);
  }
  EXPECT_EQ(as_json, 2) << "one for all who watch the states, one for the window";
  blocks.push_back(encoder.end({}, 0));
  EXPECT_EQ(blocks.back()->json_head, head_of<wire::FrameEnd>(blocks.back()->bytes));
  std::size_t bytes = 0;
  for (const BlockPtr& block : blocks) bytes += block->bytes.size() + block->json_head.size();
  EXPECT_EQ(meter->bytes, bytes);
  blocks.clear();
  EXPECT_EQ(meter->bytes, 0u);
}

TEST(FrameEncoder, WithoutABrowserThereIsNoJson) {
  Stream stream;
  EXPECT_EQ(stream.encoder.begin(descriptor(8, 32)).front()->json_head, "");
  for (const BlockPtr& block : stream.encoder.wedge(0, filled(0, 8, 32))) EXPECT_EQ(block->json_head, "");
  EXPECT_EQ(stream.encoder.end({}, 0)->json_head, "");
  EXPECT_EQ(stream.encoder.abort("because")->json_head, "");
}

TEST(FrameAssembler, NoticesAMissingBlock) {
  Stream stream;
  FrameAssembler frames;
  ASSERT_TRUE(feed(frames, *stream.encoder.begin(descriptor(8, 32)).front()).ok());
  const auto blocks = stream.encoder.wedge(0, filled(0, 8, 32));
  for (std::size_t i = 1; i < blocks.size(); ++i) ASSERT_TRUE(feed(frames, *blocks[i]).ok());
  EXPECT_EQ(feed(frames, *stream.encoder.end({}, 0)).outcome, client::Outcome::bad_stream);
}

TEST(FrameAssembler, NoticesABlockThatComesTwiceOrLiesOutside) {
  Stream stream;
  FrameAssembler frames;
  ASSERT_TRUE(feed(frames, *stream.encoder.begin(descriptor(8, 32)).front()).ok());
  const auto blocks = stream.encoder.wedge(0, filled(0, 8, 32));
  ASSERT_TRUE(feed(frames, *blocks[0]).ok());
  EXPECT_EQ(feed(frames, *blocks[0]).outcome, client::Outcome::bad_stream);
  Stream longer;
  (void)longer.encoder.begin(descriptor(16, 32));
  EXPECT_EQ(feed(frames, *longer.encoder.wedge(1, filled(8, 8, 32))[0]).outcome, client::Outcome::bad_stream);
  Stream wider;
  (void)wider.encoder.begin(descriptor(8, 33));
  EXPECT_EQ(feed(frames, *wider.encoder.wedge(0, filled(0, 8, 33))[1]).outcome, client::Outcome::bad_stream);
}

TEST(FrameAssembler, RefusesFramesThatCannotBe) {
  for (const auto& [n_azimuth, n_range] :
       {std::pair{0, 32}, {8, -1}, {1 << 30, 1 << 30}, {1 << 24, 1 << 24}}) {
    Stream stream;
    FrameAssembler frames;
    EXPECT_EQ(feed(frames, *stream.encoder.begin(descriptor(n_azimuth, n_range)).front()).outcome,
              client::Outcome::bad_stream);
  }
}

TEST(FrameAssembler, AnAbortedFrameGivesWayToTheNext) {
  Stream stream;
  FrameAssembler frames;
  ASSERT_TRUE(feed(frames, *stream.encoder.begin(descriptor(8, 32)).front()).ok());
  ASSERT_TRUE(feed(frames, *stream.encoder.abort("because")).ok());
  EXPECT_EQ(frames.state(), FrameAssembler::State::aborted);
  EXPECT_EQ(frames.abort_reason(), "because");
  ASSERT_TRUE(feed(frames, *stream.encoder.begin(descriptor(8, 32)).front()).ok());
  for (const BlockPtr& block : stream.encoder.wedge(0, filled(0, 8, 32)))
    ASSERT_TRUE(feed(frames, *block).ok());
  EXPECT_TRUE(feed(frames, *stream.encoder.end({}, 0)).ok());
}

}  // namespace
}  // namespace obliq::net
