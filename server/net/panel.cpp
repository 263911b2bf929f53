#include "server/net/panel.h"

#include <algorithm>
#include <future>
#include <utility>

#include "proto/obliq.pb.h"
#include "server/control/planes_per_bin.h"
#include "server/control/settings_message.h"
#include "server/net/aim.h"
#include "server/net/peer.h"
#include "server/net/requests/requests.h"
#include "server/net/room.h"
#include "server/radar/frame_plan.h"
#include "server/stream/frame_encoder.h"
#include "terrain/base/units.h"

namespace obliq::net {
namespace {

/// A change on its way to the io thread. Taken once: by the io thread, which makes it, or by the caller,
/// which gives it up.
struct Errand {
  std::atomic<bool> taken = false;
  std::promise<PanelAnswer> answer;

  bool take() { return !taken.exchange(true); }
};

/// What no client may hold for the change to be the console's.
wire::ClaimSet claims_for(const PanelChange& change) {
  wire::ClaimSet claims = 0;
  if (change.rate_limit_hz || change.pattern_file) claims |= wire::kSettingsClaim;
  for (const auto& [parameter, value] : change.settings) {
    const bool flies = parameter->message == WireMessage::pose && !parameter->meaning.aim;
    claims |= flies ? wire::kPoseClaim : wire::kSettingsClaim;
  }
  return claims;
}

/// Of a pose, the fields that the change names.
wire::Pose pose_message(const PanelChange& change, const PoseSettings& pose) {
  wire::Pose all;
  write_message(pose, all);
  std::vector<const google::protobuf::FieldDescriptor*> fields;
  all.GetReflection()->ListFields(all, &fields);
  for (const auto* field : fields)
    if (std::ranges::none_of(change.settings, [&](const PanelChange::Setting& s) {
          return s.parameter->message == WireMessage::pose && s.parameter->wire_field == field->name();
        }))
      all.GetReflection()->ClearField(&all, field);
  return all;
}

}  // namespace

Panel::Panel(Room& room, Post post)
    : room_(room), post_(std::move(post)), paces_(room.radars().all().size()), statuses_(paces_.size()) {
  for (const LiveRadar& radar : room.radars().all()) names_.push_back(radar.name);
  publish();
}

std::shared_ptr<const PanelStatus> Panel::status(std::size_t radar) const {
  const std::lock_guard lock(mutex_);
  return statuses_.at(radar);
}

void Panel::refresh() {
  if (refreshing_.exchange(true)) return;  // one on its way is enough
  post_([this] {
    refreshing_ = false;
    publish();
  });
}

PanelAnswer Panel::change(std::size_t radar, PanelChange change, std::chrono::milliseconds deadline) {
  const auto errand = std::make_shared<Errand>();
  std::future<PanelAnswer> answer = errand->answer.get_future();
  post_([this, errand, radar, change = std::move(change)] {
    if (errand->take()) errand->answer.set_value(perform(radar, change));
  });
  if (answer.wait_for(deadline) != std::future_status::ready && errand->take()) return {};
  return answer.get();
}

void Panel::command(std::size_t radar, PanelChange change) {
  post_([this, radar, change = std::move(change)] { (void)perform(radar, change); });
}

void Panel::set_initial(const std::string& radar, const RadarConfig& config) {
  room_.radars().find(radar)->initial = config;
}

PanelAnswer Panel::apply(const std::string& radar, const PanelChange& change) {
  const auto at = std::ranges::find(names_, radar);
  return perform(static_cast<std::size_t>(at - names_.begin()), change);
}

PanelAnswer Panel::perform(std::size_t index, const PanelChange& change) {
  LiveRadar& radar = room_.radars().at(index);
  PanelAnswer answer;
  try {
    answer = set(radar, change);
  } catch (const std::exception& e) {  // no memory, above all
    answer = {
        PanelVerdict::invalid, {{"radar", failure_text(e), "a change that there is memory for"}}, {}, {}};
  }
  publish();
  return answer;
}

PanelAnswer Panel::set(LiveRadar& radar, const PanelChange& change) {
  if (const std::string held = radar.claims.sentence(claims_for(change), nullptr); !held.empty())
    return {PanelVerdict::controlled, {}, {}, held};

  RadarConfig config{radar.name, radar.settings.current()->settings, radar.pose};
  bool new_settings = false;
  bool new_pose = false;
  NamedAngles named;
  const Hand hand = hand_of(radar.claims, nullptr);
  std::vector<FieldError> errors;
  std::optional<OverLimit> over;
  const auto ends = [](const PanelChange::Setting& s) { return ends_velocity(*s.parameter); };
  if (std::ranges::any_of(change.settings, ends)) config.pose.clear_velocity();
  for (const auto& [parameter, value] : change.settings) {
    if (radar.platform && parameter->message == WireMessage::pose && !parameter->meaning.aim)
      errors.push_back(no_pose_of_its_own(radar, std::string(parameter->key.name)));
    if (auto error = store(parameter->key, parameter->slot(config), value)) errors.push_back(*error);
    (parameter->message == WireMessage::pose ? new_pose : new_settings) = true;
    named.bearing |= parameter->wire_field == "bearing_deg";
    named.heading |= parameter->wire_field == "heading_deg";
  }
  settle_planes(config.settings, std::ranges::any_of(change.settings, [](const PanelChange::Setting& s) {
                  return s.parameter->key.name == "frustum.pixel_columns";
                }));
  if (change.pattern_file) {
    config.settings.beam.file = *change.pattern_file;
    new_settings = true;
  }
  if (change.rate_limit_hz)
    if (auto fault = room_.rate_limit_fault(*change.rate_limit_hz)) errors.push_back(std::move(*fault));
  if (new_settings || new_pose) append(errors, validate(config));
  if (new_settings && errors.empty()) errors = room_.renderer().scene_faults(config.settings);
  if (new_settings && errors.empty()) {
    over = room_.over_live_limit(config.settings, wire::kAllPlanes);
    if (over) errors.push_back(over->field);
  }
  wire::Pose asked;
  if (new_pose) asked = pose_message(change, config.pose);
  if (errors.empty() && new_pose) {
    resolve_angles(hand, named, radar.has_heading, radar.pose, config.pose);
    errors = room_.renderer().place(config.pose);
  }
  // What the ground decides shows as the radar's fault, as after a move.
  if (errors.empty() && (new_settings || config.pose.tilt_deg != radar.pose.tilt_deg))
    errors = known_beam_faults(config.settings, config.pose).value_or(errors);
  if (!errors.empty()) return {PanelVerdict::invalid, std::move(errors), std::move(over), {}};

  // Nothing is left that can be refused.
  constexpr auto kConsole = "the operator's console";
  const RadarSettings settings_before = radar.settings.current()->settings;
  const PoseSettings pose_before = radar.pose;
  const auto switches_before = ExerciseLog::switches_of(radar);
  Radars& radars = room_.radars();
  if (new_settings) (void)radar.settings.set(config.settings);
  radar.has_heading |= named.heading;
  if (new_pose && (hand == Hand::operates || radar.platform)) {
    radars.aim(radar, config.pose);
  } else if (new_pose) {
    (void)radars.take_pose(radar, config.pose, false);
  }
  if (change.rate_limit_hz) radar.rate_limit_hz = *change.rate_limit_hz;
  if (new_settings || new_pose || change.clear_faults) radars.publish_view(radar);
  if (new_settings) radars.check_windows(radar);
  radars.flip(radar, {change.transmit, change.freeze}, kConsole);
  if (new_settings) room_.log().set(radar, settings_before, kConsole);
  if (only_aims(asked)) room_.log().aimed(radar, pose_before, asked, kConsole);
  room_.log().switched(radar, switches_before, kConsole);
  if (change.reset) room_.exercise().reset(radar.name, kConsole);
  if (change.exercise_freeze) room_.exercise().freeze(*change.exercise_freeze, kConsole);
  radars.update_demand(radar);
  return {PanelVerdict::done, {}, {}, {}};
}

void Panel::publish() {
  ++heartbeat_;
  const RoomStatistics all = room_.statistics();
  std::vector<std::shared_ptr<const PanelStatus>> fresh;
  for (std::size_t i = 0; i < names_.size(); ++i)
    fresh.push_back(std::make_shared<const PanelStatus>(look(i, all)));
  const std::lock_guard lock(mutex_);
  statuses_.swap(fresh);
}

PanelStatus Panel::look(std::size_t index, const RoomStatistics& all) {
  const LiveRadar& radar = room_.radars().at(index);
  const auto now = Clock::now();
  Pace& pace = paces_[index];
  const double elapsed_s = to_seconds(now - pace.since);
  if (elapsed_s >= 1) pace = {now, radar.frames, static_cast<double>(radar.frames - pace.frames) / elapsed_s};
  const SettingsPtr settings = radar.settings.current();
  PanelStatus status;
  status.config = {radar.name, settings->settings, radar.pose};
  status.settings_version = settings->version;
  status.rate_limit_hz = radar.rate_limit_hz;
  status.transmit = radar.transmit;
  status.frozen = radar.frozen;
  status.exercise_frozen = room_.exercise().is_frozen();
  const PoseAt now_at = radar.poses->at(stream::monotonic_ns());
  status.pose_stale = now_at.stale;
  status.at_gimbal_limit = !limit_met(radar.initial.mount, settings->settings, now_at.pose).empty();
  if (const Peer* flyer = radar.claims.holder(wire::Claim::pose)) status.controller = flyer->name;
  if (const Peer* hand = radar.claims.holder(wire::Claim::settings)) status.settings_controller = hand->name;
  status.faults = radar.faults;
  status.clients = static_cast<std::uint32_t>(all.clients);
  status.watchers = static_cast<std::uint32_t>(radar.watchers.size());
  status.rate_hz = pace.rate_hz;
  status.frames = radar.frames;
  status.frame_time_s = radar.last_render_s;
  status.rays = radar.rays;
  status.hits = radar.hits;
  status.coverage = radar.coverage;
  status.frames_dropped = all.frames_dropped;
  status.uptime_s = to_seconds(room_.uptime());
  status.heartbeat = heartbeat_;
  return status;
}

}  // namespace obliq::net
