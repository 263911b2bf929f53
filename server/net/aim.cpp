#include "server/net/aim.h"

#include <google/protobuf/descriptor.h>

#include <cmath>

#include "proto/obliq.pb.h"
#include "server/control/parameters.h"

namespace obliq::net {
namespace {

/// Within a bearing's limits, otherwise as it is.
double turned(double angle_deg) {
  return std::abs(angle_deg) <= 360 ? angle_deg : std::remainder(angle_deg, 360.0);
}

}  // namespace

bool only_aims(const wire::Pose& message) {
  std::vector<const google::protobuf::FieldDescriptor*> fields;
  message.GetReflection()->ListFields(message, &fields);
  const auto is_aim = [](const google::protobuf::FieldDescriptor* field) {
    for (const Parameter& p : parameters())
      if (p.message == WireMessage::pose && p.wire_field == field->name()) return p.meaning.aim;
    return false;
  };
  return !fields.empty() && std::ranges::all_of(fields, is_aim);
}

std::vector<std::string> take_out_tilt(wire::Pose& message) {
  std::vector<std::string> names;
  if (message.has_tilt_deg()) names.emplace_back("tilt_deg");
  if (message.has_tilt_auto()) names.emplace_back("tilt_auto");
  message.clear_tilt_deg();
  message.clear_tilt_auto();
  return names;
}

std::string not_taken(const std::vector<std::string>& fields, const std::string& why) {
  std::string names;
  for (const std::string& field : fields) names += (names.empty() ? "" : ", ") + field;
  return names.empty() ? names : names + ": not taken: " + why;
}

std::string came_late(const PoseSettings& pose, const PoseSettings& newest) {
  return "sim_time_ns: found " + std::to_string(pose.sim_time_ns) + " after " +
         std::to_string(newest.sim_time_ns) +
         "; allowed: none that goes back, but with new_time_line; the pose is not taken";
}

Hand hand_of(const Claims& claims, const Peer* peer) {
  if (claims.taken(wire::kPoseClaim, peer) != 0) return Hand::operates;
  return claims.taken(wire::kSettingsClaim, peer) != 0 ? Hand::flyer : Hand::alone;
}

void resolve_angles(Hand hand, NamedAngles named, bool has_heading, const PoseSettings& now,
                    PoseSettings& wanted) {
  if (!named.bearing && !named.heading) return;
  const double centre_deg = std::remainder(now.bearing_deg - now.heading_deg, 360.0);
  if (hand == Hand::operates) {
    wanted.bearing_deg = turned(now.heading_deg + wanted.bearing_deg);
    return;
  }
  if (!named.heading && !has_heading) wanted.heading_deg = wanted.bearing_deg;
  if (hand == Hand::flyer || !named.bearing) wanted.bearing_deg = turned(wanted.heading_deg + centre_deg);
}

}  // namespace obliq::net
