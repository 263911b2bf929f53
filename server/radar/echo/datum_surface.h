#pragma once
#include "terrain/frames.h"

namespace obliq {

/// Heights above the datum of points in the world, around the antenna: the datum surface is taken for a
/// quadric, to a centimetre within 60 km of the antenna and 60 km of the scene's origin
/// (Labels.HeightsOfPointsAreThoseOfGeodesy), for a thirtieth of the time of WorldFrame::geodetic_from_world.
class DatumSurface {
 public:
  DatumSurface() = default;
  DatumSurface(const WorldFrame& frame, const WorldPoint& antenna, double reach_m);

  /// Of surface of some power at (x, z) from the antenna: its world y times that power, to its height times
  /// it.
  double height_w(double x_m, double z_m, double y_w, double power_w) const {
    return (y_w - power_w * datum_m_.at(x_m, z_m)) * upright_.at(x_m, z_m);
  }

 private:
  struct Quadric {
    double c = 0, x = 0, z = 0, xx = 0, xz = 0, zz = 0;
    double at(double at_x, double at_z) const {
      return c + at_x * (x + xx * at_x + xz * at_z) + at_z * (z + zz * at_z);
    }
  };
  template <class Value>
  static Quadric fit(double reach_m, const Value& value);

  Quadric datum_m_;
  Quadric upright_;  ///< cosine of the angle between y and the vertical
};

}  // namespace obliq
