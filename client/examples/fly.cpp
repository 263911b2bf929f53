// A host that flies a radar while others may turn its knobs: claims its pose, sends poses at 60 Hz by its own
// clock, takes each wedge as it comes, and says how old the pictures are.
//   fly HOST:PORT [RADAR] [SECONDS]
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "client/client.h"
#include "proto/obliq.pb.h"

namespace {

using Clock = std::chrono::steady_clock;
using namespace obliq;

constexpr std::chrono::nanoseconds kPeriod{1'000'000'000 / 60};
constexpr double kSpeed_m_s = 200;
constexpr double kMetresPerDegree = 111320;  // of latitude

/// Wedges of the radar, painted as they come. Here "painting" is counting.
class Screen : public client::FrameHandler {
 public:
  client::Status on_block(const wire::MessageHeader& header, const wire::WedgeBlock& block,
                          std::span<const std::byte>) override {
    // PROTOCOL.md, "Latency": when the wedge's pose arrived at the server, by its clock, and now. One
    // machine, one clock.
    const std::int64_t pose_utc_ns = header.utc_ns - (block.send_ns() - block.pose_received_ns());
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    if (block.pose().pose_id() > 0)
      ages_ms_.push_back(
          static_cast<double>(std::chrono::duration_cast<std::chrono::nanoseconds>(now).count() -
                              pose_utc_ns) /
          1e6);
    return {};
  }
  client::Status on_end(const wire::MessageHeader&, const wire::FrameEnd&) override {
    ++frames_;
    return {};
  }

  void report() {
    if (ages_ms_.empty()) return;
    std::sort(ages_ms_.begin(), ages_ms_.end());
    const auto part = [&](double p) {
      return ages_ms_[static_cast<std::size_t>(p * static_cast<double>(ages_ms_.size() - 1))];
    };
    std::printf("%d frames, %zu wedges; from pose to wedge: median %.1f ms, 99 %% within %.1f ms\n", frames_,
                ages_ms_.size(), part(0.5), part(0.99));
  }

 private:
  std::vector<double> ages_ms_;
  int frames_ = 0;
};

int fail(const client::Status& status) {
  std::fprintf(stderr, "fly: %s\n", status.sentence().c_str());
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  const auto endpoint = client::parse_endpoint(argc > 1 ? argv[1] : "127.0.0.1");
  const double seconds = argc > 3 ? std::atof(argv[3]) : 5;
  if (!endpoint || !(seconds > 0)) {
    std::fprintf(stderr, "usage: fly HOST:PORT [RADAR] [SECONDS]\n");
    return 2;
  }
  client::Client server;
  if (auto status = server.connect(*endpoint, {.name = "fly"}); !status.ok()) return fail(status);
  if (server.welcome().radars_size() == 0) return 1;
  const std::string radar = argc > 2 ? argv[2] : server.welcome().radars(0);
  wire::RadarInfo info;
  if (auto status = server.get_radar(radar, info); !status.ok()) return fail(status);
  if (auto status = server.claim(radar, wire::kPoseClaim); !status.ok()) return fail(status);
  Screen screen;
  server.set_handler(&screen);
  if (auto status = server.subscribe(radar, 60, wire::plane_bit(wire::Plane::iq)); !status.ok())
    return fail(status);

  const auto start = Clock::now();
  std::uint64_t sent = 0;
  const auto count = static_cast<std::uint64_t>(std::llround(60 * seconds));
  for (auto due = start; sent < count; due += kPeriod) {
    // Wedges are painted until the next pose is due.
    for (;;) {
      const auto left = std::chrono::duration_cast<client::Timeout>(due - Clock::now());
      if (left.count() <= 0) break;
      const auto status = server.receive(left);
      if (!status.ok() && status.outcome != client::Outcome::timed_out) return fail(status);
    }
    const std::chrono::nanoseconds sim_time = due - start;
    wire::Pose pose;  // what is absent stays: height, bearing
    const double metres = kSpeed_m_s * std::chrono::duration<double>(sim_time).count();
    pose.set_latitude_deg(info.pose().latitude_deg() + metres / kMetresPerDegree);
    pose.set_longitude_deg(info.pose().longitude_deg());
    pose.set_sim_time_ns(sim_time.count());
    pose.set_pose_id(++sent);
    wire::Ack ack;
    if (auto status = server.set_pose(radar, pose, ack); !status.ok()) return fail(status);
  }
  wire::Ack ack;
  info.mutable_pose()->clear_sim_time_ns();
  if (auto status = server.set_pose(radar, info.pose(), ack); !status.ok())
    return fail(status);  // back to where it was
  if (auto status = server.release_control(radar); !status.ok()) return fail(status);
  std::printf("%llu poses; ", static_cast<unsigned long long>(sent));
  screen.report();
  return 0;
}
