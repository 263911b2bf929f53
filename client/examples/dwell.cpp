// A host that commands the beam: every 1/60 s it asks for one dwell of 16 degrees, with the pose of that
// moment, and takes the answers in order. No live radar is touched; the same mission gives the same bits,
// whenever it is flown.
//   dwell HOST:PORT [RADAR] [DWELLS]      the radar's settings are taken, but for sector and scan
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <string>
#include <vector>

#include "client/client.h"
#include "client/frame_assembler.h"
#include "proto/obliq.pb.h"

namespace {

using Clock = std::chrono::steady_clock;
using namespace obliq;

constexpr std::chrono::nanoseconds kPeriod{1'000'000'000 / 60};
constexpr double kDwell_deg = 16;

/// Takes dwells as they are complete: how long each took, and a sum over all bits (FNV-1a, 64 bits).
class Dwells : public client::FrameAssembler {
 public:
  Dwells() : FrameAssembler(wire::plane_bit(wire::Plane::iq)) {}

  void asked() { asked_.push_back(Clock::now()); }
  std::size_t in_flight() const { return asked_.size(); }

  client::Status on_end(const wire::MessageHeader& header, const wire::FrameEnd& end) override {
    if (auto status = FrameAssembler::on_end(header, end); !status.ok()) return status;
    if (state() != State::complete) return {};
    const client::AssembledFrame dwell = take();
    milliseconds_.push_back(std::chrono::duration<double, std::milli>(Clock::now() - asked_.front()).count());
    asked_.pop_front();
    const auto bytes = std::as_bytes(std::span(dwell.iq));
    for (const std::byte byte : bytes) sum_ = (sum_ ^ std::to_integer<std::uint64_t>(byte)) * 0x100000001b3;
    return {};
  }
  client::Status on_abort(const wire::MessageHeader&, const wire::FrameAbort& abort) override {
    return client::Status::failure(client::Outcome::aborted, abort.reason());
  }

  void report() {
    if (milliseconds_.empty()) return;
    std::sort(milliseconds_.begin(), milliseconds_.end());
    const auto part = [&](double p) {
      return milliseconds_[static_cast<std::size_t>(p * static_cast<double>(milliseconds_.size() - 1))];
    };
    std::printf(
        "%zu dwells; from request to last bin: median %.1f ms, 99 %% within %.1f ms, 99.9 %% within %.1f "
        "ms\n",
        milliseconds_.size(), part(0.5), part(0.99), part(0.999));
    std::printf("sum %016llx\n", static_cast<unsigned long long>(sum_));
  }

 private:
  std::deque<Clock::time_point> asked_;
  std::vector<double> milliseconds_;
  std::uint64_t sum_ = 0xcbf29ce484222325;
};

int fail(const client::Status& status) {
  std::fprintf(stderr, "dwell: %s\n", status.sentence().c_str());
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  const auto endpoint = client::parse_endpoint(argc > 1 ? argv[1] : "127.0.0.1");
  const int count = argc > 3 ? std::atoi(argv[3]) : 300;
  if (!endpoint || count < 1) {
    std::fprintf(stderr, "usage: dwell HOST:PORT [RADAR] [DWELLS]\n");
    return 2;
  }
  client::Client server;
  if (auto status = server.connect(*endpoint, {.name = "dwell"}); !status.ok()) return fail(status);
  if (server.welcome().radars_size() == 0) return 1;
  const std::string radar = argc > 2 ? argv[2] : server.welcome().radars(0);
  wire::RadarInfo info;
  if (auto status = server.get_radar(radar, info); !status.ok()) return fail(status);

  wire::RenderOnce request;
  request.set_radar(radar);
  request.add_planes(wire::IQ);
  wire::RadarSettings& settings = *request.mutable_settings();
  settings = info.settings();
  // As many bins a degree as the whole sector has, in wedges of eight.
  const double per_deg = settings.azimuth_bins() / settings.sector_deg();
  settings.set_azimuth_bins(std::max(8, static_cast<int>(per_deg * kDwell_deg) / 8 * 8));
  settings.set_pixel_columns(2 * settings.azimuth_bins());
  settings.set_sector_deg(kDwell_deg);
  settings.set_scan_mode(wire::FRAME_SCAN);

  Dwells dwells;
  server.set_handler(&dwells);
  const std::size_t most = std::max(1u, server.welcome().limits().max_renders_queued());
  const double left_deg = info.pose().bearing_deg() - info.settings().sector_deg() / 2;
  const int across = std::max(1, static_cast<int>(info.settings().sector_deg() / kDwell_deg));
  auto due = Clock::now();
  for (int k = 0; k < count || dwells.in_flight() > 0;) {
    const bool may_ask = k < count && dwells.in_flight() < most;
    const auto left = std::chrono::duration_cast<client::Timeout>(due - Clock::now());
    if (may_ask && left.count() <= 0) {
      *request.mutable_pose() = info.pose();
      request.mutable_pose()->clear_sim_time_ns();
      request.mutable_pose()->set_latitude_deg(info.pose().latitude_deg() + 3e-5 * k);  // 200 m/s north
      request.mutable_pose()->set_bearing_deg(left_deg + kDwell_deg * (0.5 + k % across));
      dwells.asked();
      if (auto status = server.render_once(request); !status.ok()) return fail(status);
      ++k;
      due += kPeriod;
      continue;
    }
    const auto status = server.receive(may_ask ? left : client::Timeout(30000));
    if (!status.ok() && !(may_ask && status.outcome == client::Outcome::timed_out)) return fail(status);
  }
  dwells.report();
  return 0;
}
