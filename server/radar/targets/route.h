#pragma once
#include <GeographicLib/GeodesicLine.hpp>
#include <optional>
#include <vector>

namespace obliq {

/// A point that a target goes to, in the operator's units.
struct RoutePoint {
  double latitude_deg = 0;
  double longitude_deg = 0;
  std::optional<double> height_m;  ///< over the target's reference; empty: the target's own
  double speed_m_s = 10;           ///< over the ellipsoid, on the way to it

  bool operator==(const RoutePoint&) const = default;
};

/// What a target's route is made of.
struct RouteSpec {
  std::vector<RoutePoint> points;
  bool loops = false;  ///< from the last point back to the beginning with the last speed, and so on

  bool operator==(const RouteSpec&) const = default;
};

/// Most points of one route.
constexpr std::size_t kMostRoutePoints = 1000;

/// A way along geodesics from point to point, heights linear over the way. Immutable.
class Route {
 public:
  /// From the place where the target is at age 0.
  Route(double latitude_deg, double longitude_deg, double height_m, RouteSpec spec);

  struct Place {
    double latitude_deg = 0;
    double longitude_deg = 0;
    double height_m = 0;
    double course_deg = 0;  ///< clockwise from true north
  };
  /// Before the beginning it waits there; past the last point of a route that does not loop, there.
  Place at(double age_s) const;

  const RouteSpec& spec() const { return spec_; }

 private:
  struct Leg {
    GeographicLib::GeodesicLine line;
    double length_m;
    double from_height_m, to_height_m;
    double begins_s, lasts_s;
  };

  RouteSpec spec_;
  Place start_;
  std::vector<Leg> legs_;  ///< none is of no length
  double lasts_s_ = 0;     ///< once through
};

}  // namespace obliq
