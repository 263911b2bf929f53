// The bounded queue in front of one client.
#include "server/stream/outbox.h"

#include <gtest/gtest.h>

#include "proto/obliq.pb.h"

namespace obliq::net::outbox_test {
namespace {

using wire::MessageType;
using wire::Plane;

constexpr std::uint32_t kStream = 1;
constexpr std::size_t kPlenty = 1u << 20;

std::shared_ptr<stream::Block> block(MessageType type, std::uint64_t frame, std::uint64_t sequence,
                                     wire::PlaneSet planes = wire::kAllPlanes,
                                     std::uint32_t stream = kStream) {
  auto made = std::make_shared<stream::Block>();
  made->type = type;
  made->frame_id = frame;
  made->sequence = sequence;
  made->planes = planes;
  made->stream_id = stream;
  made->bytes.resize(100);
  return made;
}

/// Begin, two wedges, end: sequence numbers 10 f + 1 to 10 f + 4.
void push_frame(stream::Outbox& outbox, std::uint64_t frame, std::uint32_t stream = kStream) {
  outbox.push(block(MessageType::frame_begin, frame, frame * 10 + 1, wire::kAllPlanes, stream));
  outbox.push(block(MessageType::wedge_block, frame, frame * 10 + 2, wire::kAllPlanes, stream));
  outbox.push(block(MessageType::wedge_block, frame, frame * 10 + 3, wire::kAllPlanes, stream));
  outbox.push(block(MessageType::frame_end, frame, frame * 10 + 4, wire::kAllPlanes, stream));
}

std::vector<std::uint64_t> drain(stream::Outbox& outbox) {
  std::vector<std::uint64_t> sequences;
  while (const stream::BlockPtr next = outbox.pop()) sequences.push_back(next->sequence);
  return sequences;
}

/// The next message, which is of that type.
template <typename Message>
Message pop_message(stream::Outbox& outbox, MessageType type) {
  Message message;
  const stream::BlockPtr next = outbox.pop();
  wire::MessageView view;
  if (!next || wire::decode_message(next->bytes, 1u << 20, view) != wire::MessageStatus::ok ||
      view.header.type != type || !wire::parse_descriptor(view.descriptor, message)) {
    ADD_FAILURE() << "the next message is another";
  }
  return message;
}
wire::FrameAbort pop_abort(stream::Outbox& outbox) {
  return pop_message<wire::FrameAbort>(outbox, MessageType::frame_abort);
}
wire::FrameBegin pop_begin(stream::Outbox& outbox) {
  return pop_message<wire::FrameBegin>(outbox, MessageType::frame_begin);
}

stream::BlockPtr encoded_begin(std::uint64_t frame, std::uint64_t skipped_by_the_radar) {
  wire::FrameBegin begin;
  begin.set_frame_id(frame);
  begin.set_frames_skipped(skipped_by_the_radar);
  auto made = block(MessageType::frame_begin, frame, frame * 10 + 1);
  made->bytes = wire::encode_message(made->type, {kStream, made->sequence, 5}, begin);
  return made;
}

/// One live queue.
class LiveOutbox : public testing::Test {
 protected:
  LiveOutbox() { outbox.open_live_queue(kStream, {}); }
  stream::Outbox outbox{2, kPlenty};
};

TEST_F(LiveOutbox, HandsOutAFrameInOrder) {
  push_frame(outbox, 1);
  EXPECT_EQ(outbox.queued_bytes(), 400u);
  EXPECT_EQ(drain(outbox), (std::vector<std::uint64_t>{11, 12, 13, 14}));
  EXPECT_EQ(outbox.queued_bytes(), 0u);
}

TEST_F(LiveOutbox, BetweenFramesTheNewestWins) {
  for (std::uint64_t frame = 1; frame <= 50; ++frame) push_frame(outbox, frame);
  EXPECT_EQ(outbox.queued_bytes(), 800u) << "two frames are held, however many came";
  EXPECT_EQ(drain(outbox), (std::vector<std::uint64_t>{491, 492, 493, 494, 501, 502, 503, 504}));
  EXPECT_EQ(outbox.frames_dropped(), 48u);
}

TEST_F(LiveOutbox, ABegunFrameIsCompletedBeforeANewerOne) {
  push_frame(outbox, 1);
  EXPECT_EQ(outbox.pop()->sequence, 11u);
  push_frame(outbox, 2);
  push_frame(outbox, 3);
  EXPECT_EQ(drain(outbox), (std::vector<std::uint64_t>{12, 13, 14, 31, 32, 33, 34}));
}

TEST_F(LiveOutbox, WaitsForTheRestOfABegunFrame) {
  outbox.push(block(MessageType::frame_begin, 1, 11));
  EXPECT_EQ(outbox.pop()->sequence, 11u);
  EXPECT_EQ(outbox.pop(), nullptr);
  outbox.push(block(MessageType::wedge_block, 1, 12));
  EXPECT_EQ(outbox.pop()->sequence, 12u);
}

TEST(Outbox, ABegunFrameBeyondTheByteLimitIsAborted) {
  stream::Outbox outbox(2, 250);
  outbox.open_live_queue(kStream, {});
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
  stream::Outbox outbox(2, kPlenty);
  outbox.open_live_queue(kStream, {.planes = wire::plane_bit(Plane::power)});
  outbox.push(block(MessageType::frame_begin, 1, 11));
  outbox.push(block(MessageType::wedge_block, 1, 12, wire::plane_bit(Plane::iq)));
  outbox.push(block(MessageType::wedge_block, 1, 13, wire::plane_bit(Plane::power)));
  outbox.push(block(MessageType::frame_end, 1, 14));
  EXPECT_EQ(drain(outbox), (std::vector<std::uint64_t>{11, 13, 14}));
}

TEST_F(LiveOutbox, AFrameWithoutAPlaneAskedForIsNotBegun) {
  outbox.push(block(MessageType::frame_begin, 1, 11, wire::plane_bit(Plane::iq)));
  outbox.push(block(MessageType::wedge_block, 1, 12, wire::plane_bit(Plane::iq)));
  EXPECT_EQ(outbox.pop(), nullptr);
}

TEST_F(LiveOutbox, ClosingAQueueAbortsTheBegunFrameAndForgetsTheRest) {
  push_frame(outbox, 1);
  EXPECT_EQ(outbox.pop()->sequence, 11u);
  push_frame(outbox, 2);
  outbox.close_queue(kStream, "because");
  const wire::FrameAbort abort = pop_abort(outbox);
  EXPECT_EQ(abort.frame_id(), 1u);
  EXPECT_EQ(abort.reason(), "because");
  EXPECT_EQ(outbox.pop(), nullptr);
  EXPECT_EQ(outbox.queued_bytes(), 0u);
  push_frame(outbox, 3);
  EXPECT_EQ(outbox.pop(), nullptr);
}

TEST_F(LiveOutbox, AFrameAbortedBeforeItWasBegunIsNeverMentioned) {
  outbox.push(block(MessageType::frame_begin, 1, 11));
  outbox.push(block(MessageType::frame_abort, 1, 12));
  EXPECT_EQ(outbox.pop(), nullptr);
}

TEST(Outbox, ControlMessagesOvertakeFramesAndStreamsTakeTurns) {
  stream::Outbox outbox(2, kPlenty);
  outbox.open_live_queue(1, {});
  outbox.open_live_queue(2, {});
  push_frame(outbox, 1, 1);
  push_frame(outbox, 2, 2);
  outbox.push_control(std::make_shared<stream::Block>());
  EXPECT_EQ(drain(outbox), (std::vector<std::uint64_t>{0, 11, 21, 12, 22, 13, 23, 14, 24}));
}

TEST(Outbox, ARenderOnceQueueKeepsEverythingCountsItsBytesAndVanishes) {
  stream::Outbox outbox(1, 100);
  const auto counter = std::make_shared<std::atomic<std::size_t>>(400);  // as its producer has counted
  outbox.open_once_queue(kStream, 77, {}, counter);
  push_frame(outbox, 0);
  EXPECT_EQ(drain(outbox), (std::vector<std::uint64_t>{1, 2, 3, 4}));
  EXPECT_EQ(counter->load(), 0u);
  EXPECT_FALSE(outbox.has_queue(kStream));
}

TEST(Outbox, BothFormsOfAMessageCountAsMemory) {
  const auto with_json = [](MessageType type, std::uint64_t sequence) {
    auto made = block(type, 1, sequence);
    made->json_head.assign(50, ' ');
    return made;
  };
  const auto counter = std::make_shared<std::atomic<std::size_t>>(150);
  stream::Outbox once(1, kPlenty);
  once.open_once_queue(kStream, 77, {}, counter);
  once.push(with_json(MessageType::frame_begin, 11));
  EXPECT_EQ(once.queued_bytes(), 150u);
  EXPECT_EQ(once.pop()->sequence, 11u);
  EXPECT_EQ(counter->load(), 0u);
  stream::Outbox live(2, 299);  // two messages without JSON fit
  live.open_live_queue(kStream, {});
  live.push(with_json(MessageType::frame_begin, 11));
  live.push(with_json(MessageType::wedge_block, 12));
  EXPECT_EQ(live.frames_dropped(), 1u);
}

TEST(Outbox, ABrowsersOwnMessagesAreJson) {
  stream::Outbox outbox(2, kPlenty);
  outbox.open_live_queue(kStream, {.as_json = true});
  outbox.push(encoded_begin(1, 0));
  outbox.push(encoded_begin(2, 0));
  outbox.push(encoded_begin(3, 0));  // 1 gives way
  const stream::BlockPtr begin = outbox.pop();
  EXPECT_TRUE(begin->bytes.empty());
  EXPECT_EQ(begin->json_head.substr(wire::kHeaderBytes), R"({"frame_id":"2","frames_skipped":"1"})");
  outbox.close_queue(kStream, "because");
  const stream::BlockPtr abort = outbox.pop();
  EXPECT_TRUE(abort->bytes.empty());
  EXPECT_EQ(abort->json_head.substr(wire::kHeaderBytes), R"({"frame_id":"2","reason":"because"})");
}

TEST_F(LiveOutbox, FramesThatWereAskedForOnceComeOneAfterTheOtherAndTakeTurnsWithStreams) {
  for (const std::uint32_t stream : {2u, 3u})
    outbox.open_once_queue(stream, stream, {}, std::make_shared<std::atomic<std::size_t>>(0));
  push_frame(outbox, 3, 3);  // before the older one has a block
  EXPECT_TRUE(drain(outbox).empty());
  push_frame(outbox, 2, 2);
  push_frame(outbox, 1);
  EXPECT_EQ(drain(outbox), (std::vector<std::uint64_t>{11, 21, 12, 22, 13, 23, 14, 24, 31, 32, 33, 34}));
}

TEST(Outbox, GivesItsBytesBackWhenItGoes) {
  const auto counter = std::make_shared<std::atomic<std::size_t>>(400);
  {
    stream::Outbox outbox(1, 100);
    outbox.open_once_queue(kStream, 77, {}, counter);
    push_frame(outbox, 0);
  }
  EXPECT_EQ(counter->load(), 0u);
}

TEST(Outbox, ALosslessQueueKeepsEveryFrameWhateverItsBytes) {
  stream::Outbox outbox(2, 100);
  outbox.open_live_queue(kStream, {}, stream::QueuePolicy::lossless);
  for (std::uint64_t frame = 1; frame <= 5; ++frame) push_frame(outbox, frame);
  EXPECT_EQ(drain(outbox).size(), 20u);
  EXPECT_EQ(outbox.frames_dropped(), 0u);
}

TEST_F(LiveOutbox, SkippedFramesAreCountedInTheNextFrameBeginOnce) {
  outbox.push(encoded_begin(1, 0));
  EXPECT_EQ(pop_begin(outbox).frames_skipped(), 0u);
  for (std::uint64_t frame = 2; frame <= 6; ++frame) outbox.push(encoded_begin(frame, frame == 6 ? 10 : 0));
  outbox.push(block(MessageType::frame_end, 1, 14));
  EXPECT_EQ(outbox.pop()->sequence, 14u);
  const wire::FrameBegin begin = pop_begin(outbox);
  EXPECT_EQ(begin.frame_id(), 6u);
  EXPECT_EQ(begin.frames_skipped(), 14u) << "2, 3, 4 and 5 gave way here; 10 the radar left out";
  outbox.push(block(MessageType::frame_end, 6, 64));
  EXPECT_EQ(outbox.pop()->sequence, 64u);
  outbox.push(encoded_begin(7, 0));
  EXPECT_EQ(pop_begin(outbox).frames_skipped(), 0u);
}

TEST(Outbox, AFrameGivenUpIsAbortedIfBegunAndSkippedIfNot) {
  stream::Outbox outbox(3, kPlenty);
  outbox.open_live_queue(kStream, {});
  outbox.push(encoded_begin(1, 0));
  EXPECT_EQ(pop_begin(outbox).frame_id(), 1u);
  outbox.push(encoded_begin(2, 0));
  outbox.push(encoded_begin(3, 0));
  outbox.give_up(kStream, 2, "slow");
  outbox.give_up(kStream, 1, "slow");
  outbox.give_up(kStream, 99, "not held: not minded");
  EXPECT_EQ(pop_abort(outbox).frame_id(), 1u);
  const wire::FrameBegin begin = pop_begin(outbox);
  EXPECT_EQ(begin.frame_id(), 3u);
  EXPECT_EQ(begin.frames_skipped(), 1u) << "the aborted one was told of already";
}

TEST_F(LiveOutbox, AFrameIsAliveUntilItsLastBlockIsTaken) {
  int freed = 0;
  const auto frames = std::make_shared<stream::LiveFrames>([&] { ++freed; });
  {
    const stream::LiveFramePtr frame = frames->open(1, {});
    outbox.push(block(MessageType::frame_begin, 1, 11), frame);
    outbox.push(block(MessageType::wedge_block, 1, 12), frame);
    outbox.push(block(MessageType::frame_end, 1, 13), frame);
  }
  for (int taken = 0; taken < 3; ++taken) {
    EXPECT_EQ(frames->live(), 1) << taken;
    outbox.pop();
  }
  EXPECT_EQ(frames->live(), 0);
  EXPECT_EQ(freed, 1);
}

TEST(Outbox, TakesOnlyBlocksOfItsOwnEncodingAndWindow) {
  stream::Outbox outbox(2, kPlenty);
  stream::StreamChoice choice;
  choice.format.iq = wire::IqEncoding::ci16_le;
  choice.format.window.range = {4, 8, 2};
  outbox.open_live_queue(kStream, choice);
  const auto push = [&](MessageType type, Plane plane, const stream::BlockFormat& format,
                        std::uint64_t sequence) {
    auto made = std::make_shared<stream::Block>();
    made->type = type;
    made->frame_id = 1;
    made->sequence = sequence;
    made->planes = type == MessageType::frame_begin ? wire::kAllPlanes : wire::plane_bit(plane);
    made->stream_id = kStream;
    made->format = format;
    outbox.push(made);
  };
  stream::BlockFormat floats = choice.format;
  floats.iq = wire::IqEncoding::cf32_le;
  stream::BlockFormat whole = choice.format;
  whole.window = {};
  stream::BlockFormat compressed = choice.format;
  compressed.compression = wire::Compression::zstd;
  push(MessageType::frame_begin, Plane::iq, whole, 10);
  push(MessageType::frame_begin, Plane::iq, floats, 11);  // of a FrameBegin the window alone counts
  push(MessageType::wedge_block, Plane::iq, floats, 12);
  push(MessageType::wedge_block, Plane::iq, choice.format, 13);
  push(MessageType::wedge_block, Plane::iq, whole, 14);
  push(MessageType::wedge_block, Plane::power, floats, 15);  // has no encoding of its own
  push(MessageType::wedge_block, Plane::power, compressed, 16);
  EXPECT_EQ(drain(outbox), (std::vector<std::uint64_t>{11, 13, 15}));
}

}  // namespace
}  // namespace obliq::net::outbox_test
