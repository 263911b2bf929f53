// What the client's assembler makes of frames that claim more than they bring.
#include <gtest/gtest.h>

#include "proto/obliq.pb.h"
#include "tests/unit/encoder_fixture.h"

namespace obliq::net {
namespace {

using client::FrameAssembler;

/// A pass of 24 x 32 bins of which the first wedge comes.
struct Pass {
  explicit Pass(const StreamChoice& choice = {}) {
    encoder = std::make_unique<FrameEncoder>(
        FrameIdentity{.stream_id = 9, .frame_id = 4, .choices = {choice}}, sequence);
    EXPECT_TRUE(feed(frames, *encoder->begin(descriptor(24, 32)).front()).ok());
    for (const BlockPtr& block : encoder->wedge(0, filled(0, 8, 32))) EXPECT_TRUE(feed(frames, *block).ok());
  }
  client::Status end(const std::vector<AzimuthRange>& missed) {
    return feed(frames, *encoder->end({}, 0, missed));
  }

  std::uint64_t sequence = 0;
  std::unique_ptr<FrameEncoder> encoder;
  FrameAssembler frames;
};

TEST(FrameAssembler, WhatAPassMissedIsNotSampled) {
  Pass pass;
  ASSERT_TRUE(pass.end({{8, 8}, {16, 8}}).ok());
  BinBlock expected(0, 24, 32);
  const BinBlock came = filled(0, 8, 32);
  std::copy(came.power_w.begin(), came.power_w.end(), expected.power_w.begin());
  std::copy(came.state.begin(), came.state.end(), expected.state.begin());
  EXPECT_EQ(pass.frames.frame().power_w, expected.power_w);
  EXPECT_EQ(pass.frames.frame().state, expected.state);
  EXPECT_EQ(pass.frames.frame().missed, (std::vector<std::pair<int, int>>{{8, 8}, {16, 8}}));
}

TEST(FrameAssembler, APassCannotMissMoreThanItHas) {
  // Each span costs its length: the largest message has room for as many as would cost minutes.
  Pass pass;
  const client::Status status = pass.end(std::vector<AzimuthRange>(1000, AzimuthRange{0, 24}));
  EXPECT_EQ(status.outcome, client::Outcome::bad_stream);
  EXPECT_NE(status.text.find("more azimuth bins were missed than the frame has"), std::string::npos)
      << status.text;
}

TEST(FrameAssembler, AWindowMayBeNarrowerThanThePassHasGaps) {
  StreamChoice choice;
  choice.format.window = {{4, 1, 1}, {}};
  Pass pass(choice);
  EXPECT_TRUE(pass.end({{8, 1}, {16, 1}}).ok());
}

}  // namespace
}  // namespace obliq::net
