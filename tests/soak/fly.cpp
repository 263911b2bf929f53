// Controls a radar for a soak: sends poses at a steady rate, each one acknowledged.
//   soak_fly HOST:PORT RADAR RATE_HZ SECONDS
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <thread>

#include "client/client.h"
#include "proto/obliq.pb.h"

namespace {

using Clock = std::chrono::steady_clock;
using obliq::client::Client;
using obliq::client::Status;

// Four degrees a second: a full turn in a minute and a half.
constexpr double kTurn_deg_s = 4;

int fail(const char* what, const Status& status) {
  std::fprintf(stderr, "soak_fly: %s: %s\n", what, status.sentence().c_str());
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) {
    std::fprintf(stderr, "usage: soak_fly HOST:PORT RADAR RATE_HZ SECONDS\n");
    return 2;
  }
  const auto endpoint = obliq::client::parse_endpoint(argv[1]);
  const std::string radar = argv[2];
  const double rate_hz = std::atof(argv[3]);
  const double seconds = std::atof(argv[4]);
  if (!endpoint || !(rate_hz > 0) || !(seconds > 0)) return 2;

  Client client;
  if (Status status = client.connect(*endpoint, {.name = "soak_fly"}); !status.ok()) {
    return fail("connect", status);
  }
  obliq::wire::RadarInfo info;
  if (Status status = client.get_radar(radar, info); !status.ok()) return fail("get", status);
  if (Status status = client.claim_control(radar); !status.ok()) return fail("claim", status);
  const obliq::wire::Pose home = info.pose();
  const auto start = Clock::now();
  const auto period = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / rate_hz));
  long sent = 0;
  long late = 0;
  auto due = start;
  for (auto now = start; now - start < std::chrono::duration<double>(seconds); now = Clock::now()) {
    const double t_s = std::chrono::duration<double>(now - start).count();
    obliq::wire::Pose pose = home;
    pose.set_pose_id(static_cast<std::uint64_t>(sent) + 1);
    pose.set_bearing_deg(std::fmod(home.bearing_deg() + kTurn_deg_s * t_s, 360));
    obliq::wire::Ack ack;
    if (Status status = client.set_pose(radar, pose, ack); !status.ok()) return fail("pose", status);
    ++sent;
    due += period;
    if (due < Clock::now()) {  // never catch up
      due = Clock::now();
      ++late;
    }
    std::this_thread::sleep_until(due);
  }
  std::printf("%ld poses, %ld of them late\n", sent, late);
  return 0;
}
