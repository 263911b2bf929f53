#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "server/radar/echo/corners.h"
#include "server/radar/profile/local_sight.h"
#include "server/radar/scene_plan.h"

namespace obliq {

/// Corners of walls and ground where samples see walls: at a place of a wall's foot, exactly as its vertical
/// profile has the ground before it. Holds buffers: one a thread.
class FootCorner {
 public:
  FootCorner(const ScenePlan& plan, const CornerTable& corners);

  struct Corner {
    double sigma_per_sr;  ///< cross section for a unit of a wall sample's solid angle
    double range_m;       ///< of the foot
    glm::dvec3 foot_m;
  };
  /// Of a wall at world (x, z), as long as its foot is lit; nothing: it returns nothing. Samples that lie
  /// over each other share what the wall's foot returns by their solid angles.
  std::optional<Corner> at(std::uint32_t wall, double x_m, double z_m);

 private:
  bool is_lit(const glm::dvec3& foot_m) const;
  void aim(const glm::dvec3& foot_m, double distance_m, double reach_m);
  double strip_sum(const WallPlane& wall, std::uint8_t material, double distance_m, double ground_m,
                   double roof_m);

  const ScenePlan& plan_;
  const CornerTable& table_;
  LocalSurface surface_;
  SinCos bearing_{0, 1};
  std::vector<std::uint32_t> near_;
  std::vector<RoofSpan> spans_;
  std::vector<SurfaceSegment> visible_;
};

}  // namespace obliq
