#pragma once
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "server/radar/settings.h"

namespace obliq {

class AspectTable;  // server/radar/targets/aspect_table.h
class Route;        // server/radar/targets/route.h

/// What of a target echoes.
struct TargetSize {
  double rcs_dbsm = 10;  ///< mean radar cross section
  int swerling = 1;      ///< 0 to 4 (fluctuation.h)
  // 0: a point. Of Swerling 1 and 2 alone, which are of many scatterers; the others are points.
  double length_m = 0;
  double width_m = 0;
  double top_m = 0;                              ///< over its foot: what must be hidden
  std::shared_ptr<const AspectTable> aspects{};  ///< in place of rcs_dbsm; null: the same all round

  bool operator==(const TargetSize&) const = default;
};

/// A vehicle, a ship or an aircraft, in the operator's units.
struct Target {
  std::uint64_t id = 0;
  double latitude_deg = 0;
  double longitude_deg = 0;
  double height_m = 0;  ///< of its foot
  HeightReference height_reference = HeightReference::ground;
  double geoid_undulation_m = 0;  ///< used with HeightReference::ellipsoid only
  // Along its own east, up and north; each part at most kMostSpeed_m_s. Of a target without a route.
  glm::dvec3 velocity_m_s{0.0};
  glm::dvec3 acceleration_m_s2{0.0};
  std::optional<double> heading_deg;  ///< where its nose points; empty: along its course
  double heading_rate_deg_s = 0;
  std::shared_ptr<const Route> route;  ///< null: none
  TargetSize size;
  // When place, motion and heading were so:
  std::int64_t sim_time_ns = 0;  ///< in the clock of the poses
  bool is_timed = true;          ///< that clock is meant where the pose has it too
  std::int64_t arrived_ns = 0;   ///< by the server's clock, else
  double valid_s = 0;            ///< so long after its arrival it goes; 0: never

  bool operator==(const Target&) const = default;
};

/// All that are in the world. Never changes.
struct TargetSet {
  std::int64_t seed = 1;        ///< of their fluctuation
  std::vector<Target> targets;  ///< rising by id, each once
  std::uint64_t version = 0;    ///< one more with every change
};
using TargetsPtr = std::shared_ptr<const TargetSet>;

/// When a frame shows targets, beside the sim time of its pose.
struct TargetMoment {
  std::int64_t server_ns = 0;  ///< of the server's clock
  bool pose_is_timed = true;   ///< its sim time is of the controller's clock
};

/// A look at the targets of a world.
struct TargetLook {
  TargetMoment at{};
  std::uint64_t frame = 0;  ///< names the draw (TargetDraw), as dwell does
  std::uint64_t dwell = 0;
  bool truth = false;  ///< where each of them is is wanted too
  bool moves = false;  ///< and how they move
};

}  // namespace obliq
