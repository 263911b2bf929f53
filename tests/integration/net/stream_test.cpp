// Encodings, windows and backpressure, from request to frame.
// Two hundred clients on one radar, three in four of them a nuisance: 50 that stall, 50 that read one byte at
// a time, 50 that vanish without closing, and 50 that behave. The memory for frames stays where it was, and
// good clients lose nothing.
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdio>

#include "proto/obliq.pb.h"
#include "tests/integration/net_fixture.h"
#include "tests/support/loopback.h"
#include "tests/support/process_memory.h"

namespace obliq::test::stream_test {
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
  ASSERT_TRUE(is_ok(receive_frame(integers, as_integers)));
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
  ASSERT_TRUE(is_ok(receive_frame(client, frames)));
  expect_window_of_pattern(frames.frame(), window);
  EXPECT_EQ(other_wedges, 0);
}

TEST_F(Served, ALosslessClientGetsEveryFrameHoweverSlowlyItReads) {
  wire::Subscribe request = request_at(100);
  request.set_lossless(true);
  ASSERT_TRUE(client.subscribe(request).ok());
  FrameAssembler frames;
  std::uint64_t last = 0;
  for (int i = 0; i < 30; ++i) {
    ASSERT_TRUE(is_ok(receive_frame(client, frames)));
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
  EXPECT_TRUE(is_ok(receive_frame(watcher, frames)));
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
    ASSERT_TRUE(is_ok(receive_frame(watcher, frames)));
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
      ASSERT_TRUE(is_ok(receive_frame(watcher, frames)));
      expect_pattern(frames.take());
    }
  }
  EXPECT_LE(status_of(watcher).radars(0).live_frames(), 3u);
}

constexpr int kOfEachKind = 50;
constexpr int kFrames = 25;
constexpr int kAzimuths = 48;
constexpr int kRanges = 128;
constexpr std::size_t kPlaneBytes = std::size_t{kAzimuths} * kRanges * (8 + 8 + 4 + 1);
/// Headers, protobuf parts and allocations' slack of a frame of 6 wedges and 4 planes.
constexpr std::size_t kOverheadBytes = 16 * 1024;
/// The largest block, which each client may be sent besides what waits for it.
constexpr std::size_t kBlockBytes = std::size_t{8} * kRanges * 8 + 1024;

/// A socket that has subscribed and is then read as badly as one likes. Its receive buffer is small, so that
/// what it does not read soon waits in the server.
class BadPeer {
 public:
  explicit BadPeer(const TestServer& server) {
    fd_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    EXPECT_GE(fd_, 0);
    const int small = 4096;
    EXPECT_EQ(::setsockopt(fd_, SOL_SOCKET, SO_RCVBUF, &small, sizeof small), 0);
    connect_to_loopback(fd_, server.endpoint().port);
    send_all(hello_bytes());
    wire::Subscribe request = request_at(100);
    request.set_request_id(2);
    send_all(wire::encode_message(wire::MessageType::subscribe, {0, 2, wire::utc_now_ns()}, request));
  }
  ~BadPeer() {
    if (fd_ >= 0) ::close(fd_);
  }
  BadPeer(BadPeer&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  BadPeer(const BadPeer&) = delete;

  /// Waits for bytes and takes at most so many.
  void read_some(std::size_t n) {
    std::vector<std::byte> bytes(n);
    EXPECT_GT(::recv(fd_, bytes.data(), n, 0), 0);
  }
  /// Takes one byte if there is one. False when the server has closed.
  bool read_a_byte() {
    std::byte one{};
    return ::recv(fd_, &one, 1, MSG_DONTWAIT) != 0;
  }

 private:
  void send_all(const wire::Bytes& bytes) {
    EXPECT_EQ(::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL), static_cast<ssize_t>(bytes.size()));
  }
  int fd_ = -1;
};

net::ServerOptions crowded() {
  net::ServerOptions options = small_options();
  options.max_clients = 256;
  options.max_clients_per_address = 256;
  options.max_waiting = 256;
  options.handshake_timeout_s = 60;  // 200 at once, on a machine that may be busy
  options.message_timeout_s = 60;
  options.abort_after_s = 0.2;
  return options;
}

/// Of this process, server and clients both. 0 where /proc is not there.
double resident_MB() { return static_cast<double>(memory_of(::getpid()).resident_bytes) * 1e-6; }

/// The nuisances. Those that read byte by byte do so on threads of their own.
struct Nuisances {
  explicit Nuisances(const TestServer& server) {
    for (int i = 0; i < kOfEachKind; ++i) {
      stalled.emplace_back(server);
      byte_by_byte.emplace_back(server);
      // Without closing: no FIN and no reset, as when a machine loses its power or its cable. On the loopback
      // the kernel cannot be made to lose them too; what is left is a peer that took frames and then is
      // silent for ever, its window closed.
      vanished.emplace_back(server).read_some(1000);
    }
    reading = std::thread([this] {
      while (!done) {
        for (BadPeer& peer : byte_by_byte) peer.read_a_byte();
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
    });
  }
  ~Nuisances() {
    done = true;
    reading.join();
  }
  std::vector<BadPeer> stalled;
  std::vector<BadPeer> byte_by_byte;
  std::vector<BadPeer> vanished;
  std::atomic<bool> done{false};
  std::thread reading;
};

/// One that behaves: watches without losses and looks at every bin of every frame.
struct Watcher {
  client::Client client;
  FrameAssembler frames;
  std::uint64_t last = 0;

  void take_frame() {
    ASSERT_TRUE(is_ok(receive_frame(client, frames)));
    const client::AssembledFrame frame = frames.take();
    ASSERT_EQ(frame.n_azimuth, kAzimuths);
    expect_pattern(frame);
    if (last != 0) {
      ASSERT_EQ(frame.descriptor->frame_id(), last + 1) << "a frame was lost";
    }
    EXPECT_EQ(frame.frames_skipped, 0u);
    last = frame.descriptor->frame_id();
  }
};

TEST(Crowd, TwoHundredClientsOfWhomFiftyBehave) {
  const TestServer server(crowded());
  client::Client observer = connect(server, "observer");
  size_radar(observer, kAzimuths, kRanges);
  const Nuisances nuisances(server);
  std::vector<Watcher> watchers(kOfEachKind);
  for (Watcher& watcher : watchers) {
    watcher.client = connect(server);
    wire::Subscribe request;
    request.set_radar("main");
    request.set_rate_hz(100);
    request.set_lossless(true);
    ASSERT_TRUE(is_ok(watcher.client.subscribe(request)));
  }

  constexpr int kThreads = 5;
  std::atomic<int> finished{0};
  std::vector<std::jthread> threads;
  for (int t = 0; t < kThreads; ++t) {
    threads.emplace_back([&, t] {
      for (int frame = 0; frame < kFrames && !testing::Test::HasFatalFailure(); ++frame) {
        for (std::size_t i = static_cast<std::size_t>(t); i < watchers.size(); i += kThreads)
          watchers[i].take_frame();
      }
      ++finished;
    });
  }
  // 3 frames for the radar, and a block that is being sent for each client.
  constexpr std::size_t kMostBytes = 3 * (kPlaneBytes + kOverheadBytes) + (4 * kOfEachKind + 1) * kBlockBytes;
  std::size_t most_bytes = 0;
  std::vector<double> resident;
  while (finished < kThreads) {
    const wire::Status status = status_of(observer);
    most_bytes = std::max<std::size_t>(most_bytes, status.radars(0).live_bytes());
    EXPECT_LE(status.radars(0).live_frames(), 3u);
    EXPECT_LE(status.radars(0).live_bytes(), kMostBytes);
    resident.push_back(resident_MB());
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  threads.clear();
  EXPECT_EQ(status_of(observer).clients(), 4u * kOfEachKind + 1) << "the nuisances were there all the time";
  std::printf(
      "201 clients, %d frames of %.2f MB each: at most %.2f MB in blocks (bound %.2f MB); "
      "resident %.1f MB at first, %.1f MB half-way, %.1f MB at the end\n",
      kFrames, static_cast<double>(kPlaneBytes) * 1e-6, static_cast<double>(most_bytes) * 1e-6,
      static_cast<double>(kMostBytes) * 1e-6, resident.front(), resident[resident.size() / 2],
      resident.back());
}

TEST(Crowd, WhoTakesNothingIsDroppedInTheEnd) {
  net::ServerOptions options = crowded();
  options.stall_timeout_s = 1;
  const TestServer server(options);
  client::Client observer = connect(server, "observer");
  size_radar(observer, kAzimuths, kRanges);
  const Nuisances nuisances(server);
  while (status_of(observer).clients() > 1) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_EQ(status_of(observer).radars(0).subscribers(), 0u);
  EXPECT_EQ(status_of(observer).radars(0).live_bytes(), 0u) << "nothing is kept for clients that have gone";
}

}  // namespace
}  // namespace obliq::test::stream_test
