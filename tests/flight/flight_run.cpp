#include "tests/flight/flight_run.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <mutex>
#include <numbers>
#include <thread>

#include "client/client.h"
#include "client/frame_assembler.h"
#include "proto/obliq.pb.h"
#include "tests/support/process_memory.h"

namespace obliq::test {
namespace {

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

constexpr double kPi = std::numbers::pi;
constexpr double kDegree_m = 111195;  // of a great circle of the mean sphere
constexpr client::Timeout kLong{30000};

double seconds_since(Clock::time_point start) { return Seconds(Clock::now() - start).count(); }

/// Resident memory of a process, MB; 0 when it is not known.
double memory_mb(int pid) {
  if (pid <= 0) return 0;
  return static_cast<double>(memory_of(pid).resident_bytes) / 1e6;
}

/// Sends poses at their rate until the distance is flown or something fails.
class Pilot {
 public:
  explicit Pilot(const FlightOrder& order) : order_(order) {}

  void fly() {
    client::Client client;
    if (!check(client.connect(order_.server, {.name = "flight pilot"}))) return;
    if (!check(client.claim_control(order_.radar))) return;
    const auto start = Clock::now();
    const auto step = std::chrono::duration_cast<Clock::duration>(Seconds(1 / order_.pose_rate_hz));
    for (auto due = start; !done; due += step) {
      std::this_thread::sleep_until(due);
      const double flown_s = seconds_since(start);
      if (flown_s * order_.speed_m_s >= order_.distance_m) break;
      const Racetrack::Place place = order_.course.at(flown_s * order_.speed_m_s);
      wire::Pose pose;
      pose.set_latitude_deg(place.latitude_deg);
      pose.set_longitude_deg(place.longitude_deg);
      pose.set_bearing_deg(place.bearing_deg);
      pose.set_sim_time_ns(static_cast<std::int64_t>(flown_s * 1e9));
      pose.set_pose_id(poses + 1);
      wire::Ack ack;
      if (!check(client.set_pose(order_.radar, pose, ack))) return;
      ++poses;
    }
    done = true;
  }

  std::atomic<bool> done = false;
  std::atomic<std::uint64_t> poses = 0;
  std::string failure;  ///< read when done

 private:
  bool check(const client::Status& status) {
    if (status.ok()) return true;
    failure = "pilot: " + status.sentence();
    done = true;
    return false;
  }
  const FlightOrder& order_;
};

/// Takes the frames and their times.
class Observer {
 public:
  Observer(const FlightOrder& order, FlightReport& report) : order_(order), report_(report) {}

  void watch(const std::atomic<bool>& done) {
    client::Client frames;
    client::Client status;
    const wire::PlaneSet planes = wire::plane_bit(wire::Plane::iq);
    client::FrameAssembler assembler(planes);
    if (!check(frames.connect(order_.server, {.name = "flight display"}))) return;
    if (!check(status.connect(order_.server, {.name = "flight observer"}))) return;
    frames.set_handler(&assembler);
    if (!check(frames.subscribe(order_.radar, order_.frame_rate_hz, planes))) return;
    const auto start = Clock::now();
    double next_look_s = 0;
    while (!done) {
      if (!check(frames.receive(kLong))) return;
      if (assembler.state() == client::FrameAssembler::State::complete) take(assembler.take());
      const double now_s = seconds_since(start);
      if (now_s < next_look_s) continue;
      next_look_s = now_s + 1;
      wire::Status answer;
      if (!check(status.get_status(answer))) return;
      look(answer, now_s);
    }
    report_.flown_s = seconds_since(start);
    if (!gaps_s_.empty()) {
      const auto middle = gaps_s_.begin() + static_cast<std::ptrdiff_t>(gaps_s_.size() / 2);
      std::nth_element(gaps_s_.begin(), middle, gaps_s_.end());
      report_.median_gap_s = *middle;
    }
    if (report_.first_memory_mb == 0) report_.first_memory_mb = report_.last_memory_mb;
  }

 private:
  bool check(const client::Status& status) {
    if (status.ok()) return true;
    report_.failure = "display: " + status.sentence();
    return false;
  }

  void take(client::AssembledFrame frame) {
    const auto now = Clock::now();
    if (report_.frames > 0) {
      const double gap_s = Seconds(now - last_).count();
      gaps_s_.push_back(gap_s);
      report_.greatest_gap_s = std::max(report_.greatest_gap_s, gap_s);
      if (gap_s > 2 / order_.frame_rate_hz) ++report_.late_frames;
    }
    last_ = now;
    const double origin_deg =
        frame.descriptor->origin_longitude_deg() + frame.descriptor->origin_latitude_deg();
    if (report_.frames > 0 && origin_deg != origin_deg_) ++report_.origins;
    origin_deg_ = origin_deg;
    ++report_.frames;
    report_.greatest_render_s = std::max(report_.greatest_render_s, frame.render_s);
    report_.least_coverage = std::min(report_.least_coverage, frame.summary->coverage());
  }

  void look(const wire::Status& status, double now_s) {
    report_.windows = status.windows_loaded();
    report_.failures = status.window_failures();
    report_.last_memory_mb = memory_mb(order_.server_pid);
    report_.greatest_memory_mb = std::max(report_.greatest_memory_mb, report_.last_memory_mb);
    if (report_.windows > 0 && report_.first_memory_mb == 0) report_.first_memory_mb = report_.last_memory_mb;
    if (!order_.print || now_s < next_line_s_) return;
    next_line_s_ = now_s + 10;
    std::printf(
        "%6.0f s, %5.1f km: %.0f MB, %llu frames, %llu late, greatest gap %.0f ms, %llu windows, "
        "coverage at least %.4f\n",
        now_s, now_s * order_.speed_m_s / 1000, report_.last_memory_mb,
        static_cast<unsigned long long>(report_.frames), static_cast<unsigned long long>(report_.late_frames),
        1000 * report_.greatest_gap_s, static_cast<unsigned long long>(report_.windows),
        report_.least_coverage);
    std::fflush(stdout);
  }

  const FlightOrder& order_;
  FlightReport& report_;
  Clock::time_point last_;
  double origin_deg_ = 0;
  double next_line_s_ = 0;
  std::vector<double> gaps_s_;
};

}  // namespace

double Racetrack::length_m() const { return 2 * straight_m + 2 * kPi * radius_m; }

Racetrack::Place Racetrack::at(double flown_m) const {
  const double turn_m = kPi * radius_m;
  double s = std::fmod(flown_m + straight_m / 2, length_m());
  double east_m = 0, north_m = 0, bearing_deg = 0;
  // East along the south, round to the left, west along the north, round to the left.
  if (s < straight_m) {
    east_m = s - straight_m / 2;
    north_m = -radius_m;
    bearing_deg = 90;
  } else if ((s -= straight_m) < turn_m) {
    const double a = s / radius_m;
    east_m = straight_m / 2 + radius_m * std::sin(a);
    north_m = -radius_m * std::cos(a);
    bearing_deg = 90 - a * 180 / kPi;
  } else if ((s -= turn_m) < straight_m) {
    east_m = straight_m / 2 - s;
    north_m = radius_m;
    bearing_deg = -90;
  } else {
    const double a = (s - straight_m) / radius_m;
    east_m = -straight_m / 2 - radius_m * std::sin(a);
    north_m = radius_m * std::cos(a);
    bearing_deg = -90 - a * 180 / kPi;
  }
  return {latitude_deg + north_m / kDegree_m,
          longitude_deg + east_m / (kDegree_m * std::cos(latitude_deg * kPi / 180)), bearing_deg};
}

std::string FlightReport::text() const {
  char line[700];
  std::snprintf(
      line, sizeof line,
      "flown in %.0f s with %llu poses, %llu frames; gaps between frames %.0f ms in the middle, %.0f ms "
      "at most, %llu later than one frame time; a frame took %.0f ms at most; %llu windows and %llu new "
      "origins, %llu failures; coverage at least %.4f; memory %.0f MB after the first window, %.0f MB at "
      "most, %.0f MB at the end%s%s",
      flown_s, static_cast<unsigned long long>(poses), static_cast<unsigned long long>(frames),
      1000 * median_gap_s, 1000 * greatest_gap_s, static_cast<unsigned long long>(late_frames),
      1000 * greatest_render_s, static_cast<unsigned long long>(windows),
      static_cast<unsigned long long>(origins), static_cast<unsigned long long>(failures), least_coverage,
      first_memory_mb, greatest_memory_mb, last_memory_mb, failure.empty() ? "" : "; ended by ",
      failure.c_str());
  return line;
}

FlightReport fly(const FlightOrder& order) {
  FlightReport report;
  Pilot pilot(order);
  std::thread pilot_thread([&] { pilot.fly(); });
  Observer(order, report).watch(pilot.done);
  pilot.done = true;
  pilot_thread.join();
  report.poses = pilot.poses;
  if (!pilot.failure.empty()) report.failure = pilot.failure;
  return report;
}

}  // namespace obliq::test
