#pragma once
#include <glm/vec3.hpp>
#include <optional>

#include "terrain/frames.h"
#include "terrain/height_grid.h"

namespace obliq {

/// The straight line of all heights over one latitude and longitude: the ellipsoid's normal, which leans in
/// the world frame by the distance from its origin over the earth's radius.
class PlumbLine {
 public:
  PlumbLine(const WorldFrame& frame, double latitude_rad, double longitude_rad);

  /// The world point at a height above the datum.
  glm::dvec3 at_height(double height_m) const;
  /// Height above the datum, and the point, at which the line meets the ground; nothing where that is not
  /// known. Less than 0.1 mm off.
  struct Meeting {
    double height_m;
    glm::dvec3 point_m;
  };
  std::optional<Meeting> meet(const HeightGrid& grid) const;
  /// The same of a level of the world frame's y, such as a roof.
  Meeting meet(double y_m) const;

  /// Rise of the datum surface per metre of x and z at the line's foot, with the frame's lift.
  double datum_slope_x() const { return -up_.x / up_.y / frame_.radius_factor(); }
  double datum_slope_z() const { return -up_.z / up_.y / frame_.radius_factor(); }
  /// As WorldFrame::north_rad.
  double north_rad() const { return north_rad_; }

 private:
  template <class YAt>
  std::optional<Meeting> meet_surface(const YAt& y_at) const;

  const WorldFrame& frame_;
  glm::dvec3 foot_{0.0};  ///< at height 0, in the tangent plane's axes, without the lift
  glm::dvec3 up_{0.0};    ///< unit, likewise
  double north_rad_;
};

}  // namespace obliq
