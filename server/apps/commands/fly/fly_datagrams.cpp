#include "server/apps/commands/fly/fly_datagrams.h"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <utility>
#include <vector>

#include "proto/error_number.h"
#include "proto/obliq.pb.h"
#include "server/apps/commands/arguments/number_option.h"
#include "server/apps/commands/arguments/server_arguments.h"
#include "server/apps/commands/arguments/stream_arguments.h"
#include "server/apps/commands/fly/fly_news.h"
#include "server/apps/commands/fly/pdu_source.h"
#include "server/apps/dis/ownship.h"
#include "server/apps/scene_arguments.h"
#include "terrain/base/errors.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

// An entity that sends no PDU for so long has gone: 2.4 heartbeats of 5 s, IEEE 1278.1-2012, 4.2.8.
constexpr double kDisTimeout_s = 12;
constexpr milliseconds kLook{10};
// Between orders that are passed on to the server, however fast they come.
constexpr milliseconds kPause{1000};
// A datagram that is older than the newest by more has not been overtaken on its way: the clock was set back.
constexpr std::int64_t kReordered_ns = 1'000'000'000;
constexpr std::chrono::nanoseconds kOvertaken{kReordered_ns};

std::optional<EntityId> entity_of(const DatagramSource& source) {
  if (source.entity.empty()) return std::nullopt;
  const auto entity = parse_entity_id(source.entity);
  if (!entity)
    throw InputError(
        fmt::format("--dis: found \"{}\"; allowed: SITE:APP:ENTITY, each 0 to 65535", source.entity));
  return entity;
}

/// Forwards poses; counts and reports datagrams that are not poses.
class Ride {
 public:
  void note_loss() {
    lost_ = true;
    if (feed_) feed_->note_loss();
  }

  Ride(client::ResumingClient& client, std::string radar, const DatagramSource& source, double rate_hz,
       const std::string& height_reference, double height_unit_m)
      : client_(client),
        radar_(std::move(radar)),
        source_(source),
        rate_hz_(rate_hz),
        height_unit_m_(height_unit_m),
        entity_(entity_of(source)),
        datagrams_(source, radar_) {
    if (height_reference == "datum") reference_ = wire::DATUM;
    if (height_reference == "ground") reference_ = wire::GROUND;
    if (height_reference == "ellipsoid" || entity_) reference_ = wire::ELLIPSOID;
    if (source.targets.wanted) feed_.emplace(client, news_, source, entity_, start_, radar_);
  }

  void run() {
    while (!interrupted()) {
      // Heartbeats are answered, and an admin's takeover is detected. A lost connection is taken up again.
      const client::Status status = client_.receive(milliseconds(0));
      if (status.outcome != client::Outcome::timed_out) require(status);
      if (lost_) back_again();
      take();
      if (entity_) reckon();
      if (feed_) feed();
      if (Clock::now() >= next_order_ && is_frozen_ != stopped_since_.has_value()) freeze();
      news_.tell_what_is_due();
    }
    news_.tell_the_rest();
  }

  void print_summary() const {
    std::printf("%s: %llu poses, %llu datagrams that were none%s%s\n", radar_.c_str(),
                static_cast<unsigned long long>(sent_), static_cast<unsigned long long>(news_.refused()),
                datagrams_.losses().c_str(), entity_ ? (", " + datagrams_.understood()).c_str() : "");
    if (feed_) std::printf("targets: %s\n", feed_->summary().c_str());
  }
  void release_targets() {
    if (feed_) feed_->release();
  }

 private:
  /// The server may be another one, without the earlier state; poses that came meanwhile are old.
  void back_again() {
    lost_ = false;
    says_bearing_ = true;
    if (!entity_) (void)datagrams_.take(milliseconds(0));
  }

  void take() {
    if (entity_)
      return datagrams_.take(kLook, news_,
                             [this](const Pdu& pdu, Clock::time_point stamped, Clock::time_point arrived) {
                               take(pdu, stamped, arrived);
                             });
    const Datagrams came = datagrams_.take(kLook);
    for (const Datagrams::One& one : came.all) take_pose(came.of(one));
  }

  void take_pose(std::span<const std::byte> bytes) {
    const auto read = read_pose_datagram(bytes);
    if (const auto* none = std::get_if<NoPose>(&read)) return news_.refuse(none->why);
    const OwnshipPose& pose = std::get<OwnshipPose>(read);
    const bool set_back = clock_ns_ && pose.sim_time_ns < *clock_ns_ - kReordered_ns;
    clock_ns_ = pose.sim_time_ns;
    send(pose, pose.sim_time_ns, pose.pose_id, set_back);
  }

  void take(const Pdu& pdu, Clock::time_point stamped, Clock::time_point arrived) {
    if (const auto* order = std::get_if<SimulationOrder>(&pdu)) {
      if (feed_) feed_->obey(*order, arrived);
      return obey(*order);
    }
    const EntityState& state = std::get<EntityState>(pdu);
    if (!(state.id == *entity_)) {
      if (feed_) feed_->take(state, stamped, arrived);
      return;
    }
    if (!state.active) return leave("is deactivated");
    const OwnshipPose pose = dead_reckoned(state, 0);
    if (const std::string fault = fault_of(pose); !fault.empty()) return news_.refuse(fault);
    arrived_ = arrived;
    if (newest_ && stamped < stamped_ && stamped_ - stamped < kOvertaken) return;
    has_left_ = false;
    hear_of_attitude(fault_of(attitude_of(state)));
    newest_ = state;
    stamped_ = stamped;
    if (stopped_since_) stopped_since_ = stamped;  // it goes on from there
    next_ = Clock::now();
    silent_ = false;
  }

  void feed() {
    const auto now = Clock::now();
    if (newest_) feed_->set_centre(newest_->location_m);
    if (!feed_->send(now)) return;  // run() takes it up again
    status_.tell(feed_->summary() + datagrams_.losses(), datagrams_.understood(), now);
  }

  void obey(const SimulationOrder& order) {
    if (!is_for(order.receiver, *entity_)) return;
    if (order.what == SimulationOrder::What::remove) return leave("was removed");
    const bool stops = order.what == SimulationOrder::What::stop;
    if (stops == stopped_since_.has_value()) return;
    news_.add(source_.entity + (stops ? ": stopped by its simulation's manager" : ": goes on"));
    if (stops) {
      stopped_since_ = Clock::now();
    } else {
      const auto pause = Clock::now() - *std::exchange(stopped_since_, std::nullopt);
      stamped_ += pause;
      arrived_ += pause;
    }
  }

  /// The radar as a whole, or all that ride on the platform, is as its entity.
  void freeze() {
    is_frozen_ = stopped_since_.has_value();
    next_order_ = Clock::now() + kPause;
    wire::RadarInfo info;
    if (const client::Status status = client_.client().get_radar(radar_, info); !status.ok())
      return news_.add(radar_ + ": " + status.sentence());
    if (info.riders().empty()) return freeze(radar_);
    for (const std::string& rider : info.riders()) freeze(rider);
  }
  /// Where no other client holds its settings.
  void freeze(const std::string& radar) {
    client::Client& client = client_.client();
    client::Status status = client.claim(radar, wire::kSettingsClaim);
    if (status.ok()) {
      status = client.set_state(radar, std::nullopt, is_frozen_);
      (void)client.release(radar, wire::kSettingsClaim);
    }
    if (!status.ok())
      news_.add(radar + (is_frozen_ ? " is not frozen: " : " is not thawed: ") + status.sentence());
  }

  void leave(const char* how) {
    newest_.reset();
    if (std::exchange(has_left_, true)) return;
    news_.add(source_.entity + " " + how + ": the radar stays where it is until an Entity State of it comes");
  }

  /// Between PDUs the entity goes on as its dead reckoning says.
  void reckon() {
    const auto now = Clock::now();
    if (!newest_ || now < next_ || silent_ || stopped_since_) return;
    if (seconds_since(arrived_) > kDisTimeout_s) {
      silent_ = true;
      std::fprintf(stderr,
                   "obliq: no Entity State of %s for %.0f s: the radar stays where it is until one comes\n",
                   source_.entity.c_str(), kDisTimeout_s);
      return;
    }
    const auto since_start = std::chrono::duration_cast<std::chrono::nanoseconds>(now - start_);
    send(dead_reckoned(*newest_, std::chrono::duration<double>(now - stamped_).count()), since_start.count(),
         sent_ + 1);
    next_ = rate_hz_ > 0 ? now + from_seconds(1 / rate_hz_) : Clock::time_point::max();
  }

  void send(const OwnshipPose& ownship, std::int64_t sim_time_ns, std::uint64_t pose_id,
            bool new_time_line = false) {
    wire::Pose pose;
    pose.set_latitude_deg(ownship.latitude_deg);
    pose.set_longitude_deg(ownship.longitude_deg);
    pose.set_height_m(entity_ ? ownship.height_m : ownship.height_m * height_unit_m_);
    set_heading(client_.client(), says_bearing_, ownship.heading_deg, source_.look_deg, pose);
    pose.set_sim_time_ns(sim_time_ns);
    pose.set_pose_id(pose_id);
    if (new_time_line) pose.set_new_time_line(true);
    if (source_.time_rate != 1) pose.set_time_rate(source_.time_rate);
    if (reference_) pose.set_height_reference(*reference_);
    if (const auto& velocity_m_s = ownship.velocity_m_s) {
      pose.set_velocity_north_m_s((*velocity_m_s)[0]);
      pose.set_velocity_east_m_s((*velocity_m_s)[1]);
      pose.set_velocity_up_m_s((*velocity_m_s)[2]);
    }
    if (ownship.attitude) {
      pose.set_roll_deg(ownship.attitude->roll_deg);
      pose.set_pitch_deg(ownship.attitude->pitch_deg);
    }
    if (entity_) pose.set_geoid_undulation_m(source_.undulation_m);
    wire::Ack ack;
    const client::Status status = client_.client().set_pose(radar_, pose, ack);
    if (status.outcome == client::Outcome::refused && status.number == 100)
      return news_.refuse(status.sentence());
    if (is_lost(client_, status)) return;  // run() takes it up again
    require(status);
    says_bearing_ = false;
    news_.hear({ack.warnings().begin(), ack.warnings().end()});
    ++sent_;
  }

  /// What is wrong with an entity's attitude: told when it begins.
  void hear_of_attitude(const std::string& fault) {
    const std::string what = fault.substr(0, fault.find(':'));
    if (what != attitude_fault_ && !what.empty())
      news_.add("roll and pitch are not taken, " + what + " is beyond " + fault.substr(fault.rfind(':') + 2) +
                " degrees");
    attitude_fault_ = what;
  }

  client::ResumingClient& client_;
  const std::string radar_;
  const DatagramSource& source_;
  const double rate_hz_;
  const double height_unit_m_;
  const Clock::time_point start_ = Clock::now();
  std::optional<EntityId> entity_;
  PduSource datagrams_;
  std::optional<wire::HeightReference> reference_;
  FlyNews news_;
  std::optional<TargetFeed> feed_;
  FeedStatus status_;
  std::optional<EntityState> newest_;
  Clock::time_point stamped_;  ///< when the newest was so
  Clock::time_point arrived_, next_;
  bool silent_ = false;
  bool has_left_ = false;                           ///< the exercise
  std::optional<Clock::time_point> stopped_since_;  ///< by Stop/Freeze
  bool says_bearing_ = true;                        ///< with the next pose
  bool lost_ = false;                               ///< the connection, and it is back
  std::optional<std::int64_t> clock_ns_;            ///< of the newest datagram
  std::uint64_t sent_ = 0;
  std::string attitude_fault_;  ///< which angle is beyond its limit; empty: none
  bool is_frozen_ = false;      ///< by an order
  Clock::time_point next_order_;
};

}  // namespace

void set_heading(const client::Client& client, bool first, double heading_deg, double look_deg,
                 wire::Pose& pose) {
  // A server of version 1.1 knows no heading.
  const bool knows_heading = client.welcome().minor() >= 2;
  if (knows_heading) pose.set_heading_deg(heading_deg);
  const double bearing_deg = look_deg == 0 ? heading_deg : std::remainder(heading_deg + look_deg, 360.0);
  if (first || !knows_heading) pose.set_bearing_deg(bearing_deg);
}

void add_datagram_options(CLI::App& command, DatagramSource& source) {
  command
      .add_option("--udp", source.udp_port,
                  "In place of TRACK: poses as datagrams to this UDP port (0: any free one); with --dis the "
                  "port of its PDUs")
      ->type_name("PORT")
      ->check(CLI::Range(0, 65535));
  command
      .add_option("--dis", source.entity,
                  "In place of TRACK: the ownship is this entity of a DIS exercise, by its Entity State PDUs "
                  "to port 3000 or --udp; with --targets it may be left out")
      ->type_name("SITE:APP:ENTITY")
      ->expected(0, 1);
  add_target_options(command, source.targets);
  command
      .add_option("--listen", source.address,
                  "IPv4 address to listen on; 0.0.0.0: all, for other machines; 224.0.0.0 to "
                  "239.255.255.255: a multicast "
                  "group, which is joined")
      ->type_name("ADDRESS")
      ->default_val("127.0.0.1");
  command
      .add_option(
          "--interface", source.interface,
          "With a multicast group: the network, by this machine's IPv4 address in it; without: as its "
          "routes say")
      ->type_name("ADDRESS");
  command.add_option("--exercise", source.exercise, "Only PDUs of this exercise; without: of any")
      ->type_name("ID")
      ->check(CLI::Range(0, 255));
  add_repeatable(
      command, "--allow", source.allow,
      "Only datagrams from this address or network, such as 10.0.0.0/24 (repeatable); without: from any",
      "NETWORK");
  command
      .add_option(
          "--clock", source.clock,
          "Of PDUs: arrival, or absolute: by their timestamps where they are absolute and within 5 s of "
          "this machine's UTC")
      ->default_val("arrival")
      ->check(CLI::IsMember({"arrival", "absolute"}));
  command.add_option("--look", source.look_deg, "Centre of the sector, clockwise from the heading")
      ->type_name("DEG")
      ->default_val(0.0)
      ->check(number_from(-360, 360));
  command
      .add_option(
          "--undulation", source.undulation_m,
          "With --dis, whose heights are above the ellipsoid: height of the terrain's datum above it there")
      ->type_name("M")
      ->default_val(0.0)
      ->check(number_from(-120, 120));
  command
      .add_option(
          "--time-rate", source.time_rate,
          "With --udp: seconds of the datagrams' clock in a second; 10 where the exercise runs ten times "
          "as fast")
      ->type_name("FACTOR")
      ->default_val(1.0)
      ->check(number_from(0.001, 1000));
}

bool is_lost(const client::ResumingClient& client, const client::Status& status) {
  if (status.outcome == client::Outcome::closed) return true;
  const bool is_told = status.outcome == client::Outcome::refused &&
                       status.number == static_cast<std::uint32_t>(wire::ErrorNumber::server_stopping);
  return is_told || (!status.ok() && !client.client().is_open());
}

void fly_by_datagrams(client::Client connected, const std::string& radar, const DatagramSource& source,
                      double rate_hz, const std::string& height_reference, double height_unit_m,
                      int reconnect_s) {
  Ride* riding = nullptr;
  client::ResumeOptions resume = reconnecting(reconnect_s);
  resume.give_up = [] { return interrupted(); };
  resume.on_resumed = [&riding, said = resume.on_resumed](std::chrono::duration<double> after) {
    said(after);
    if (riding != nullptr) riding->note_loss();
  };
  client::ResumingClient client(std::move(connected), resume);
  require(client.claim(radar, wire::kPoseClaim));
  Ride ride(client, radar, source, rate_hz, height_reference, height_unit_m);
  riding = &ride;
  ride.run();
  ride.print_summary();
  ride.release_targets();
  require(client.client().release_control(radar));
}

}  // namespace obliq
