// Requests that name a platform: all its radars' poses at once.
#include "proto/obliq.pb.h"
#include "server/control/parameters.h"
#include "server/control/settings_message.h"
#include "server/net/aim.h"
#include "server/net/peer.h"
#include "server/net/requests/requests.h"
#include "server/net/rights.h"
#include "server/net/room.h"

namespace obliq::net {

using wire::ErrorNumber;

namespace {

/// Takes out where an antenna looks; the names of the fields that asked for it. A bearing alone becomes the
/// heading, as of a client of version 1.1; beside an equal heading it asks for nothing.
std::vector<std::string> take_out_aim(wire::Pose& pose) {
  std::vector<std::string> fields = take_out_tilt(pose);
  if (pose.has_bearing_deg() && !pose.has_heading_deg()) pose.set_heading_deg(pose.bearing_deg());
  if (pose.has_bearing_deg() && pose.bearing_deg() != pose.heading_deg()) fields.emplace_back("bearing_deg");
  pose.clear_bearing_deg();
  return fields;
}

std::vector<FieldError> kind_faults(const Platform& platform,
                                    const google::protobuf::RepeatedField<int>& kinds) {
  for (const int kind : kinds)
    if (kind != wire::POSE_CLAIM)
      return {{"kinds", std::to_string(kind) + " of platform " + platform.name,
               "0, its pose; settings are its radars' own"}};
  return {};
}

}  // namespace

FieldError no_pose_of_its_own(const LiveRadar& radar, const std::string& field) {
  return {field, radar.name + ", which rides on platform " + radar.platform->name,
          radar.platform->name + "; of the radar itself bearing_deg, tilt_deg and tilt_auto alone"};
}

void Requests::fly(Platform& platform, const wire::Pose& message) {
  for (const LiveRadar* radar : platform.radars)
    if (!demand_claims(*radar, wire::kPoseClaim)) return;
  wire::Pose taken = message;
  const std::vector<std::string> ignored = take_out_aim(taken);
  PoseSettings pose = platform.pose;
  std::vector<FieldError> errors = merge_message(taken, pose);
  pose.bearing_deg = pose.heading_deg;
  append(errors, validate(pose));
  std::vector<PoseSettings> of_radars;
  for (const LiveRadar* radar : platform.radars) {
    if (!errors.empty()) break;
    of_radars.push_back(riding(pose, radar->initial.mount, radar->pose));
    errors = validate(of_radars.back());
    if (errors.empty()) errors = pose_faults(room_, *radar, of_radars.back());
    for (FieldError& error : errors) error.field = "radar " + radar->name + ": " + error.field;
  }
  if (!errors.empty()) return refuse(ErrorNumber::invalid_value, "pose refused", errors);

  std::vector<std::string> warnings;
  if (!ignored.empty()) warnings.push_back(not_taken(ignored, "each radar of a platform has its own"));
  for (const LiveRadar* radar : platform.radars)
    if (message.new_time_line()) radar->poses->restart();
  if (room_.radars().move(platform, of_radars, message.has_sim_time_ns())) {
    platform.pose = pose;
  } else {
    warnings.push_back(came_late(pose, platform.pose));
  }
  log_flight(platform.name);
  acknowledge_pose(platform.radars, warnings);
}

void Requests::claim(Platform& platform, const wire::ClaimControl& request) {
  if (const auto faults = kind_faults(platform, request.kinds()); !faults.empty())
    return refuse(ErrorNumber::invalid_value, "claim refused", faults);
  std::string held;
  for (const LiveRadar* radar : platform.radars)
    if (held.empty()) held = radar->claims.sentence(wire::kPoseClaim, &peer_);
  if (!held.empty()) {
    if (!request.force())
      return refuse(ErrorNumber::controlled_by_other, "platform " + platform.name + ": " + held);
    if (!demand(security::Role::admin, "taking control over")) return;
  }
  for (LiveRadar* radar : platform.radars) room_.radars().claim(*radar, wire::kPoseClaim, peer_);
  acknowledge();
}

void Requests::release(Platform& platform, const wire::ReleaseControl& request) {
  if (const auto faults = kind_faults(platform, request.kinds()); !faults.empty())
    return refuse(ErrorNumber::invalid_value, "release refused", faults);
  bool is_released = false;
  for (LiveRadar* radar : platform.radars)
    is_released |= room_.radars().release(*radar, wire::kPoseClaim, peer_) != 0;
  if (!is_released) return (void)demand_claims(*platform.radars.front(), wire::kPoseClaim);
  log_doing(peer_, platform.name, "pose released by " + peer_.name);
  acknowledge();
}

void Requests::describe(const Platform& platform) {
  wire::RadarInfo info;
  info.set_request_id(id_);
  info.set_radar(platform.name);
  write_message(platform.pose, *info.mutable_pose());
  const Peer* flyer = platform.radars.front()->claims.holder(wire::Claim::pose);
  if (flyer != nullptr) info.set_controller(flyer->name);
  info.set_controlled_by_you(flyer == &peer_);
  if (flyer == &peer_) info.add_claimed_by_you(wire::POSE_CLAIM);
  info.set_pose_stale(platform.radars.front()->poses->at(stream::monotonic_ns()).stale);
  info.set_late_poses(platform.radars.front()->poses->late());
  info.set_exercise_frozen(room_.exercise().is_frozen());
  for (const LiveRadar* radar : platform.radars) info.add_riders(radar->name);
  peer_.send(wire::MessageType::radar_info, info);
}

}  // namespace obliq::net
