// A host that commands the beam: every 1/60 s it asks for one dwell of 16 degrees, with the pose, tilt and
// noise of that moment, and takes the answers in order. No live radar is touched; the same mission gives the
// same bits, whenever it is flown, here and by client/python/examples/dwell.py.
//   dwell HOST:PORT [RADAR] [DWELLS] [iq|video]   each is as the live radar is (as_live), but for sector and
//   scan
#include <algorithm>
#include <bit>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <span>
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

/// Takes dwells as they are complete: how long each took, and a sum over all values.
class Dwells : public client::FrameAssembler {
 public:
  explicit Dwells(wire::Plane plane) : FrameAssembler(wire::plane_bit(plane)) {}

  /// due: when it should have been asked for. A request that had to wait is late from then on.
  void asked(Clock::time_point due) { asked_.push_back(std::min(due, Clock::now())); }
  std::size_t in_flight() const { return asked_.size(); }

  client::Status on_block(const wire::MessageHeader& header, const wire::WedgeBlock& block,
                          std::span<const std::byte> values) override {
    auto status = FrameAssembler::on_block(header, block, values);
    if (first_ms_.size() == last_ms_.size()) first_ms_.push_back(since_request_ms());
    return status;
  }
  client::Status on_end(const wire::MessageHeader& header, const wire::FrameEnd& end) override {
    if (auto status = FrameAssembler::on_end(header, end); !status.ok()) return status;
    if (state() != State::complete) return {};
    const client::AssembledFrame dwell = take();
    last_ms_.push_back(since_request_ms());
    asked_.pop_front();
    for (const auto& bin : dwell.iq) {
      add(std::bit_cast<std::uint32_t>(bin.real()));
      add(std::bit_cast<std::uint32_t>(bin.imag()));
    }
    for (const std::uint16_t level : dwell.video) add(level);
    return {};
  }
  client::Status on_abort(const wire::MessageHeader&, const wire::FrameAbort& abort) override {
    return client::Status::failure(client::Outcome::aborted, abort.reason());
  }

  void report() {
    if (last_ms_.empty()) return;
    print("first values", first_ms_);
    print("last values", last_ms_);
    const auto share = [&](double ms) {
      return 100.0 * static_cast<double>(std::ranges::count_if(last_ms_, [&](double t) { return t <= ms; })) /
             static_cast<double>(last_ms_.size());
    };
    std::printf("%zu dwells, %.2f %% within 33 ms, %.2f %% within 50 ms\n", last_ms_.size(), share(33),
                share(50));
    std::printf("sum %016llx\n", static_cast<unsigned long long>(sum_));
  }

 private:
  double since_request_ms() const {
    return std::chrono::duration<double, std::milli>(Clock::now() - asked_.front()).count();
  }
  static void print(const char* what, std::vector<double>& ms) {
    std::ranges::sort(ms);
    const auto part = [&](double p) {
      return ms[static_cast<std::size_t>(p * static_cast<double>(ms.size() - 1))];
    };
    std::printf("from request to %s: median %.1f ms, 99 %% %.1f ms, 99.9 %% %.1f ms, longest %.1f ms\n", what,
                part(0.5), part(0.99), part(0.999), ms.back());
  }
  /// Every value times the next odd number, modulo 2^64: a change of any value or of their order shows.
  void add(std::uint32_t value) {
    sum_ += weight_ * value;
    weight_ += 2;
  }

  std::deque<Clock::time_point> asked_;
  std::vector<double> first_ms_, last_ms_;
  std::uint64_t sum_ = 0, weight_ = 1;
};

int fail(const client::Status& status) {
  std::fprintf(stderr, "dwell: %s\n", status.sentence().c_str());
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  const auto endpoint = client::parse_endpoint(argc > 1 ? argv[1] : "127.0.0.1");
  const int count = argc > 3 ? std::atoi(argv[3]) : 300;
  const std::string plane = argc > 4 ? argv[4] : "iq";
  if (!endpoint || count < 1 || (plane != "iq" && plane != "video")) {
    std::fprintf(stderr, "usage: dwell HOST:PORT [RADAR] [DWELLS] [iq|video]\n");
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
  request.add_planes(plane == "iq" ? wire::IQ : wire::VIDEO);
  request.set_as_live(true);
  wire::RadarSettings& settings = *request.mutable_settings();
  // As many bins a degree as the whole sector has, in wedges of eight; planes_per_bin stays the radar's.
  const double per_deg = info.settings().azimuth_bins() / info.settings().sector_deg();
  settings.set_azimuth_bins(std::max(8, static_cast<int>(per_deg * kDwell_deg) / 8 * 8));
  settings.set_sector_deg(kDwell_deg);
  settings.set_scan_mode(wire::FRAME_SCAN);

  Dwells dwells(plane == "iq" ? wire::Plane::iq : wire::Plane::video);
  server.set_handler(&dwells);
  const std::size_t most = std::max(1u, server.welcome().limits().max_renders_queued());
  const double left_deg = info.pose().bearing_deg() - info.settings().sector_deg() / 2;
  const int across = std::max(1, static_cast<int>(info.settings().sector_deg() / kDwell_deg));
  auto due = Clock::now();
  for (int k = 0; k < count || dwells.in_flight() > 0;) {
    const bool may_ask = k < count && dwells.in_flight() < most;
    const auto left = std::chrono::duration_cast<client::Timeout>(due - Clock::now());
    if (may_ask && left.count() <= 0) {
      settings.set_noise_frame(static_cast<std::uint64_t>(k));  // each dwell has noise of its own
      wire::Pose& pose = *request.mutable_pose();
      pose = info.pose();
      pose.clear_sim_time_ns();
      pose.clear_tilt_auto();
      pose.set_latitude_deg(info.pose().latitude_deg() + 3e-5 * k);  // 200 m/s north
      pose.set_bearing_deg(left_deg + kDwell_deg * (0.5 + k % across));
      pose.set_tilt_deg(info.pose().tilt_deg() - 0.5 * (k / across % 2));  // two bars
      dwells.asked(due);
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
