#include "server/radar/echo/datum_surface.h"

#include <GeographicLib/Constants.hpp>

namespace obliq {

/// Through the antenna, four points around it and one aslant.
template <class Value>
DatumSurface::Quadric DatumSurface::fit(double reach_m, const Value& value) {
  const double r = reach_m;
  const double here = value(0, 0);
  const double east = value(r, 0), west = value(-r, 0), north = value(0, r), south = value(0, -r);
  Quadric q;
  q.c = here;
  q.x = (east - west) / (2 * r);
  q.z = (north - south) / (2 * r);
  q.xx = (east + west - 2 * here) / (2 * r * r);
  q.zz = (north + south - 2 * here) / (2 * r * r);
  q.xz = (value(r, r) - here - r * (q.x + q.z) - r * r * (q.xx + q.zz)) / (r * r);
  return q;
}

DatumSurface::DatumSurface(const WorldFrame& frame, const WorldPoint& antenna, double reach_m) {
  const double x = antenna.m.x, z = antenna.m.z;
  datum_m_ = fit(reach_m, [&](double dx, double dz) { return frame.datum_y_m(x + dx, z + dz); });
  // By the angle at the earth's centre, which grows with the distance from the scene's origin.
  const double radius_m = GeographicLib::Constants::WGS84_a();
  upright_ = fit(reach_m, [&](double dx, double dz) {
    return 1 - ((x + dx) * (x + dx) + (z + dz) * (z + dz)) / (2 * radius_m * radius_m);
  });
}

}  // namespace obliq
