#pragma once
// Where an antenna looks from its platform (parameters with Meaning::aim), and whose word on it counts.
#include <string>
#include <vector>

#include "server/net/claims.h"
#include "server/radar/settings.h"

namespace obliq::wire {
class Pose;
}

namespace obliq::net {

/// It says where the antenna looks, and nothing else.
bool only_aims(const wire::Pose& message);
/// Takes tilt out of the message; the names of the fields that were there.
std::vector<std::string> take_out_tilt(wire::Pose& message);

/// What the flyer is told of fields that are the operator's: "a, b: not taken: why"; empty of none.
std::string not_taken(const std::vector<std::string>& fields, const std::string& why);
/// What is said of a pose that was not taken, since the newest one is of a later time.
std::string came_late(const PoseSettings& pose, const PoseSettings& newest);

/// Who moves a radar.
enum class Hand {
  alone,    ///< one client has all, or nobody else the rest
  flyer,    ///< it holds the pose, another client the settings
  operates  ///< it holds the settings, another client the pose
};

/// What a client is beside the others; null: the operator's console.
Hand hand_of(const Claims& claims, const Peer* peer);

/// Which of the two angles a change names.
struct NamedAngles {
  bool bearing = false;
  bool heading = false;
};

/// Bearing and heading of `wanted`, which has what the change names and else `now`'s.
/// alone: as named. A heading alone turns the antenna too; a bearing alone is the heading as well, unless a
/// heading was ever named (has_heading). flyer: the sector's centre stays as it is from the nose; a bearing
/// counts as the heading where none was ever named, else not at all. operates: a bearing counts from the
/// heading.
void resolve_angles(Hand hand, NamedAngles named, bool has_heading, const PoseSettings& now,
                    PoseSettings& wanted);

}  // namespace obliq::net
