#pragma once
// The frames of the program and the one way between them (PAPER.md, frames).
//
// World: the local tangent (ENU) frame of GeographicLib::LocalCartesian at the scene origin, in the paper's
// axes x east, y up, z north (left-handed), metres, with the effective-earth lift added to y.
#include <GeographicLib/LocalCartesian.hpp>
#include <glm/vec3.hpp>

namespace obliq {

/// Geographic position on WGS84 (NAD83 is taken as equal; they differ by about a metre). Radians and
/// metres. The height is whatever the elevation model uses, normally orthometric, and is inserted as if it
/// were ellipsoidal: terrain and antenna are treated alike, so that only height differences matter.
struct Geodetic {
  double latitude_rad = 0;
  double longitude_rad = 0;
  double height_m = 0;
};

/// A point in the world frame, metres: x east, y up, z north.
struct WorldPoint {
  glm::dvec3 m{0.0};
};

/// Converts between geodetic and world coordinates for one scene origin. Immutable, safe from any thread.
class WorldFrame {
 public:
  /// radius_factor k: 4/3 standard refraction, 1 vacuum, infinity flat ground (y is then the height above
  /// the ellipsoid's own y at each (x, z), exactly 0 on the ellipsoid).
  WorldFrame(double origin_latitude_rad, double origin_longitude_rad, double radius_factor);

  WorldPoint world_from_geodetic(const Geodetic& geodetic) const;
  Geodetic geodetic_from_world(const WorldPoint& world) const;

  /// The ellipsoid's own y (<= 0) at tangent-plane position (x, z), before any lift. Metres.
  double ellipsoid_y_m(double x_m, double z_m) const;

  /// World y of the datum surface (height 0) at (x, z), lift included: ellipsoid_y_m / k. Metres, <= 0.
  double datum_y_m(double x_m, double z_m) const { return ellipsoid_y_m(x_m, z_m) / radius_factor_; }

  /// What is subtracted from the tangent-plane y at (x, z): (1 - 1/k) ellipsoid_y_m. Metres, <= 0.
  double lift_m(double x_m, double z_m) const;

  /// The direction of true north at a geodetic position, as an angle in the world frame, clockwise from
  /// +z: the meridian convergence. A true bearing b points along world angle b + north_rad.
  double north_rad(const Geodetic& geodetic) const;

  double origin_latitude_rad() const { return origin_latitude_rad_; }
  double origin_longitude_rad() const { return origin_longitude_rad_; }
  double radius_factor() const { return radius_factor_; }

 private:
  /// The ellipsoid in the axes of the origin, metres:
  /// up_up y^2 + 2 (normal_radius + up_north z) y + x^2 + north_north z^2 = 0.
  struct TangentForm {
    double normal_radius, up_up, up_north, north_north;
  };
  static TangentForm tangent_form(double origin_latitude_rad);

  double origin_latitude_rad_;
  double origin_longitude_rad_;
  double radius_factor_;
  TangentForm ellipsoid_;
  GeographicLib::LocalCartesian tangent_;
};

}  // namespace obliq
