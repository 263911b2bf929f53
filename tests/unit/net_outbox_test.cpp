// The bounded queue in front of one client.
#include <gtest/gtest.h>

#include "proto/obliq.pb.h"
#include "server/net/outbox.h"

namespace obliq::net {
namespace {

using wire::MessageType;
using wire::Plane;

constexpr std::uint32_t kStream = 1;
constexpr std::size_t kPlenty = 1u << 20;

BlockPtr block(MessageType type, std::uint64_t frame, std::uint64_t sequence,
               wire::PlaneSet planes = wire::kAllPlanes, std::uint32_t stream = kStream) {
  auto made = std::make_shared<Block>();
  made->type = type;
  made->frame_id = frame;
  made->sequence = sequence;
  made->planes = planes;
  made->stream_id = stream;
  made->bytes.resize(100);
  return made;
}

/// Begin, two wedges, end: sequence numbers 10 f + 1 to 10 f + 4.
void push_frame(Outbox& outbox, std::uint64_t frame, std::uint32_t stream = kStream) {
  outbox.push(block(MessageType::frame_begin, frame, frame * 10 + 1, wire::kAllPlanes, stream));
  outbox.push(block(MessageType::wedge_block, frame, frame * 10 + 2, wire::kAllPlanes, stream));
  outbox.push(block(MessageType::wedge_block, frame, frame * 10 + 3, wire::kAllPlanes, stream));
  outbox.push(block(MessageType::frame_end, frame, frame * 10 + 4, wire::kAllPlanes, stream));
}

std::vector<std::uint64_t> drain(Outbox& outbox) {
  std::vector<std::uint64_t> sequences;
  while (const BlockPtr next = outbox.pop()) sequences.push_back(next->sequence);
  return sequences;
}

/// The next message, which the outbox made itself.
wire::FrameAbort pop_abort(Outbox& outbox) {
  wire::FrameAbort abort;
  const BlockPtr next = outbox.pop();
  wire::MessageView view;
  if (!next || wire::decode_message(next->bytes, 1u << 20, view) != wire::MessageStatus::ok ||
      view.header.type != MessageType::frame_abort || !wire::parse_descriptor(view.descriptor, abort)) {
    ADD_FAILURE() << "the next message is no FrameAbort";
  }
  return abort;
}

TEST(Outbox, HandsOutAFrameInOrder) {
  Outbox outbox(2, kPlenty);
  outbox.open_live_lane(kStream, wire::kAllPlanes);
  push_frame(outbox, 1);
  EXPECT_EQ(outbox.queued_bytes(), 400u);
  EXPECT_EQ(drain(outbox), (std::vector<std::uint64_t>{11, 12, 13, 14}));
  EXPECT_EQ(outbox.queued_bytes(), 0u);
}

TEST(Outbox, BetweenFramesTheNewestWins) {
  Outbox outbox(2, kPlenty);
  outbox.open_live_lane(kStream, wire::kAllPlanes);
  for (std::uint64_t frame = 1; frame <= 50; ++frame) push_frame(outbox, frame);
  EXPECT_EQ(outbox.queued_bytes(), 800u) << "two frames are held, however many came";
  EXPECT_EQ(drain(outbox), (std::vector<std::uint64_t>{491, 492, 493, 494, 501, 502, 503, 504}));
  EXPECT_EQ(outbox.frames_dropped(), 48u);
}

TEST(Outbox, ABegunFrameIsCompletedBeforeANewerOne) {
  Outbox outbox(2, kPlenty);
  outbox.open_live_lane(kStream, wire::kAllPlanes);
  push_frame(outbox, 1);
  EXPECT_EQ(outbox.pop()->sequence, 11u);
  push_frame(outbox, 2);
  push_frame(outbox, 3);
  EXPECT_EQ(drain(outbox), (std::vector<std::uint64_t>{12, 13, 14, 31, 32, 33, 34}));
}

TEST(Outbox, WaitsForTheRestOfABegunFrame) {
  Outbox outbox(2, kPlenty);
  outbox.open_live_lane(kStream, wire::kAllPlanes);
  outbox.push(block(MessageType::frame_begin, 1, 11));
  EXPECT_EQ(outbox.pop()->sequence, 11u);
  EXPECT_EQ(outbox.pop(), nullptr);
  outbox.push(block(MessageType::wedge_block, 1, 12));
  EXPECT_EQ(outbox.pop()->sequence, 12u);
}

TEST(Outbox, ABegunFrameBeyondTheByteLimitIsAborted) {
  Outbox outbox(2, 250);
  outbox.open_live_lane(kStream, wire::kAllPlanes);
  outbox.push(block(MessageType::frame_begin, 1, 11));
  EXPECT_EQ(outbox.pop()->sequence, 11u);
  outbox.push(block(MessageType::wedge_block, 1, 12));
  outbox.push(block(MessageType::wedge_block, 1, 13));
  outbox.push(block(MessageType::wedge_block, 1, 14));
  outbox.push(block(MessageType::frame_end, 1, 15));
  EXPECT_EQ(pop_abort(outbox).frame_id(), 1u);
  EXPECT_EQ(outbox.pop(), nullptr) << "nothing of an aborted frame follows";
  push_frame(outbox, 2);
  EXPECT_EQ(outbox.pop(), nullptr) << "a frame that does not fit is not begun";
}

TEST(Outbox, PlanesThatWereNotAskedForAreLeftOut) {
  Outbox outbox(2, kPlenty);
  outbox.open_live_lane(kStream, wire::plane_bit(Plane::power));
  outbox.push(block(MessageType::frame_begin, 1, 11));
  outbox.push(block(MessageType::wedge_block, 1, 12, wire::plane_bit(Plane::iq)));
  outbox.push(block(MessageType::wedge_block, 1, 13, wire::plane_bit(Plane::power)));
  outbox.push(block(MessageType::frame_end, 1, 14));
  EXPECT_EQ(drain(outbox), (std::vector<std::uint64_t>{11, 13, 14}));
}

TEST(Outbox, AFrameWithoutAPlaneAskedForIsNotBegun) {
  Outbox outbox(2, kPlenty);
  outbox.open_live_lane(kStream, wire::kAllPlanes);
  outbox.push(block(MessageType::frame_begin, 1, 11, wire::plane_bit(Plane::iq)));
  outbox.push(block(MessageType::wedge_block, 1, 12, wire::plane_bit(Plane::iq)));
  EXPECT_EQ(outbox.pop(), nullptr);
}

TEST(Outbox, ClosingALaneAbortsTheBegunFrameAndForgetsTheRest) {
  Outbox outbox(2, kPlenty);
  outbox.open_live_lane(kStream, wire::kAllPlanes);
  push_frame(outbox, 1);
  EXPECT_EQ(outbox.pop()->sequence, 11u);
  push_frame(outbox, 2);
  outbox.close_lane(kStream, "because");
  const wire::FrameAbort abort = pop_abort(outbox);
  EXPECT_EQ(abort.frame_id(), 1u);
  EXPECT_EQ(abort.reason(), "because");
  EXPECT_EQ(outbox.pop(), nullptr);
  EXPECT_EQ(outbox.queued_bytes(), 0u);
  push_frame(outbox, 3);
  EXPECT_EQ(outbox.pop(), nullptr);
}

TEST(Outbox, AFrameAbortedBeforeItWasBegunIsNeverMentioned) {
  Outbox outbox(2, kPlenty);
  outbox.open_live_lane(kStream, wire::kAllPlanes);
  outbox.push(block(MessageType::frame_begin, 1, 11));
  outbox.push(block(MessageType::frame_abort, 1, 12));
  EXPECT_EQ(outbox.pop(), nullptr);
}

TEST(Outbox, ControlMessagesOvertakeFramesAndStreamsTakeTurns) {
  Outbox outbox(2, kPlenty);
  outbox.open_live_lane(1, wire::kAllPlanes);
  outbox.open_live_lane(2, wire::kAllPlanes);
  push_frame(outbox, 1, 1);
  push_frame(outbox, 2, 2);
  outbox.push_control({});
  EXPECT_EQ(drain(outbox), (std::vector<std::uint64_t>{0, 11, 21, 12, 22, 13, 23, 14, 24}));
}

TEST(Outbox, ARenderOnceLaneKeepsEverythingCountsItsBytesAndVanishes) {
  Outbox outbox(1, 100);
  const auto counter = std::make_shared<std::atomic<std::size_t>>(400);  // as its producer has counted
  outbox.open_once_lane(kStream, 77, counter);
  push_frame(outbox, 0);
  EXPECT_EQ(drain(outbox), (std::vector<std::uint64_t>{1, 2, 3, 4}));
  EXPECT_EQ(counter->load(), 0u);
  EXPECT_FALSE(outbox.has_lane(kStream));
}

TEST(Outbox, GivesItsBytesBackWhenItGoes) {
  const auto counter = std::make_shared<std::atomic<std::size_t>>(400);
  {
    Outbox outbox(1, 100);
    outbox.open_once_lane(kStream, 77, counter);
    push_frame(outbox, 0);
  }
  EXPECT_EQ(counter->load(), 0u);
}

}  // namespace
}  // namespace obliq::net
