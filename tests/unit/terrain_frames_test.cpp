#include <gtest/gtest.h>

#include <GeographicLib/Geocentric.hpp>
#include <cmath>
#include <limits>
#include <numbers>

#include "terrain/frames.h"

namespace obliq {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(WorldFrame, RoundTripsWithinAMicrometreUpTo300KilometresFromTheOrigin) {
  for (double factor : {1.0, 4.0 / 3, kInfinity}) {
    const WorldFrame frame(33 * kDegree, -99.5 * kDegree, factor);
    for (double north_deg : {-2.7, 0.0, 2.7}) {
      for (double east_deg : {-3.2, 0.0, 3.2}) {
        const Geodetic there{(33 + north_deg) * kDegree, (-99.5 + east_deg) * kDegree, 1234.5};
        const Geodetic back = frame.geodetic_from_world(frame.world_from_geodetic(there));
        // 1e-6 m over the earth's radius is 1.6e-13 rad.
        EXPECT_NEAR(back.latitude_rad, there.latitude_rad, 1.6e-13);
        EXPECT_NEAR(back.longitude_rad, there.longitude_rad, 1.6e-13);
        EXPECT_NEAR(back.height_m, there.height_m, 1e-6);
      }
    }
  }
}

TEST(WorldFrame, EllipsoidIsExactlyFlatAtInfiniteRadiusFactor) {
  const WorldFrame frame(33 * kDegree, -99.5 * kDegree, kInfinity);
  for (double offset_deg : {0.1, 0.5, 2.0}) {
    const WorldPoint p =
        frame.world_from_geodetic({(33 + offset_deg) * kDegree, (-99.5 - offset_deg) * kDegree, 0});
    // Rounding of ECEF coordinates: 6.4e6 m x 2^-52 is 1.4e-9 m an operation.
    EXPECT_NEAR(p.m.y, 0, 2e-8);
  }
}

TEST(WorldFrame, EllipsoidDropMatchesEcefArithmetic) {
  const WorldFrame frame(61 * kDegree, 10 * kDegree, 1);
  const GeographicLib::Geocentric& earth = GeographicLib::Geocentric::WGS84();
  const double lat = 61, lon = 10;
  double x0, y0, z0, x1, y1, z1;
  earth.Forward(lat, lon, 0, x0, y0, z0);
  earth.Forward(lat + 0.4, lon + 0.9, 0, x1, y1, z1);
  const double dx = x1 - x0, dy = y1 - y0, dz = z1 - z0;
  const double sl = std::sin(lat * kDegree), cl = std::cos(lat * kDegree);
  const double so = std::sin(lon * kDegree), co = std::cos(lon * kDegree);
  const double east = -so * dx + co * dy;
  const double north = -sl * co * dx - sl * so * dy + cl * dz;
  const double up = cl * co * dx + cl * so * dy + sl * dz;
  EXPECT_NEAR(frame.ellipsoid_y_m(east, north), up, 1e-7);
  EXPECT_LT(up, -300);
}

TEST(WorldFrame, MeridianConvergenceIsHalfADegreeAHundredKilometresEastAt33North) {
  const WorldFrame frame(33 * kDegree, -99.5 * kDegree, 4.0 / 3);
  const double east_rad = 100e3 / (6378137.0 * std::cos(33 * kDegree));
  const double north = frame.north_rad({33 * kDegree, -99.5 * kDegree + east_rad, 0});
  // Convergence of meridians on a sphere: d_longitude sin(latitude). North leans back to the origin's
  // meridian.
  EXPECT_NEAR(north, -east_rad * std::sin(33 * kDegree), 2e-5);
  EXPECT_NEAR(std::abs(north) / kDegree, 0.58, 0.01);
}

}  // namespace
}  // namespace obliq
