#include "server/net/requests/requests.h"

#include <string>
#include <type_traits>

#include "proto/limits.h"
#include "proto/obliq.pb.h"
#include "server/control/parameters.h"
#include "server/control/settings_message.h"
#include "server/net/peer.h"
#include "server/net/rights.h"
#include "server/net/room.h"
#include "server/radar/frame_plan.h"
#include "server/stream/frame_encoder.h"
#include "terrain/base/text.h"
#include "terrain/base/units.h"

namespace obliq::net {

using wire::ErrorNumber;
using wire::MessageType;

namespace {

/// Requests that a renderer which only replays must refuse.
template <typename Request>
constexpr bool changes_something =
    std::is_same_v<Request, wire::ClaimControl> || std::is_same_v<Request, wire::SetSettings> ||
    std::is_same_v<Request, wire::SetPose> || std::is_same_v<Request, wire::SetState> ||
    std::is_same_v<Request, wire::RenderOnce> || std::is_same_v<Request, wire::QueryGround> ||
    std::is_same_v<Request, wire::ResetExercise> || std::is_same_v<Request, wire::GetExercise> ||
    std::is_same_v<Request, wire::LoadExercise> || std::is_same_v<Request, wire::SetExercise> ||
    std::is_same_v<Request, wire::SetTargets> || std::is_same_v<Request, wire::GetTargets>;

/// Requests that are answered in their order also where the render thread has to be asked.
template <typename Request>
constexpr bool is_in_turn =
    std::is_same_v<Request, wire::SetSettings> || std::is_same_v<Request, wire::Subscribe> ||
    std::is_same_v<Request, wire::RenderOnce>;

/// What RadarInfo and RadarStatus both say of a radar.
template <typename Message>
void write_condition(const LiveRadar& radar, Message& to) {
  to.set_radar(radar.name);
  if (const Peer* flyer = radar.claims.holder(wire::Claim::pose)) to.set_controller(flyer->name);
  if (const Peer* hand = radar.claims.holder(wire::Claim::settings)) to.set_settings_controller(hand->name);
  to.set_subscribers(static_cast<std::uint32_t>(radar.watchers.size()));
  to.set_rate_hz(radar.rate_hz);
  to.set_settings_version(radar.settings.current()->version);
  to.set_fault(radar.faults.empty() ? "" : radar.faults.front().text());
  to.set_transmit_off(!radar.transmit);
  to.set_frozen(radar.frozen);
  to.set_rate_limit_hz(radar.rate_limit_hz);
  const PoseAt now = radar.poses->at(stream::monotonic_ns());
  to.set_pose_stale(now.stale);
  to.set_gimbal(limit_met(radar.initial.mount, radar.settings.current()->settings, now.pose));
  to.set_late_poses(radar.poses->late());
  if (radar.platform) to.set_platform(radar.platform->name);
}

}  // namespace

wire::Error make_error(std::uint64_t request_id, ErrorNumber number, const std::string& text,
                       const std::vector<FieldError>& fields, const std::string& radar) {
  wire::Error error;
  error.set_request_id(request_id);
  error.set_number(static_cast<std::uint32_t>(number));
  error.set_text(text);
  error.set_radar(radar);
  // A message has a limit; who has made so many mistakes sees what they are.
  constexpr int kMostFields = 50;
  for (const FieldError& field : fields) {
    if (error.fields_size() == kMostFields) {
      error.set_text(text + " (the first " + std::to_string(kMostFields) + " of " +
                     std::to_string(fields.size()) + " reasons)");
      break;
    }
    wire::FieldFault& fault = *error.add_fields();
    // A message has a limit, and what was found may be as long as the request.
    constexpr std::size_t kMostFound = 1000;
    fault.set_field(field.field);
    fault.set_found(field.found.size() <= kMostFound ? field.found
                                                     : printable_text(field.found, kMostFound) + "... (" +
                                                           std::to_string(field.found.size()) + " bytes)");
    fault.set_allowed(field.allowed);
  }
  return error;
}

std::string presentable(const std::string& text) { return printable_text(text, wire::kMaxNameBytes); }

std::vector<FieldError> missing_position(const wire::Pose& pose) {
  std::vector<FieldError> errors;
  const auto demand = [&](bool there, const char* field) {
    if (!there) errors.push_back({field, "nothing", "a value: a frame needs an antenna"});
  };
  demand(pose.has_latitude_deg(), "latitude_deg");
  demand(pose.has_longitude_deg(), "longitude_deg");
  demand(pose.has_height_m(), "height_m");
  return errors;
}

template <typename Request>
void Requests::answer(std::span<const std::byte> descriptor, void (Requests::*function)(const Request&)) {
  Request request;
  if (!wire::parse_descriptor(descriptor, request))
    return peer_.fail(ErrorNumber::bad_message, "the protobuf part of a request does not parse");
  id_ = request.request_id();
  if (right_ != nullptr && !demand(right_->role, "this request")) return;
  if (right_ != nullptr && right_->truth && !demand_truth()) return;
  if (changes_something<Request>) {
    if (const std::string why = room_.renderer().fixed(); !why.empty())
      return refuse(ErrorNumber::replay_only, why);
  }
  if (is_in_turn<Request> && comes_later()) return;
  (this->*function)(request);
}

bool Requests::comes_later() {
  if (its_turn_ || peer_.in_turn.empty()) return false;
  const auto most = static_cast<std::size_t>(room_.options().max_renders_queued);
  is_kept_ = peer_.in_turn.size() < most;
  if (!is_kept_)
    refuse(ErrorNumber::too_many_renders,
           "too many unanswered requests: max_renders_queued is " + std::to_string(most));
  return true;
}

std::optional<std::vector<FieldError>> Requests::beam_faults_of(const RadarSettings& settings,
                                                                std::uint64_t version,
                                                                const PoseSettings& pose) {
  if (auto known = known_beam_faults(settings, pose)) return known;
  // Another may have changed the radar meanwhile.
  if (appraised_ != nullptr && appraised_->version == version) return appraised_->faults;
  room_.appraise(
      peer_, std::make_shared<rendering::Appraisal>(rendering::Appraisal{0, settings, version, pose, {}}));
  is_kept_ = true;
  return std::nullopt;
}

void Requests::handle(MessageType type, std::span<const std::byte> descriptor) {
  if (type == MessageType::hello) return answer(descriptor, &Requests::hello);
  if (peer_.greeted) return handle_greeted(type, descriptor);
  peer_.fail(
      ErrorNumber::handshake_expected,
      "message type: found " + std::to_string(static_cast<unsigned>(type)) + "; allowed: Hello (1) first");
}

void Requests::handle_greeted(MessageType type, std::span<const std::byte> descriptor) {
  log_request(peer_, type);
  right_ = right_of(type);
  switch (type) {
    case MessageType::heartbeat:
      return answer(descriptor, &Requests::heartbeat);
    case MessageType::list_radars:
      return answer(descriptor, &Requests::list_radars);
    case MessageType::get_radar:
      return answer(descriptor, &Requests::get_radar);
    case MessageType::claim_control:
      return answer(descriptor, &Requests::claim_control);
    case MessageType::release_control:
      return answer(descriptor, &Requests::release_control);
    case MessageType::set_settings:
      return answer(descriptor, &Requests::set_settings);
    case MessageType::set_pose:
      return answer(descriptor, &Requests::set_pose);
    case MessageType::set_state:
      return answer(descriptor, &Requests::set_state);
    case MessageType::set_replay:
      return answer(descriptor, &Requests::set_replay);
    case MessageType::subscribe:
      return answer(descriptor, &Requests::subscribe);
    case MessageType::unsubscribe:
      return answer(descriptor, &Requests::unsubscribe);
    case MessageType::render_once:
      return answer(descriptor, &Requests::render_once);
    case MessageType::get_status:
      return answer(descriptor, &Requests::get_status);
    case MessageType::query_ground:
      return answer(descriptor, &Requests::query_ground);
    case MessageType::reset_exercise:
      return answer(descriptor, &Requests::reset_exercise);
    case MessageType::get_exercise:
      return answer(descriptor, &Requests::get_exercise);
    case MessageType::load_exercise:
      return answer(descriptor, &Requests::load_exercise);
    case MessageType::set_exercise:
      return answer(descriptor, &Requests::set_exercise);
    case MessageType::set_targets:
      return answer(descriptor, &Requests::set_targets);
    case MessageType::get_targets:
      return answer(descriptor, &Requests::get_targets);
    case MessageType::get_events:
      return answer(descriptor, &Requests::get_events);
    case MessageType::add_bookmark:
      return answer(descriptor, &Requests::add_bookmark);
    default:  // of a later minor version, or not for a server: skipped
      return;
  }
}

void Requests::acknowledge(std::uint64_t settings_version) {
  wire::Ack ack;
  ack.set_request_id(id_);
  ack.set_settings_version(settings_version);
  peer_.send(MessageType::ack, ack);
}

void Requests::refuse(ErrorNumber number, const std::string& text, const std::vector<FieldError>& fields) {
  peer_.send(MessageType::error, make_error(id_, number, text, fields));
}

void Requests::refuse(const OverLimit& over) { refuse(ErrorNumber::over_limit, over.text, {over.field}); }

LiveRadar* Requests::radar_of(const std::string& name) {
  LiveRadar* radar = room_.radars().find(name);
  if (radar != nullptr) return radar;
  std::string names;
  for (const LiveRadar& known : room_.radars().all()) names += (names.empty() ? "" : ", ") + known.name;
  refuse(ErrorNumber::unknown_radar, "unknown radar", {{"radar", presentable(name), names}});
  return nullptr;
}

void Requests::list_radars(const wire::ListRadars& /*request*/) {
  wire::RadarList list;
  list.set_request_id(id_);
  for (const LiveRadar& radar : room_.radars().all()) list.add_radars(radar.name);
  for (const Platform& platform : room_.radars().platforms()) list.add_platforms(platform.name);
  peer_.send(MessageType::radar_list, list);
}

void Requests::get_radar(const wire::GetRadar& request) {
  if (const Platform* platform = room_.radars().find_platform(request.radar())) return describe(*platform);
  const LiveRadar* radar = radar_of(request.radar());
  if (radar == nullptr) return;
  const SettingsPtr settings = radar->settings.current();
  wire::RadarInfo info;
  info.set_request_id(id_);
  write_message(settings->settings, *info.mutable_settings());
  write_message(radar->pose, *info.mutable_pose());
  const wire::ClaimSet mine = radar->claims.of(peer_);
  info.set_controlled_by_you((mine & wire::kPoseClaim) != 0);
  wire::for_each_claim(
      mine, [&](wire::Claim claim) { info.add_claimed_by_you(static_cast<wire::ClaimKind>(claim)); });
  info.set_exercise_frozen(room_.exercise().is_frozen());
  write_condition(*radar, info);
  peer_.send(MessageType::radar_info, info);
}

void Requests::set_settings(const wire::SetSettings& request) {
  LiveRadar* radar = claimed_radar(request.radar());
  if (radar == nullptr) return;
  const SettingsPtr before = radar->settings.current();
  RadarSettings candidate = before->settings;
  std::vector<FieldError> errors = merge_request(request.settings(), candidate);
  append(errors, validate(candidate));
  if (errors.empty()) errors = room_.renderer().scene_faults(candidate);
  if (errors.empty()) {
    if (const auto over = room_.over_live_limit(candidate, wire::kAllPlanes)) return refuse(*over);
    auto faults = beam_faults_of(candidate, before->version, radar->shown().pose);
    if (!faults) return;
    errors = std::move(*faults);
  }
  if (!errors.empty()) return refuse(ErrorNumber::invalid_value, "settings refused", errors);
  const auto outcome = radar->settings.set(candidate);
  room_.radars().publish_view(*radar);
  room_.log().set(*radar, before->settings, peer_.name);
  acknowledge(outcome.published->version);
  room_.radars().check_windows(*radar);
}

void Requests::write_coverage(const LiveRadar& radar, const KeeperState& keeper,
                              wire::RadarStatus& entry) const {
  if (radar.frames == 0) return;
  entry.set_coverage(radar.coverage);
  if (radar.coverage >= 1) return;
  GroundThere ground;
  if (room_.options().ground_at)
    ground = room_.options().ground_at(radar.pose, radar.settings.current()->settings.r_max_m);
  if (!ground.warning.empty()) {
    entry.set_coverage_reason(ground.warning);
  } else if (!keeper.last_error.empty()) {
    entry.set_coverage_reason("the next window of terrain cannot be loaded: " + keeper.last_error);
  } else if (keeper.building) {
    entry.set_coverage_reason("the next window of terrain is being loaded");
  } else if (ground.coverage < 1) {
    entry.set_coverage_reason("it looks beyond the ground that the files cover");
  }
}

void Requests::get_status(const wire::GetStatus& /*request*/) {
  wire::Status status;
  status.set_request_id(id_);
  status.set_server_name(room_.options().server_name);
  status.set_server_version(room_.options().server_version);
  status.set_uptime_s(to_seconds(room_.uptime()));
  const RoomStatistics all = room_.statistics();
  const KeeperState keeper = room_.options().keeper_state ? room_.options().keeper_state() : KeeperState{};
  status.set_clients(static_cast<std::uint32_t>(all.clients));
  status.set_frames_dropped(all.frames_dropped);
  status.set_renders_queued(static_cast<std::uint32_t>(all.renders_queued));
  status.set_bytes_sent(all.bytes_sent);
  for (const LiveRadar& radar : room_.radars().all()) {
    wire::RadarStatus& entry = *status.add_radars();
    write_condition(radar, entry);
    entry.set_frames(radar.frames);
    entry.set_last_render_s(radar.last_render_s);
    const rendering::LiveStream::Load load = room_.radars().load(radar);
    entry.set_live_frames(static_cast<std::uint32_t>(load.live_frames));
    entry.set_live_bytes(load.live_bytes);
    entry.set_frames_skipped(load.frames_skipped);
    entry.set_frames_shed(load.frames_shed);
    entry.set_dwells_missed(radar.dwells_missed);
    write_coverage(radar, keeper, entry);
  }
  status.set_exercise_frozen(room_.exercise().is_frozen());
  TargetWorld& targets = room_.targets();
  targets.expire();
  status.set_targets(static_cast<std::uint32_t>(targets.n()));
  status.set_max_targets(static_cast<std::uint32_t>(room_.options().max_targets));
  if (const Peer* holder = targets.claims().holder(wire::Claim::targets))
    status.set_targets_controller(holder->name);
  status.set_targets_expired(targets.expired());
  status.set_targets_late(targets.late());
  status.set_windows_loaded(keeper.swaps);
  status.set_window_loading(keeper.building);
  status.set_window_failures(keeper.failures);
  status.set_window_error(keeper.last_error);
  status.set_window_failure(keeper.last_failure);
  status.set_window_well_s(keeper.well_s);
  peer_.send(MessageType::status, status);
}

}  // namespace obliq::net
