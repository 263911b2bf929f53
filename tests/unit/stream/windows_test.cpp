// Windows and encodings of a frame, from the server's encoder to the client's assembler.
// The server's encoder against the client's assembler: two halves written apart, one format.
#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "proto/json_text.h"
#include "proto/obliq.pb.h"
#include "server/stream/outbox.h"
#include "tests/integration/clients.h"
#include "tests/support/same_bits.h"
#include "tests/unit/stream/encoder_fixture.h"

namespace obliq::test::windows_test {
namespace {

using namespace net;
using client::FrameAssembler;
using wire::MessageType;

constexpr int kAzimuths = 20;
constexpr int kRanges = 32;

/// What a client with this choice makes of a frame that is encoded for all of these choices.
client::AssembledFrame received(const stream::StreamChoice& choice,
                                const std::vector<stream::StreamChoice>& all) {
  std::uint64_t sequence = 0;
  stream::FrameEncoder encoder({.stream_id = 9, .frame_id = 4, .choices = all}, sequence);
  std::vector<stream::BlockPtr> blocks = encoder.begin(descriptor(kAzimuths, kRanges));
  for (const int wedge : {1, 2, 0}) {
    for (stream::BlockPtr& block : encoder.wedge(wedge, filled(8 * wedge, wedge == 2 ? 4 : 8, kRanges)))
      blocks.push_back(std::move(block));
  }
  blocks.push_back(encoder.end({}, 0));

  stream::Outbox outbox(2, 1 << 30);
  outbox.open_live_queue(9, choice);
  for (const stream::BlockPtr& block : blocks) outbox.push(block);
  FrameAssembler frames(choice.planes);
  while (const stream::BlockPtr block = outbox.pop()) {
    EXPECT_TRUE(is_ok(feed(frames, *block)));
  }
  EXPECT_EQ(frames.state(), FrameAssembler::State::complete);
  return frames.take();
}

stream::StreamChoice choice_of(const wire::Window& window, wire::IqEncoding iq = wire::IqEncoding::cf32_le,
                               wire::Compression compression = wire::Compression::none) {
  return {wire::kAllPlanes, {iq, compression, 8, window}};
}

const std::vector<stream::StreamChoice> kChoices{
    choice_of({}),
    choice_of({}, wire::IqEncoding::ci16_le),
    choice_of({}, wire::IqEncoding::cf32_le, wire::Compression::zstd),
    choice_of({}, wire::IqEncoding::ci16_le, wire::Compression::zstd),
    choice_of({{5, 9, 1}, {3, 20, 1}}),
    choice_of({{5, 0, 3}, {3, 0, 5}}),
    choice_of({{0, 0, 1}, {31, 1, 1}}, wire::IqEncoding::ci16_le),
    choice_of({{19, 1, 19}, {0, 0, 32}}, wire::IqEncoding::cf32_le, wire::Compression::zstd),
    {wire::plane_bit(wire::Plane::count), {}},
};

/// Every bin of the window is the frame's own, wherever it lies; I&Q to within what ci16_le promises.
void expect_window(const client::AssembledFrame& frame, const stream::StreamChoice& choice) {
  const wire::Window window = *wire::cut_window(choice.format.window, kAzimuths, kRanges);
  const BinBlock whole = filled(0, kAzimuths, kRanges);
  // No component is above 31; a block's scale is at most that of its largest.
  const float iq_error = choice.format.iq == wire::IqEncoding::ci16_le ? 31.0f / 32767 / 2 * 1.001f : 0;
  ASSERT_EQ(frame.n_azimuth, static_cast<int>(window.azimuth.kept()));
  ASSERT_EQ(frame.n_range, static_cast<int>(window.range.kept()));
  std::size_t at = 0;
  for (std::uint64_t a = window.azimuth.first; a < window.azimuth.end(); a += window.azimuth.step) {
    for (std::uint64_t r = window.range.first; r < window.range.end(); r += window.range.step, ++at) {
      const auto from = static_cast<std::size_t>(a * kRanges + r);
      ASSERT_EQ(frame.count[at], whole.count[from]) << a << ", " << r;
      if (frame.iq.empty()) continue;
      ASSERT_EQ(frame.power_w[at], whole.power_w[from]);
      ASSERT_EQ(frame.state[at], whole.state[from]);
      ASSERT_LE(std::fabs(frame.iq[at].real() - whole.iq[from].real()), iq_error);
      ASSERT_LE(std::fabs(frame.iq[at].imag() - whole.iq[from].imag()), iq_error);
    }
  }
}

TEST(Windows, BringTheBinsAskedForInEveryEncoding) {
  for (const stream::StreamChoice& choice : kChoices) expect_window(received(choice, {choice}), choice);
}

TEST(Windows, ABlocksBitsDoNotDependOnWhoElseWatches) {
  for (const stream::StreamChoice& choice : kChoices) {
    const client::AssembledFrame alone = received(choice, {choice});
    const client::AssembledFrame among = received(choice, kChoices);
    EXPECT_EQ(alone.iq, among.iq);
    EXPECT_EQ(alone.power_w, among.power_w);
    EXPECT_EQ(alone.count, among.count);
    EXPECT_EQ(alone.state, among.state);
  }
}

TEST(Windows, TheDescriptorTellsTheWindowOnlyWhenItIsNotTheWholeFrame) {
  EXPECT_FALSE(received(kChoices[0], kChoices).descriptor->has_window());
  const auto frame = received(kChoices[5], kChoices);
  const wire::BinWindow& window = frame.descriptor->window();
  EXPECT_EQ(window.first_azimuth(), 5u);
  EXPECT_EQ(window.n_azimuth(), 15u) << "open counts are filled in";
  EXPECT_EQ(window.azimuth_step(), 3u);
  EXPECT_EQ(window.range_step(), 5u);
  EXPECT_EQ(frame.descriptor->settings().azimuth_bins(), kAzimuths) << "the whole frame's";
}

TEST(FrameEncoder, EncodesOnceWhatSeveralAskForAndNothingThatNobodyAsksFor) {
  const stream::StreamChoice iq_only{wire::plane_bit(wire::Plane::iq), {}};
  stream::StreamChoice iq_as_integers = iq_only;
  iq_as_integers.format.iq = wire::IqEncoding::ci16_le;
  stream::StreamChoice state_beside_integers = iq_as_integers;
  state_beside_integers.planes = wire::plane_bit(wire::Plane::state);
  stream::StreamChoice state{wire::plane_bit(wire::Plane::state), {}};
  std::uint64_t sequence = 0;
  stream::FrameEncoder encoder({.choices = {iq_only, iq_only, iq_as_integers, state_beside_integers, state}},
                               sequence);
  EXPECT_EQ(encoder.begin(descriptor(kAzimuths, kRanges)).size(), 1u) << "one window, one FrameBegin";
  EXPECT_EQ(encoder.wedge(0, filled(0, 8, kRanges)).size(), 3u) << "iq twice, state once";
}

TEST(FrameEncoder, CountsTheBytesOfItsBlocksForAsLongAsTheyLive) {
  const auto meter = std::make_shared<stream::BlockMeter>();
  std::uint64_t sequence = 0;
  stream::FrameEncoder encoder({.meter = meter}, sequence);
  {
    const auto begin = encoder.begin(descriptor(kAzimuths, kRanges));
    const auto blocks = encoder.wedge(0, filled(0, 8, kRanges));
    EXPECT_EQ(meter->blocks, 5u);
    EXPECT_GT(meter->bytes, 8u * 32 * 21);
  }
  EXPECT_EQ(meter->blocks, 0u);
  EXPECT_EQ(meter->bytes, 0u);
}

TEST(SpareMemory, OfABlockThatHasGoneIsThatOfTheNextOfItsLength) {
  stream::SpareMemory spare;
  wire::Bytes memory(100'000);
  const std::byte* const place = memory.data();
  spare.give(std::move(memory));
  EXPECT_EQ(spare.take(100'001).capacity(), 0u) << "too short";
  EXPECT_EQ(spare.take(50'000).capacity(), 0u) << "half of it would lie idle";
  EXPECT_EQ(spare.take(90'000).data(), place);
  EXPECT_EQ(spare.take(90'000).capacity(), 0u) << "it is taken";
}

TEST(SpareMemory, IsLimitedAndGoesBackWhereNoMoreIsToCome) {
  stream::SpareMemory spare;
  constexpr std::size_t kLength = 1 << 20;
  const auto kept = [&] {
    std::vector<wire::Bytes> taken;
    do taken.push_back(spare.take(kLength));
    while (taken.back().capacity() > 0);
    return taken.size() - 1;
  };
  for (int i = 0; i < 100; ++i) spare.give(wire::Bytes(kLength));
  EXPECT_EQ(kept(), stream::SpareMemory::kMostBytes / kLength);
  spare.give(wire::Bytes(kLength));
  spare.keep(false);
  EXPECT_EQ(kept(), 0u);
  spare.give(wire::Bytes(kLength));
  EXPECT_EQ(kept(), 0u);
  spare.keep(true);
  spare.give(wire::Bytes(kLength));
  EXPECT_EQ(kept(), 1u);
}

TEST(FrameAssembler, RefusesABlockOfAnotherStepOrBetweenTheSteps) {
  const stream::StreamChoice choice = choice_of({{2, 0, 3}, {0, 0, 1}});
  for (const auto& [first, step] : {std::pair{2u, 2u}, {3u, 3u}, {0u, 3u}, {20u, 3u}}) {
    std::uint64_t sequence = 0;
    stream::FrameEncoder encoder({.choices = {choice}}, sequence);
    FrameAssembler frames;
    ASSERT_TRUE(feed(frames, *encoder.begin(descriptor(kAzimuths, kRanges)).front()).ok());
    wire::WedgeBlock wrong;
    wrong.set_plane(wire::STATE);
    wrong.set_first_azimuth(first);
    wrong.set_azimuth_step(step);
    wrong.set_n_azimuth(1);
    wrong.set_n_range(kRanges);
    stream::Block block;
    block.bytes = wire::encode_message(MessageType::wedge_block, {}, wrong,
                                       std::vector<std::byte>(static_cast<std::size_t>(kRanges)));
    EXPECT_EQ(feed(frames, block).outcome, client::Outcome::bad_stream) << first << ", " << step;
  }
}

TEST(FrameAssembler, RefusesADamagedCompressedBlock) {
  const stream::StreamChoice choice = kChoices[2];
  std::uint64_t sequence = 0;
  stream::FrameEncoder encoder({.choices = {choice}}, sequence);
  FrameAssembler frames;
  ASSERT_TRUE(feed(frames, *encoder.begin(descriptor(kAzimuths, kRanges)).front()).ok());
  wire::WedgeBlock said;
  said.set_plane(wire::STATE);
  said.set_n_azimuth(8);
  said.set_n_range(kRanges);
  said.set_compression(wire::ZSTD);
  said.set_plain_bytes(8 * kRanges);
  stream::Block block;
  block.bytes =
      wire::encode_message(MessageType::wedge_block, {}, said, std::vector<std::byte>(100, std::byte{7}));
  const client::Status status = feed(frames, block);
  EXPECT_EQ(status.outcome, client::Outcome::bad_stream);
  EXPECT_NE(status.text.find("damaged"), std::string::npos) << status.text;
}

TEST(StreamChoice, ImpossibleWishesAreRefusedByFieldFoundAndAllowed) {
  wire::Subscribe request;
  request.add_planes(static_cast<wire::PlaneKind>(11));
  request.set_iq_encoding(static_cast<wire::IqEncodingKind>(5));
  request.set_compression(static_cast<wire::CompressionKind>(6));
  request.mutable_window()->set_first_azimuth(20);
  request.mutable_window()->set_first_range(30);
  request.mutable_window()->set_n_range(3);
  request.mutable_window()->set_azimuth_step(21);
  std::vector<FieldError> errors;
  (void)stream::read_choice(request, kAzimuths, kRanges, errors);
  std::vector<std::string> texts;
  for (const FieldError& error : errors)
    texts.push_back(error.field + "|" + error.found + "|" + error.allowed);
  EXPECT_EQ(texts,
            (std::vector<std::string>{
                "planes|11|0 (iq), 1 (power), 2 (count), 3 (state), 4 (video), 5 (pulses), 6 (material), 7 "
                "(building), 8 (height), "
                "9 (returns), 10 (target)",
                "iq_encoding|5|0 (cf32_le), 1 (ci16_le)",
                "compression|6|0 (none), 1 (zstd)",
                "window.first_azimuth|20|0 to 19: there are 20 bins",
                "window.azimuth_step|21|1 to 20",
                "window.n_range|3|0 (all that follow) to 2, from bin 30 of 32",
            }));
}

struct Stream {
  std::uint64_t sequence = 0;
  stream::FrameEncoder encoder{{.stream_id = 9, .frame_id = 4, .request_id = 3}, sequence};
  FrameAssembler frames;

  FrameAssembler& begun(int n_azimuth, int n_range) {
    EXPECT_TRUE(feed(frames, *encoder.begin(descriptor(n_azimuth, n_range)).front()).ok());
    return frames;
  }
};

TEST(FrameEncoder, WedgesInAnyOrderMakeTheWholeFrame) {
  Stream stream;
  FrameAssembler& frames = stream.begun(20, 32);
  for (const int wedge : {2, 0, 1}) {
    for (const stream::BlockPtr& block :
         stream.encoder.wedge(wedge, filled(wedge * 8, wedge == 2 ? 4 : 8, 32))) {
      ASSERT_TRUE(is_ok(feed(frames, *block)));
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
    FrameAssembler& frames = stream.begun(3, n_range);
    std::uint64_t sequence = 1;
    for (const stream::BlockPtr& block : stream.encoder.wedge(0, filled(0, 3, n_range))) {
      EXPECT_EQ(block->sequence, ++sequence);
      ASSERT_TRUE(is_ok(feed(frames, *block)));
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
  const auto meter = std::make_shared<stream::BlockMeter>();
  const stream::StreamChoice power{.planes = wire::plane_bit(wire::Plane::power)};
  const stream::StreamChoice state{.planes = wire::plane_bit(wire::Plane::state), .as_json = true};
  const stream::StreamChoice both{.planes = wire::kAllPlanes};
  stream::StreamChoice part = state;
  part.format.window.range = {4, 8, 1};
  std::uint64_t sequence = 0;
  stream::FrameEncoder encoder(
      {.stream_id = 9, .frame_id = 4, .choices = {power, state, both, part}, .meter = meter}, sequence);
  std::vector<stream::BlockPtr> blocks = encoder.begin(descriptor(8, 32));
  ASSERT_EQ(blocks.size(), 2u) << "two windows";
  for (const stream::BlockPtr& begin : blocks)
    EXPECT_EQ(begin->json_head, head_of<wire::FrameBegin>(begin->bytes));
  int as_json = 0;
  for (const stream::BlockPtr& block : encoder.wedge(0, filled(0, 8, 32))) {
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
  for (const stream::BlockPtr& block : blocks) bytes += block->bytes.size() + block->json_head.size();
  EXPECT_EQ(meter->bytes, bytes);
  blocks.clear();
  EXPECT_EQ(meter->bytes, 0u);
}

TEST(FrameEncoder, WithoutABrowserThereIsNoJson) {
  Stream stream;
  EXPECT_EQ(stream.encoder.begin(descriptor(8, 32)).front()->json_head, "");
  for (const stream::BlockPtr& block : stream.encoder.wedge(0, filled(0, 8, 32)))
    EXPECT_EQ(block->json_head, "");
  EXPECT_EQ(stream.encoder.end({}, 0)->json_head, "");
  EXPECT_EQ(stream.encoder.abort("because")->json_head, "");
}

TEST(FrameAssembler, NoticesAMissingBlock) {
  Stream stream;
  FrameAssembler& frames = stream.begun(8, 32);
  const auto blocks = stream.encoder.wedge(0, filled(0, 8, 32));
  for (std::size_t i = 1; i < blocks.size(); ++i) ASSERT_TRUE(feed(frames, *blocks[i]).ok());
  EXPECT_EQ(feed(frames, *stream.encoder.end({}, 0)).outcome, client::Outcome::bad_stream);
}

TEST(FrameAssembler, NoticesABlockThatComesTwiceOrLiesOutside) {
  Stream stream;
  FrameAssembler& frames = stream.begun(8, 32);
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
  FrameAssembler& frames = stream.begun(8, 32);
  ASSERT_TRUE(feed(frames, *stream.encoder.abort("because")).ok());
  EXPECT_EQ(frames.state(), FrameAssembler::State::aborted);
  EXPECT_EQ(frames.abort_reason(), "because");
  ASSERT_TRUE(feed(frames, *stream.encoder.begin(descriptor(8, 32)).front()).ok());
  for (const stream::BlockPtr& block : stream.encoder.wedge(0, filled(0, 8, 32)))
    ASSERT_TRUE(feed(frames, *block).ok());
  EXPECT_TRUE(feed(frames, *stream.encoder.end({}, 0)).ok());
}

}  // namespace
}  // namespace obliq::test::windows_test
