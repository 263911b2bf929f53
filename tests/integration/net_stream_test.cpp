// Encodings, windows and backpressure, from request to frame.
#include <gtest/gtest.h>

#include <complex>

#include "proto/obliq.pb.h"
#include "tests/integration/net_fixture.h"

namespace obliq::test {
namespace {

using client::FrameAssembler;
using wire::ErrorNumber;

/// A frame with its window taken from the pattern.
void expect_window_of_pattern(const client::AssembledFrame& frame, const wire::Window& window) {
  ASSERT_EQ(frame.n_azimuth, static_cast<int>(window.azimuth.kept()));
  ASSERT_EQ(frame.n_range, static_cast<int>(window.range.kept()));
  std::size_t at = 0;
  for (std::uint64_t a = window.azimuth.first; a < window.azimuth.end(); a += window.azimuth.step) {
    for (std::uint64_t r = window.range.first; r < window.range.end(); r += window.range.step, ++at) {
      ASSERT_EQ(frame.power_w[at], pattern_power(frame, static_cast<int>(a), static_cast<int>(r)));
    }
  }
}

TEST(Stream, EachClientGetsTheFrameInItsOwnEncoding) {
  const TestServer server;
  client::Client floats = connect(server);
  client::Client integers = connect(server);
  ASSERT_TRUE(floats.subscribe("main", 50).ok());
  wire::Subscribe request = request_at(50);
  request.set_iq_encoding(wire::CI16_LE);
  request.set_compression(wire::ZSTD);
  ASSERT_TRUE(integers.subscribe(request).ok());
  FrameAssembler as_floats;
  FrameAssembler as_integers;
  ASSERT_TRUE(receive_frame(floats, as_floats).ok());
  const client::Status status = receive_frame(integers, as_integers);
  ASSERT_TRUE(status.ok()) << status.sentence();
  expect_pattern(as_floats.frame());
  const auto& exact = as_floats.frame().iq;
  const auto& coarse = as_integers.frame().iq;
  ASSERT_EQ(exact.size(), coarse.size());
  float largest = 0;
  for (const auto& value : exact) largest = std::max({largest, value.real(), -value.imag()});
  for (std::size_t i = 0; i < exact.size(); ++i) {
    // Half a step of the block with the largest value, and a float's own rounding.
    ASSERT_LE(std::abs(exact[i].real() - coarse[i].real()), largest / 32767 * 0.51f);
    ASSERT_LE(std::abs(exact[i].imag() - coarse[i].imag()), largest / 32767 * 0.51f);
  }
  EXPECT_EQ(as_floats.frame().power_w, as_integers.frame().power_w) << "other planes are exact";
}

TEST(Stream, AWindowBringsItsBinsAndIsAllThatIsRendered) {
  std::atomic<int> other_wedges{0};
  PatternRenderer renderer;
  renderer.before_wedge = [&](int wedge) {
    if (wedge != 1) ++other_wedges;
  };
  const TestServer server(renderer, small_options());
  client::Client client = connect(server);
  wire::Subscribe request = request_at(50);
  const wire::Window window{{9, 5, 2}, {3, 20, 4}};  // azimuths 9, 11, 13: the second wedge alone
  wire::write_window(window, *request.mutable_window());
  ASSERT_TRUE(client.subscribe(request).ok());
  FrameAssembler frames;
  const client::Status status = receive_frame(client, frames);
  ASSERT_TRUE(status.ok()) << status.sentence();
  expect_window_of_pattern(frames.frame(), window);
  EXPECT_EQ(other_wedges, 0);
}

TEST(Stream, RenderOnceTakesAWindowAndAnEncoding) {
  const TestServer server;
  client::Client client = connect(server);
  wire::RenderOnce request = once_request();
  const wire::Window window{{1, 0, 3}, {0, 5, 1}};
  wire::write_window(window, *request.mutable_window());
  request.set_compression(wire::ZSTD);
  ASSERT_TRUE(client.render_once(request).ok());
  FrameAssembler frames;
  const client::Status status = receive_frame(client, frames);
  ASSERT_TRUE(status.ok()) << status.sentence();
  expect_window_of_pattern(frames.frame(), {{1, 19, 3}, {0, 5, 1}});
}

TEST(Stream, AWindowOutsideTheFrameIsRefusedAndLaterToldOf) {
  const TestServer server;
  client::Client client = connect(server);
  wire::Subscribe request = request_at(50);
  request.mutable_window()->set_first_range(32);
  const client::Status refused = client.subscribe(request);
  EXPECT_EQ(refused.number, number(ErrorNumber::invalid_value));
  ASSERT_EQ(refused.fields.size(), 1u);
  EXPECT_EQ(refused.fields[0].field, "window.first_range");
  request.mutable_window()->set_first_range(30);
  ASSERT_TRUE(client.subscribe(request).ok());
  ASSERT_TRUE(client.claim_control("main").ok());
  wire::RadarSettings settings;
  settings.set_range_bins(30);
  wire::Ack ack;
  ASSERT_TRUE(client.set_settings("main", settings, ack).ok());
  client::Status status;
  while (status.ok()) status = client.receive(kLong);
  EXPECT_EQ(status.number, number(ErrorNumber::window_outside_frame)) << status.sentence();
}

TEST(Stream, ALosslessClientGetsEveryFrameHoweverSlowlyItReads) {
  const TestServer server;
  client::Client client = connect(server);
  wire::Subscribe request = request_at(100);
  request.set_lossless(true);
  ASSERT_TRUE(client.subscribe(request).ok());
  FrameAssembler frames;
  std::uint64_t last = 0;
  for (int i = 0; i < 30; ++i) {
    const client::Status status = receive_frame(client, frames);
    ASSERT_TRUE(status.ok()) << status.sentence();
    const client::AssembledFrame frame = frames.take();
    if (last != 0) {
      EXPECT_EQ(frame.descriptor->frame_id(), last + 1);
    }
    EXPECT_EQ(frame.frames_skipped, 0u);
    last = frame.descriptor->frame_id();
    if (i % 10 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
}

net::ServerOptions short_patience() {
  net::ServerOptions options = small_options();
  options.abort_after_s = 0.1;
  options.lossless_limit_s = 0.3;
  return options;
}

/// Frames of 2 MB, so that a client that does not read holds some back whatever the kernel buffers.
void make_large(client::Client& controller) { size_radar(controller, 400, 500); }

TEST(Stream, ALosslessClientThatTakesNothingIsDisconnectedWithAReasonAndTheRadarGoesOn) {
  const TestServer server(short_patience());
  client::Client watcher = connect(server);
  make_large(watcher);
  client::Client stalled = connect(server);
  wire::Subscribe request = request_at(100);
  request.set_lossless(true);
  ASSERT_TRUE(stalled.subscribe(request).ok());
  wire::Status status;
  do {
    ASSERT_TRUE(watcher.get_status(status).ok());
  } while (status.clients() > 1);
  EXPECT_LE(status.radars(0).live_frames(), 3u);
  FrameAssembler frames;
  ASSERT_TRUE(watcher.subscribe("main", 50).ok());
  const client::Status got = receive_frame(watcher, frames);
  EXPECT_TRUE(got.ok()) << got.sentence();
  // What it had not read is still there, and the reason after it, if its socket took that in time.
  client::Status end;
  while (end.ok()) end = stalled.receive(kLong);
  EXPECT_TRUE(end.number == number(ErrorNumber::reads_too_slowly) || end.outcome == client::Outcome::closed)
      << end.sentence();
}

TEST(Stream, ALosslessClientSlowsItsOwnRadarAndNoOther) {
  const TestServer server;
  client::Client watcher = connect(server);
  make_large(watcher);
  client::Client stalled = connect(server);
  wire::Subscribe request = request_at(100);
  request.set_lossless(true);
  ASSERT_TRUE(stalled.subscribe(request).ok());
  std::uint64_t frames_then = 0;
  std::uint64_t frames_now = 0;
  for (int quiet = 0; quiet < 5;) {  // until no further frame comes: three wait for the one who does not read
    frames_then = frames_now;
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    const wire::RadarStatus status = status_of(watcher).radars(0);
    frames_now = status.frames();
    EXPECT_LE(status.live_frames(), 3u);
    quiet = frames_now == frames_then && frames_now > 0 ? quiet + 1 : 0;
  }
  ASSERT_TRUE(watcher.subscribe("nose", 50).ok());
  FrameAssembler frames;
  for (int i = 0; i < 10; ++i) {
    const client::Status got = receive_frame(watcher, frames);
    ASSERT_TRUE(got.ok()) << got.sentence();
    expect_pattern(frames.take());
  }
  EXPECT_EQ(status_of(watcher).radars(0).frames(), frames_now) << "the slowed radar stands still meanwhile";
}

TEST(Stream, AFrameThatAStalledClientHoldsIsAbortedAndTheRadarGoesOn) {
  const TestServer server(short_patience());
  client::Client watcher = connect(server);
  make_large(watcher);
  std::vector<client::Client> stalled;
  FrameAssembler frames;
  ASSERT_TRUE(watcher.subscribe("main", 50).ok());
  for (int i = 0; i < 4; ++i) {  // one more than frames may live, each stuck in a frame of its own
    stalled.push_back(connect(server));
    ASSERT_TRUE(stalled.back().subscribe("main", 50).ok());
    for (int k = 0; k < 15; ++k) {
      const client::Status got = receive_frame(watcher, frames);
      ASSERT_TRUE(got.ok()) << got.sentence();
      expect_pattern(frames.take());
    }
  }
  EXPECT_LE(status_of(watcher).radars(0).live_frames(), 3u);
}

}  // namespace
}  // namespace obliq::test
