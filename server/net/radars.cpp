#include "server/net/radars.h"

#include <algorithm>
#include <utility>

#include "proto/obliq.pb.h"
#include "server/log/log.h"
#include "server/log/service_log.h"
#include "server/net/exercise/exercise_log.h"
#include "server/net/peer.h"
#include "server/net/requests/requests.h"
#include "server/stream/frame_encoder.h"

namespace obliq::net {

using wire::ErrorNumber;
using wire::MessageType;

namespace {

/// Watchers of a radar that cannot be rendered are told why at most this often.
constexpr std::chrono::seconds kFaultPause{1};

}  // namespace

Radars::Radars(const ServerOptions& options, const std::vector<RadarConfig>& radars,
               rendering::RenderThread& render, ExerciseLog& log)
    : options_(options), render_(render), log_(log) {
  for (const RadarConfig& config : radars) {
    LiveRadar& radar = radars_.emplace_back(config, static_cast<std::uint32_t>(radars_.size() + 1));
    render_.add_radar(radar.name, radar.stream_id, radar.view());
    if (!config.platform) continue;
    const auto& [name, pose] = *config.platform;
    radar.platform = find_platform(name);
    if (radar.platform == nullptr) radar.platform = &platforms_.emplace_back(Platform{name, pose, pose, {}});
    radar.platform->radars.push_back(&radar);
    radar.forget_heading();
  }
}

Platform* Radars::find_platform(const std::string& name) {
  const auto at = std::ranges::find(platforms_, name, &Platform::name);
  return at == platforms_.end() ? nullptr : &*at;
}

LiveRadar* Radars::find(const std::string& name) {
  const auto at = std::ranges::find(radars_, name, &LiveRadar::name);
  return at == radars_.end() ? nullptr : &*at;
}

void Radars::unsubscribe(LiveRadar& radar, const Peer& peer) {
  const auto at = std::find_if(radar.watchers.begin(), radar.watchers.end(),
                               [&](const Watcher& watcher) { return watcher.peer == &peer; });
  if (at == radar.watchers.end()) return;
  --at->peer->subscriptions;
  at->peer->outbox.close_queue(radar.stream_id, "unsubscribed");
  radar.watchers.erase(at);
  update_demand(radar);
}

void Radars::watch(LiveRadar& radar, Peer& peer, rendering::Demand demand) {
  demand.watch_id = ++last_watch_id_;
  ++peer.subscriptions;
  peer.outbox.open_live_queue(
      radar.stream_id, demand.choice,
      demand.lossless ? stream::QueuePolicy::lossless : stream::QueuePolicy::newest_wins);
  radar.watchers.push_back({&peer, std::move(demand)});
  update_demand(radar);
}

void Radars::watch_as_the_role_allows(LiveRadar& radar, Peer& peer) {
  const auto at = std::ranges::find(radar.watchers, &peer, &Watcher::peer);
  if (at == radar.watchers.end()) return;
  rendering::Demand demand = at->demand;
  demand.lossless &= peer.role >= security::Role::controller;
  if (peer.role < truth_role(options_)) {
    demand.choice.truth = false;
    demand.choice.planes &= static_cast<wire::PlaneSet>(~wire::kTargetPlane);
  }
  if (demand.lossless == at->demand.lossless && demand.choice == at->demand.choice) return;
  std::string lost;
  if (demand.lossless != at->demand.lossless) lost = "each frame";
  if (demand.choice != at->demand.choice)
    lost += std::string(lost.empty() ? "" : " and ") + "where targets are";
  const bool is_over = demand.choice.planes == 0;
  unsubscribe(radar, peer);
  if (!is_over) watch(radar, peer, std::move(demand));
  const std::string text = "the token's role is " + std::string(security::role_name(peer.role)) +
                           " now: the subscription no longer has " + lost +
                           (is_over ? ", and has ended" : "");
  peer.send(MessageType::error, make_error(0, ErrorNumber::role_too_low, text, {}, radar.name));
  log_warning("radar {}: {}: {}", radar.name, peer.name, text);
}

void Radars::check_windows(LiveRadar& radar) const {
  const RadarSettings& settings = radar.settings.current()->settings;
  for (Watcher& watcher : radar.watchers) {
    const wire::Window& window = watcher.demand.choice.format.window;
    std::vector<FieldError> errors;
    if (window.azimuth.first >= static_cast<std::uint32_t>(settings.azimuth_bins))
      errors.push_back({"window.first_azimuth", std::to_string(window.azimuth.first),
                        "below " + std::to_string(settings.azimuth_bins)});
    if (window.range.first >= static_cast<std::uint32_t>(settings.range_bins))
      errors.push_back({"window.first_range", std::to_string(window.range.first),
                        "below " + std::to_string(settings.range_bins)});
    const bool told = std::exchange(watcher.window_lost, !errors.empty());
    if (errors.empty() || told) continue;
    watcher.peer->send(MessageType::error,
                       make_error(0, ErrorNumber::window_outside_frame,
                                  "radar " + radar.name + " no longer has the bins of this subscription",
                                  errors, radar.name));
  }
}

void Radars::update_demand(LiveRadar& radar) {
  radar.rate_hz = 0;
  std::vector<rendering::Demand> demands;
  for (const Watcher& watcher : radar.watchers) {
    rendering::Demand demand = watcher.demand;
    if (radar.rate_limit_hz > 0) demand.rate_hz = std::min(demand.rate_hz, radar.rate_limit_hz);
    radar.rate_hz = std::max(radar.rate_hz, demand.rate_hz);
    demands.push_back(std::move(demand));
  }
  if (!radar.transmit) demands.clear();
  render_.set_demand(radar.number(), std::move(demands));
}

void Radars::send_fault(const LiveRadar& radar, Peer& peer) const {
  peer.send(MessageType::error,
            make_error(0, ErrorNumber::invalid_value, "radar " + radar.name + " cannot be rendered as it is",
                       radar.faults, radar.name));
}

void Radars::claim(LiveRadar& radar, wire::ClaimSet claims, Peer& by) {
  const wire::ClaimSet taken = take_over(radar, claims, by);
  const auto fresh = static_cast<wire::ClaimSet>(claims & ~radar.claims.of(by));
  if (fresh != 0) log_doing(by, radar.name, wire::claim_names(fresh) + " claimed by " + by.name);
  radar.claims.give(fresh, by);
  if (fresh != taken) log_.claimed(&radar, static_cast<wire::ClaimSet>(fresh & ~taken), by.name);
}

wire::ClaimSet Radars::release(LiveRadar& radar, wire::ClaimSet claims, const Peer& peer) {
  const wire::ClaimSet released = end_claims(radar, claims, peer);
  if (released != 0) log_.released(&radar, released, peer.name);
  return released;
}

wire::ClaimSet Radars::end_claims(LiveRadar& radar, wire::ClaimSet claims, const Peer& peer) {
  const wire::ClaimSet released = radar.claims.release(claims, peer);
  if ((released & wire::kPoseClaim) == 0) return released;
  radar.forget_heading();
  radar.pose.valid_s = radar.initial.pose.valid_s;
  radar.pose.time_rate = radar.initial.pose.time_rate;
  if (Platform* platform = radar.platform) {
    platform->pose.valid_s = platform->initial.valid_s;
    platform->pose.time_rate = platform->initial.time_rate;
  }
  radar.poses->set_validity(radar.pose.valid_s);
  radar.poses->restart();
  return released;
}

wire::ClaimSet Radars::take_over(LiveRadar& radar, wire::ClaimSet claims, Peer& by) {
  wire::ClaimSet all = 0;
  wire::for_each_claim(claims, [&](wire::Claim claim) {
    Peer* holder = radar.claims.holder(claim);
    if (holder == nullptr || holder == &by) return;
    const wire::ClaimSet taken = end_claims(radar, claims, *holder);
    all |= taken;
    log_.taken_over(&radar, taken, holder->name, by.name);
    log_as_guest(*holder);
    log_as_guest(by);
    const std::string told =
        "radar " + radar.name + ": " + wire::claim_names(taken) + " taken over by " + by.name;
    holder->send(MessageType::error, make_error(0, ErrorNumber::controlled_by_other, told, {}, radar.name));
    log_warning("radar {}: {} takes {} from {}; give it a token of another role if it should not", radar.name,
                by.name, wire::claim_names(taken), holder->name);
  });
  return all;
}

void Radars::forget(Peer& peer) {
  for (LiveRadar& radar : radars_) {
    unsubscribe(radar, peer);
    if (const wire::ClaimSet released = release(radar, wire::kEveryClaim, peer))
      log_doing(peer, radar.name, wire::claim_names(released) + " released, " + peer.name + " has left");
  }
}

void Radars::check_role(Peer& peer) {
  for (LiveRadar& radar : radars_) watch_as_the_role_allows(radar, peer);
  if (peer.role >= security::Role::controller) return;
  for (LiveRadar& radar : radars_) {
    const wire::ClaimSet released = release(radar, wire::kEveryClaim, peer);
    if (released == 0) continue;
    log_warning("radar {}: {} released, the role of {} is {} now", radar.name, wire::claim_names(released),
                peer.name, security::role_name(peer.role));
    peer.send(MessageType::error, make_error(0, ErrorNumber::role_too_low,
                                             "control of radar " + radar.name +
                                                 " needs the role controller; this client's token gives " +
                                                 std::string(security::role_name(peer.role)) + " now",
                                             {}, radar.name));
  }
}

void Radars::set_view(LiveRadar& radar) {
  if (radar.frozen || held_) return;  // the radar keeps what it shows after the thaw
  radar.faults.clear();
  render_.set_view(radar.number(), radar.view());
}

void Radars::publish_view(LiveRadar& radar) {
  set_view(radar);
  tell_places();
}

bool Radars::take_pose(LiveRadar& radar, const PoseSettings& pose, bool has_sim_time) {
  const std::int64_t now_ns = stream::monotonic_ns();
  if (has_sim_time) {
    if (!radar.poses->add(pose, now_ns)) return false;
  } else {
    radar.poses->set(pose, now_ns);
  }
  radar.pose = pose;
  radar.pose_received_ns = now_ns;
  radar.pose_has_sim_time = has_sim_time;
  return true;
}

void Radars::aim(LiveRadar& radar, const PoseSettings& as) {
  radar.pose = as;
  radar.poses->aim(as);
  publish_view(radar);
}

void Radars::hold_view(const LiveRadar& radar) {
  rendering::LiveView held = radar.shown();
  held.poses = nullptr;
  render_.set_view(radar.number(), std::move(held));
}

void Radars::hold(bool on) {
  held_ = on;
  render_.hold(on);
  for (LiveRadar& radar : radars_)
    if (!radar.frozen) show(radar);
}

void Radars::show(LiveRadar& radar) {
  publish_view(radar);
  if (held_) hold_view(radar);
}

void Radars::flip(LiveRadar& radar, const RadarSwitches& wanted, const std::string& by) {
  if (wanted.freeze && *wanted.freeze != radar.frozen) {
    log_info("radar {}: {} by {}", radar.name, *wanted.freeze ? "frozen" : "thawed", by);
    radar.frozen = *wanted.freeze;
    if (radar.frozen && !held_) hold_view(radar);
    if (!radar.frozen) {
      publish_view(radar);
    }
  }
  if (wanted.transmit && *wanted.transmit != radar.transmit) {
    log_info("radar {}: transmit {} by {}", radar.name, *wanted.transmit ? "on" : "off", by);
    radar.transmit = *wanted.transmit;
    update_demand(radar);
  }
}

bool Radars::move(LiveRadar& radar, const PoseSettings& pose, bool has_sim_time) {
  if (!take_pose(radar, pose, has_sim_time)) return false;
  // The render thread reads the time line by itself; only a pose that applies at once has to wake it.
  if (has_sim_time) {
    tell_places();
  } else {
    publish_view(radar);
  }
  return true;
}

bool Radars::move(Platform& platform, const std::vector<PoseSettings>& poses, bool has_sim_time) {
  const auto is_late = [&](const LiveRadar* radar) {
    return has_sim_time && radar->poses->is_late(poses.front().sim_time_ns);
  };
  const bool late = std::ranges::any_of(platform.radars, is_late);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    LiveRadar& radar = *platform.radars[i];
    if (late && !is_late(&radar)) continue;
    (void)take_pose(radar, poses[i], has_sim_time);  // one that is late counts it
    if (!has_sim_time) set_view(radar);
  }
  tell_places();
  return !late;
}

void Radars::tell_places() const {
  if (!options_.on_moved) return;
  std::vector<RadarPlace> places;
  for (const LiveRadar& radar : radars_)
    places.push_back(
        {{radar.pose.longitude_deg, radar.pose.latitude_deg}, radar.settings.current()->settings.r_max_m});
  options_.on_moved(std::move(places));
}

void Radars::note_ground(LiveRadar& radar, const std::string& warning) {
  const bool was_off = std::exchange(radar.off_the_map, !warning.empty());
  if (was_off == radar.off_the_map) return;
  const LogFields fields{{"radar", radar.name}};
  if (was_off) {
    log_info("radar {}: is over ground that files cover again", radar.name);
  } else {
    log_warning("radar {}: {}; name files of that ground in terrain.dem, or bring it back", radar.name,
                warning);
  }
}

void Radars::deliver(std::size_t number, const stream::LiveFramePtr& frame,
                     const std::vector<stream::BlockPtr>& blocks) {
  for (const Watcher& watcher : radars_[number].watchers) {
    if (!frame->is_for(watcher.demand.watch_id)) continue;
    for (const stream::BlockPtr& block : blocks) watcher.peer->outbox.push(block, frame);
    watcher.peer->kick();
  }
}

void Radars::count(std::size_t number, const rendering::RenderedFrame& frame) {
  LiveRadar& radar = radars_[number];
  ++radar.frames;
  radar.last_render_s = frame.render_s;
  radar.coverage = frame.coverage;
  radar.rays = frame.rays;
  radar.hits = frame.hits;
  radar.faults.clear();
  radar.dwells_missed += frame.dwells_missed;
  if (options_.on_frame) options_.on_frame(radar.name, frame);
}

void Radars::relieve(std::size_t number, double held_up_s) {
  net::relieve(radars_[number], options_, held_up_s);
}

void Radars::note_fault(std::size_t number, const rendering::LiveView& view,
                        const std::vector<FieldError>& errors) {
  LiveRadar& radar = radars_[number];
  // Its controller may have corrected it in the meantime.
  if (!radar.frozen) {
    if (view.settings != radar.settings.current()) return;
    if (!radar.pose_has_sim_time && view.pose_received_ns != radar.pose_received_ns) return;
  }
  radar.faults = errors;
  // A pose that moves on brings a new fault with every frame.
  const auto now = std::chrono::steady_clock::now();
  if (radar.faults_settings == view.settings && now < radar.faults_told + kFaultPause) return;
  radar.faults_settings = view.settings;
  radar.faults_told = now;
  const LogFields fields{{"radar", radar.name}};
  for (const FieldError& error : errors)
    log_warning("radar {}: {}; no frames until its settings or its pose are changed", radar.name,
                error.text());
  for (const Watcher& watcher : radar.watchers) send_fault(radar, *watcher.peer);
}

}  // namespace obliq::net
