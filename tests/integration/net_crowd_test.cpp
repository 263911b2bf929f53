// Two hundred clients on one radar, three in four of them a nuisance: 50 that stall, 50 that read one byte at
// a time, 50 that vanish without closing, and 50 that behave. The memory for frames stays where it was, and
// those who behave lose nothing.
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstdio>

#include "proto/obliq.pb.h"
#include "tests/integration/net_fixture.h"
#include "tests/support/process_memory.h"

namespace obliq::test {
namespace {

using client::FrameAssembler;

constexpr int kOfEachKind = 50;
constexpr int kFrames = 25;
constexpr int kAzimuths = 48;
constexpr int kRanges = 128;
constexpr std::size_t kPlaneBytes = std::size_t{kAzimuths} * kRanges * (8 + 8 + 4 + 1);
/// Headers, protobuf parts and allocations' slack of a frame of 6 wedges and 4 planes.
constexpr std::size_t kOverheadBytes = 16 * 1024;
/// The largest block, which each client may have in hand besides what waits for it.
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
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(server.endpoint().port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
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

/// The nuisances. Those who read byte by byte do so on a thread of their own.
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
    const client::Status status = receive_frame(client, frames);
    ASSERT_TRUE(status.ok()) << status.sentence();
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
    const client::Status status = watcher.client.subscribe(request);
    ASSERT_TRUE(status.ok()) << status.sentence();
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
  // 3 frames for the radar, and a block in hand for each client.
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
  EXPECT_EQ(status_of(observer).radars(0).live_bytes(), 0u) << "nothing is kept for those who have gone";
}

}  // namespace
}  // namespace obliq::test
