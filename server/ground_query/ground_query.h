#pragma once
// What is at places on the ground, and whether an antenna sees points there: what image generators call
// height above terrain and line of sight. The ground is the one that frames are made of, two triangles a
// cell; sight is a straight line in the world frame, so by the scene's own curvature and refraction.
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "proto/ground_record.h"
#include "server/ground_query/question.h"
#include "server/radar/geometry/pose.h"
#include "server/radar/profile/plumb_line.h"
#include "server/scene/scene.h"
#include "server/scene/surface_bounds.h"

namespace obliq {

struct PointHeight {
  double m = 0;
  HeightReference reference = HeightReference::ground;
  double geoid_undulation_m = 0;
};

/// Answers about one scene, place by place. Both must outlive it. Immutable, for any number of threads.
class GroundQuery {
 public:
  explicit GroundQuery(const Scene& scene);

  /// antenna: null, or whose sight of the point at that height is asked for.
  wire::GroundRecord answer(double latitude_deg, double longitude_deg, const PointHeight& height,
                            const Pose* antenna) const;
  /// The same at a true bearing and slant range of the antenna.
  wire::GroundRecord answer_at_range(double bearing_deg, double range_m, const PointHeight& height,
                                     const Pose& antenna) const;

 private:
  void describe_ground(const PlumbLine& line, const PlumbLine::Meeting& ground,
                       wire::GroundRecord& record) const;
  /// The building with the highest roof over a place of the plane.
  std::optional<std::uint32_t> building_at(double x_m, double z_m) const;
  void look(const glm::dvec3& point_m, const Pose& antenna, wire::GroundRecord& record) const;

  const Scene& scene_;
  std::vector<bool> is_water_;  ///< by material
};

struct GroundAnswers {
  std::vector<wire::GroundRecord> records;  ///< none where there are errors
  std::vector<std::string> materials;       ///< names, by number
  std::vector<FieldError> errors;
};

/// The question has been checked (faults_of). A stop leaves records out.
GroundAnswers answer_ground(const std::shared_ptr<const Scene>& scene, const GroundQuestion& question,
                            const std::stop_token& stop = {});

}  // namespace obliq
