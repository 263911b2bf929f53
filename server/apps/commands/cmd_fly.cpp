// `obliq fly`: sends a live radar along a track, pose by pose, when each is due.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <thread>

#include "proto/obliq.pb.h"
#include "server/apps/commands/arguments/number_option.h"
#include "server/apps/commands/arguments/server_arguments.h"
#include "server/apps/commands/arguments/stream_arguments.h"
#include "server/apps/commands/commands.h"
#include "server/apps/commands/fly/fly_datagrams.h"
#include "server/apps/commands/fly/track_reader.h"
#include "server/apps/commands/frame_report.h"
#include "server/control/key.h"
#include "terrain/base/errors.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

struct FlyArguments {
  ServerArguments server;
  std::string track;
  std::string reference;
  double height_unit_m = 1;
  double speed = 1;
  double rate_hz = 0;
  DatagramSource datagrams;
  int reconnect_s = 0;
};

// Between looks at signals, at the server's heartbeats and at a pipe.
constexpr milliseconds kLook{50};
// For the end of a connection that the server has announced.
constexpr milliseconds kLongestLoss{5000};
constexpr double kSlowest = 0.01;
constexpr double kFastest = 1000;
constexpr double kMostRate_hz = 1000;
constexpr double kUsualRate_hz = 10;
constexpr double kNanoseconds = 1e9;
constexpr double kLongest_s = 1e9;  // of a flight: 30 years

/// A share u in [0, 1] of the way from a to b, the short way round in longitude and bearing.
TrackPoint on_the_way(const TrackPoint& a, const TrackPoint& b, double u) {
  const auto part = [u](double from, double to) { return from + u * (to - from); };
  const auto arc = [u](double from, double to) {
    return std::remainder(from + u * std::remainder(to - from, 360.0), 360.0);
  };
  TrackPoint point;
  point.time_s = part(a.time_s, b.time_s);
  point.latitude_deg = part(a.latitude_deg, b.latitude_deg);
  point.longitude_deg = arc(a.longitude_deg, b.longitude_deg);
  point.height_m = part(a.height_m, b.height_m);
  point.bearing_deg = arc(a.bearing_deg, b.bearing_deg);
  for (const MotionColumn& column : kMotionColumns)
    if (const auto value = column.value; a.*value && b.*value) point.*value = part(*(a.*value), *(b.*value));
  return point;
}

/// Velocity and attitude that the track says. Velocities are of its own clock; one that is none at this
/// speed of flight is left to the server, which takes it from the poses.
void write_motion(const TrackPoint& point, double speed, wire::Pose& pose) {
  const auto flown = [&](const std::optional<double>& velocity_m_s) {
    return speed * velocity_m_s.value_or(0);
  };
  const double north = flown(point.velocity_north_m_s), east = flown(point.velocity_east_m_s),
               up = flown(point.velocity_up_m_s);
  const bool is_said = point.velocity_north_m_s || point.velocity_east_m_s || point.velocity_up_m_s;
  if (is_said && std::max({std::abs(north), std::abs(east), std::abs(up)}) <= kMostSpeed_m_s) {
    pose.set_velocity_north_m_s(north);
    pose.set_velocity_east_m_s(east);
    pose.set_velocity_up_m_s(up);
  }
  if (point.roll_deg) pose.set_roll_deg(*point.roll_deg);
  if (point.pitch_deg) pose.set_pitch_deg(*point.pitch_deg);
}

/// One flight: what was sent so far, and when the rest is due.
class Flight {
 public:
  Flight(client::ResumingClient& client, std::string radar, const FlyArguments& arguments)
      : client_(client), radar_(std::move(radar)), arguments_(arguments) {}

  /// False when it was interrupted.
  bool fly_to(const TrackPoint& point, const std::string& where) {
    if (sent_ == 0) {
      start_ = Clock::now();
      first_s_ = point.time_s;
    }
    if (elapsed_s(point) > kLongest_s)
      throw InputError(
          fmt::format("{}: time: found {} s after the first; allowed: at most {} s at this --speed", where,
                      toml_number(point.time_s - first_s_), toml_number(kLongest_s * arguments_.speed)));
    if (sent_ > 0 && !fill_in(point, where)) return false;
    if (!wait_until(due(point))) return false;
    send(point, where);
    return true;
  }
  /// Waits a moment for what has not been written yet. False when it was interrupted.
  bool wait_a_moment() { return wait_until(Clock::now() + milliseconds(2)); }

  /// now: the pose that the radar has, with what its height counts from.
  void print_summary(const char* end, const wire::Pose& now) const {
    std::printf("%s: %s after %llu poses in %.1f s, %.1f s of the track", radar_.c_str(), end,
                static_cast<unsigned long long>(sent_), seconds_since(start_), last_.time_s - first_s_);
    if (late_s_ > 0.01) std::printf(", at most %.2f s late", late_s_);
    std::printf("; it stays at %s\n", pose_text(now).c_str());
  }
  bool has_begun() const { return sent_ > 0; }

 private:
  /// Since the start, when the point is due.
  double elapsed_s(const TrackPoint& point) const { return (point.time_s - first_s_) / arguments_.speed; }
  Clock::time_point due(const TrackPoint& point) const { return start_ + from_seconds(elapsed_s(point)); }

  /// Poses between two lines that lie far apart, but for those whose time has passed.
  bool fill_in(const TrackPoint& to, const std::string& where) {
    const TrackPoint from = last_;
    const double steps = std::ceil((to.time_s - from.time_s) / arguments_.speed * arguments_.rate_hz - 1e-6);
    for (double step = 1; step < steps; ++step) {
      const TrackPoint point = on_the_way(from, to, step / steps);
      const double late_periods = seconds_since(due(point)) * arguments_.rate_hz;
      if (late_periods > 1) {  // of many, on to the first that is not late
        step += std::floor(late_periods);
        continue;
      }
      if (!wait_until(due(point))) return false;
      send(point, where);
    }
    return true;
  }

  bool wait_until(Clock::time_point moment) {
    for (;;) {
      if (interrupted()) return false;
      const auto left = std::chrono::duration_cast<milliseconds>(moment - Clock::now());
      if (left < milliseconds(1)) break;
      // Heartbeats are answered meanwhile, and an admin's takeover is detected.
      const client::Status status = client_.receive(std::min(left, kLook));
      if (status.outcome != client::Outcome::timed_out) require(status);
    }
    std::this_thread::sleep_until(moment);
    return true;
  }

  void send(const TrackPoint& point, const std::string& where) {
    wire::Pose pose;
    pose.set_latitude_deg(point.latitude_deg);
    pose.set_longitude_deg(point.longitude_deg);
    pose.set_height_m(point.height_m);
    set_heading(client_.client(), says_bearing_, point.bearing_deg, 0, pose);
    // The track's clock, but the server holds it against its own: it runs as the flight does.
    pose.set_sim_time_ns(std::llround((first_s_ + elapsed_s(point)) * kNanoseconds));
    pose.set_pose_id(sent_ + 1);
    write_motion(point, arguments_.speed, pose);
    if (arguments_.reference == "datum") pose.set_height_reference(wire::DATUM);
    if (arguments_.reference == "ground") pose.set_height_reference(wire::GROUND);
    if (arguments_.reference == "ellipsoid") pose.set_height_reference(wire::ELLIPSOID);
    late_s_ = std::max(late_s_, seconds_since(due(point)));
    wire::Ack ack;
    client::Status status = client_.client().set_pose(radar_, pose, ack);
    says_bearing_ = is_lost(client_, status);
    if (says_bearing_) {  // the pose of that moment is given up, the next one that is due comes
      status = client_.receive(kLongestLoss);
      if (status.outcome == client::Outcome::timed_out) status = {};
    }
    if (!status.ok()) throw InputError(where + ": " + status.sentence());
    warnings_.tell({ack.warnings().begin(), ack.warnings().end()}, where + ": ");
    ++sent_;
    last_ = point;
  }

  client::ResumingClient& client_;
  const std::string radar_;
  const FlyArguments& arguments_;
  Clock::time_point start_;
  double first_s_ = 0;
  WarningChanges warnings_;
  TrackPoint last_;  ///< that was sent
  std::uint64_t sent_ = 0;
  double late_s_ = 0;
  bool says_bearing_ = true;  ///< with the next pose
};

/// Mistakes of a file are told before anything moves.
void read_through(TrackReader& track) {
  TrackPoint point;
  while (track.next(point, kLook) == TrackReader::Got::point) {
  }
  track.rewind();
}

void run(const FlyArguments& arguments) {
  const DatagramSource& datagrams = arguments.datagrams;
  if (arguments.track.empty() == !datagrams.wanted())
    throw InputError(
        "fly: found " +
        std::string(arguments.track.empty() ? "no TRACK" : "TRACK and --udp, --dis or --targets") +
        "; allowed: one of TRACK, --udp PORT, --dis SITE:APP:ENTITY, --targets");
  if (datagrams.dis && datagrams.entity.empty() && !datagrams.targets.wanted)
    throw InputError("--dis: found no entity; allowed: SITE:APP:ENTITY, or --targets beside it");
  if (datagrams.is_dis() && arguments.height_unit_m != 1)
    throw InputError("--height-unit: found ft with --dis; allowed: m, in which PDUs are");
  if (datagrams.wanted() && arguments.speed != 1)
    throw InputError("--speed: found " + toml_number(arguments.speed) +
                     " with --udp or --dis; allowed: with TRACK; --time-rate is of datagrams");
  heed_interrupts();
  if (datagrams.is_dis() && datagrams.entity.empty()) {
    client::Client client = connect_to_server(arguments.server, "obliq fly");
    const auto& radars = client.welcome().radars();
    const std::string radar =
        arguments.server.radar.empty() && !radars.empty() ? radars[0] : arguments.server.radar;
    return feed_targets(std::move(client), datagrams, radar, arguments.reconnect_s);
  }
  if (datagrams.wanted()) {
    client::Client client = connect_to_server(arguments.server, "obliq fly");
    const std::string radar = choose_flown(client, arguments.server);
    return fly_by_datagrams(std::move(client), radar, datagrams, arguments.rate_hz, arguments.reference,
                            arguments.height_unit_m, arguments.reconnect_s);
  }
  TrackReader track(arguments.track, arguments.height_unit_m);
  if (track.is_file()) read_through(track);
  client::ResumeOptions resume = reconnecting(arguments.reconnect_s);
  resume.give_up = [] { return interrupted(); };
  client::ResumingClient client(connect_to_server(arguments.server, "obliq fly"), resume);
  const std::string radar = choose_flown(client.client(), arguments.server);
  require(client.claim(radar, wire::kPoseClaim));
  Flight flight(client, radar, arguments);
  TrackPoint point;
  bool flying = true;
  while (flying) {
    const TrackReader::Got got = track.next(point, kLook);
    if (got == TrackReader::Got::end) break;
    flying = got == TrackReader::Got::point ? flight.fly_to(point, track.where()) : flight.wait_a_moment();
  }
  wire::RadarInfo info;
  require(client.client().get_radar(radar, info));
  require(client.client().release_control(radar));
  if (flight.has_begun()) flight.print_summary(flying ? "flown" : "interrupted", info.pose());
}

}  // namespace

void add_fly(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("fly",
                         "Fly a server's radar, or a platform with all its radars, along a track, while "
                         "others may turn the knobs; Ctrl-C ends it, the radar stays where it "
                         "is and is released");
  auto arguments = std::make_shared<FlyArguments>();
  add_server_arguments(*command, arguments->server);
  command->add_option(
      "TRACK", arguments->track,
      "A file with lines of time,latitude,longitude,height,bearing in s, degrees, degrees, m, degrees "
      "(with or without a header, which may name further columns: velocity_north_m_s, velocity_east_m_s, "
      "velocity_up_m_s, or these in knots by _kt, roll_deg, pitch_deg; others are ignored; height_ft is in "
      "feet), or - for the standard input");
  add_datagram_options(*command, arguments->datagrams);
  add_reconnect_argument(*command, arguments->reconnect_s);
  command->add_option("--speed", arguments->speed, "Speed factor: 2 flies the track twice as fast")
      ->type_name("FACTOR")
      ->default_val(1.0)
      ->check(number_from(kSlowest, kFastest));
  command
      ->add_option("--rate", arguments->rate_hz,
                   "Send poses between the lines, or between an entity's PDUs, at this rate; 0: none")
      ->type_name("HZ")
      ->default_val(kUsualRate_hz)
      ->check(number_from(0, kMostRate_hz));
  command
      ->add_option("--height-reference", arguments->reference,
                   "Reference of the heights; default: that of the radar's present height")
      ->check(CLI::IsMember({"datum", "ground", "ellipsoid"}));
  command
      ->add_option_function<std::string>(
          "--height-unit",
          [arguments](const std::string& unit) { arguments->height_unit_m = unit == "ft" ? kFoot_m : 1; },
          "Of TRACK's and --udp's heights, where a header names none; default: m")
      ->type_name("UNIT")
      ->check(CLI::IsMember({"m", "ft"}));
  command->callback([arguments, command] {
    arguments->datagrams.dis = command->count("--dis") > 0;
    run(*arguments);
  });
}

}  // namespace obliq
