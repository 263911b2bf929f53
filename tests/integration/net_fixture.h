#pragma once
// A server with a stand-in for the radar, so that what is tested is the network side alone, and peers that
// misbehave.
#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "client/frame_assembler.h"
#include "proto/error_number.h"
#include "server/net/server.h"
#include "tests/integration/clients.h"

namespace obliq::test {

constexpr std::uint32_t number(wire::ErrorNumber error) { return static_cast<std::uint32_t>(error); }

/// Bins whose values tell where they belong: power = frame seed + 1000 azimuth + range.
class PatternRenderer : public rendering::FrameRenderer {
 public:
  /// Called with a wedge's index, from the thread that renders it. Set before the first frame.
  std::function<void(int)> before_wedge;

  std::vector<FieldError> place(const PoseSettings& pose) const override;
  std::vector<FieldError> scene_faults(const RadarSettings& settings) const override;
  Plan plan(const SettingsPtr& settings, const PoseSettings& pose) const override;
};

/// A radar of this gain stands for one over flat plates.
constexpr double kGainOverPlates_db = 77;

/// What the pattern holds: r_max_m stands in for all settings, bearing_deg for the pose.
double pattern_power(const RadarSettings& settings, const PoseSettings& pose, int azimuth, int range);
/// The same for the settings and the pose that a frame says it has.
double pattern_power(const client::AssembledFrame& frame, int azimuth, int range);

/// A gate that render threads stop at.
class Gate {
 public:
  void close() { set(false); }
  void open() { set(true); }
  void pass() {
    std::unique_lock lock(mutex_);
    ++standing_;
    changed_.notify_all();
    changed_.wait(lock, [this] { return open_; });
    --standing_;
  }
  /// Returns when a thread stands at the closed gate.
  void await_somebody() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return standing_ > 0; });
  }

 private:
  void set(bool open) {
    const std::lock_guard lock(mutex_);
    open_ = open;
    changed_.notify_all();
  }
  std::mutex mutex_;
  std::condition_variable changed_;
  bool open_ = true;
  int standing_ = 0;
};

/// Small frames, short limits.
net::ServerOptions small_options();
RadarConfig small_radar(const std::string& name);

/// Runs in its own thread until it is destroyed. Has the radars "main" and "nose".
class TestServer {
 public:
  explicit TestServer(net::ServerOptions options = small_options());
  /// The renderer must outlive this.
  TestServer(const rendering::FrameRenderer& renderer, net::ServerOptions options);
  ~TestServer();
  client::Endpoint endpoint() const { return {"127.0.0.1", server_.port()}; }
  net::Server& server() { return server_; }
  net::Panel& panel() { return server_.panel(); }
  /// Returns when run() has returned.
  void stop();

 private:
  PatternRenderer renderer_;
  net::Server server_;
  std::thread thread_;
};

/// Every bin of a frame is what the pattern says for the frame's own settings and pose.
void expect_pattern(const client::AssembledFrame& frame);

/// A frame of the size of small_radar's, with an antenna and otherwise defaults.
wire::RenderOnce once_request();
/// The same with 2000 x 2000 bins, 84 MB: more than any socket buffer takes.
wire::RenderOnce large_once_request();

/// For radar "main".
wire::Subscribe request_at(double rate_hz);

/// A connected client; the test fails if it cannot be.
client::Client connect(const TestServer& server, const std::string& name = "tester");

/// A server and a client of it.
class Served : public testing::Test {
 protected:
  TestServer server;
  client::Client client = connect(server);
};

/// Claims radar "main" and gives it so many bins.
void size_radar(client::Client& client, std::uint32_t azimuth_bins, std::uint32_t range_bins);

wire::Status status_of(client::Client& client);
/// Of radar "main".
wire::RadarInfo info_of(client::Client& client);

/// Poses for SetPose: of a platform that moves, of an antenna that is tilted.
wire::Pose moved();
wire::Pose tilted(double tilt_deg);

/// Receives until the assembler holds a complete frame, or something fails.
client::Status receive_frame(client::Client& client, client::FrameAssembler& frames);

/// Sends what it is told to, byte for byte.
class RawPeer {
 public:
  explicit RawPeer(const TestServer& server);
  void send(std::span<const std::byte> bytes);
  void send(std::string_view text);
  /// Reads messages until one of that type. False when the server closes before.
  bool await(wire::MessageType type, google::protobuf::MessageLite& message);
  /// The Error that the server sends before it closes; other messages are skipped. 0: it just closed.
  std::uint32_t error_number();
  client::Socket& socket() { return socket_; }

 private:
  client::Socket socket_;
};

/// A Hello as a client sends it.
wire::Bytes hello_bytes();

}  // namespace obliq::test
