// SetPose: who flies a radar, and who turns its antenna.
#include <algorithm>

#include "proto/obliq.pb.h"
#include "server/control/parameters.h"
#include "server/control/settings_message.h"
#include "server/net/aim.h"
#include "server/net/peer.h"
#include "server/net/requests/requests.h"
#include "server/net/rights.h"
#include "server/net/room.h"
#include "server/radar/beam/doppler_fault.h"
#include "server/radar/frame_plan.h"

namespace obliq::net {

using wire::Claim;
using wire::ErrorNumber;

std::vector<FieldError> pose_faults(const Room& room, const LiveRadar& radar, const PoseSettings& pose) {
  std::vector<FieldError> errors = room.renderer().place(pose);
  if (errors.empty() && pose.tilt_deg != radar.pose.tilt_deg)
    errors = known_beam_faults(radar.settings.current()->settings, pose).value_or(errors);
  return errors;
}

namespace {

/// What a radar of synthetic aperture says to a pose by which there are no frames; empty: there are. How an
/// antenna flies of which poses tell the time alone is known from the next one.
std::string no_image(const LiveRadar& radar) {
  if (!radar.pose.has_velocity() && radar.pose_has_sim_time) return {};
  const auto fault = image_fault(radar.settings.current()->settings, radar.pose);
  return fault ? "no frames by this pose: " + fault->text() : std::string();
}

NamedAngles angles_of(const wire::Pose& message) {
  return {message.has_bearing_deg(), message.has_heading_deg()};
}

}  // namespace

void Requests::set_pose(const wire::SetPose& request) {
  if (Platform* platform = room_.radars().find_platform(request.radar()))
    return fly(*platform, request.pose());
  LiveRadar* radar = radar_of(request.radar());
  if (radar == nullptr) return;
  if (radar->platform) {
    if (!only_aims(request.pose()))
      return refuse(ErrorNumber::invalid_value, "pose refused", {no_pose_of_its_own(*radar, "radar")});
    if (demand_claims(*radar, wire::kSettingsClaim)) aim(*radar, request.pose());
    return;
  }
  const wire::ClaimSet mine = radar->claims.of(peer_);
  const bool may_aim = mine == wire::kSettingsClaim && only_aims(request.pose());
  if (may_aim) return aim(*radar, request.pose());
  if (demand_claims(*radar, right_->claims)) fly(*radar, request.pose());
}

void Requests::fly(LiveRadar& radar, const wire::Pose& message) {
  const Peer* other = radar.claims.holder(Claim::settings);
  const Hand hand = hand_of(radar.claims, &peer_);
  wire::Pose taken = message;
  std::vector<std::string> warnings;
  const bool has_heading = radar.has_heading || message.has_heading_deg();
  if (hand == Hand::flyer) {
    std::vector<std::string> ignored = take_out_tilt(taken);
    if (message.has_bearing_deg() && has_heading) ignored.emplace_back("bearing_deg");
    if (!ignored.empty())
      warnings.push_back(
          not_taken(ignored, other->name + " holds the settings, and with them where the antenna looks"));
    if (message.has_bearing_deg() && !has_heading)
      warnings.push_back("bearing_deg: taken for the heading: " + other->name +
                         " holds the settings, and with them where the antenna looks from there");
  }
  PoseSettings pose = radar.pose;
  std::vector<FieldError> errors = merge_message(taken, pose);
  append(errors, validate(pose));
  if (errors.empty()) {
    resolve_angles(hand, angles_of(taken), radar.has_heading, radar.pose, pose);
    errors = pose_faults(room_, radar, pose);
  }
  if (!errors.empty()) return refuse(ErrorNumber::invalid_value, "pose refused", errors);
  if (message.new_time_line()) radar.poses->restart();
  const PoseSettings before = radar.pose;
  if (room_.radars().move(radar, pose, message.has_sim_time_ns())) {
    radar.has_heading = has_heading;
    if (only_aims(taken)) room_.log().aimed(radar, before, taken, peer_.name);
  } else {
    warnings.push_back(came_late(pose, radar.pose));
  }
  log_flight(radar.name);
  LiveRadar* const moved[] = {&radar};
  acknowledge_pose(moved, warnings);
}

void Requests::log_flight(const std::string& what) {
  if (peer_.has_moved && !peer_.is_guest) {
    log_as_guest(peer_);
    log_doing(peer_, what, "flown by " + peer_.name);
  }
  peer_.has_moved = true;
}

void Requests::aim(LiveRadar& radar, const wire::Pose& message) {
  PoseSettings pose = radar.pose;
  std::vector<FieldError> errors = merge_message(message, pose);
  append(errors, validate(pose));
  if (errors.empty()) {
    resolve_angles(hand_of(radar.claims, &peer_), angles_of(message), radar.has_heading, radar.pose, pose);
    errors = pose_faults(room_, radar, pose);
  }
  if (!errors.empty()) return refuse(ErrorNumber::invalid_value, "pose refused", errors);
  const PoseSettings before = radar.pose;
  room_.radars().aim(radar, pose);
  room_.log().aimed(radar, before, message, peer_.name);
  LiveRadar* const turned[] = {&radar};
  acknowledge_pose(turned, {});
}

void Requests::acknowledge_pose(std::span<LiveRadar* const> radars,
                                const std::vector<std::string>& warnings) {
  wire::Ack ack;
  ack.set_request_id(id_);
  if (radars.size() == 1) ack.set_settings_version(radars.front()->settings.current()->version);
  const auto warn = [&](const LiveRadar& radar, const std::string& text) {
    if (!text.empty()) ack.add_warnings(radars.size() == 1 ? text : radar.name + ": " + text);
  };
  for (LiveRadar* const radar : radars) {
    warn(*radar, no_image(*radar));
    if (!room_.options().ground_at) continue;
    const double r_max_m = radar->settings.current()->settings.r_max_m;
    const GroundThere ground = room_.options().ground_at(radar->pose, r_max_m);
    room_.radars().note_ground(*radar, ground.warning);
    ack.set_coverage(radar == radars.front() ? ground.coverage : std::min(ack.coverage(), ground.coverage));
    warn(*radar, ground.warning);
  }
  for (const std::string& warning : warnings) ack.add_warnings(warning);
  peer_.send(wire::MessageType::ack, ack);
}

}  // namespace obliq::net
