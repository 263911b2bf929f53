#include "server/output/map_projection.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "proto/obliq.pb.h"
#include "terrain/base/errors.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

constexpr double kMostRange_m = 2e7;  // half way round the earth

void check_described(const wire::FrameDescriptor& d) {
  const auto refuse = [](const std::string& field, double value, const char* allowed) {
    throw InputError(fmt::format("frame descriptor: {}: found {}; allowed: {}", field, value, allowed));
  };
  const auto positive = [&](const char* field, double value) {
    if (!(value > 0) || !std::isfinite(value)) refuse(field, value, "a positive number");
  };
  positive("azimuth_width_deg", d.azimuth_width_deg());
  positive("range_spacing_m", d.range_spacing_m());
  if (!(d.range_start_m() >= 0) || !std::isfinite(d.range_start_m()))
    refuse("range_start_m", d.range_start_m(), "a number from 0");
  const double sector_deg = d.azimuth_width_deg() * d.settings().azimuth_bins();
  // Where every n-th bin stands for n, the last may reach around to the first.
  const bool stepped = d.has_window() && d.window().azimuth_step() > 1 && d.settings().azimuth_bins() > 1;
  const double past_the_last_deg = stepped ? d.azimuth_width_deg() : 0;
  if (!(sector_deg - past_the_last_deg < 360.001) || !(std::abs(d.azimuth_start_deg()) <= 3600))
    throw InputError(fmt::format(
        "frame descriptor: found a sector of {} degrees from {}; allowed: at most 360 degrees from a bearing",
        sector_deg, d.azimuth_start_deg()));
  for (const double value :
       {d.antenna_x_m(), d.antenna_y_m(), d.antenna_z_m(), d.north_rad(), d.map_reference_height_m(),
        d.azimuth_start_deg(), d.origin_latitude_deg(), d.origin_longitude_deg(), d.pose().latitude_deg(),
        d.pose().longitude_deg(), d.pose().bearing_deg()})
    if (!std::isfinite(value))
      throw InputError(
          "frame descriptor: found a position or bearing that is no number; allowed: finite numbers");
  for (const double latitude : {d.origin_latitude_deg(), d.pose().latitude_deg()})
    if (std::abs(latitude) > 90) refuse("latitude", latitude, "-90 to 90");
  const double r_max_m = d.range_start_m() + d.range_spacing_m() * d.settings().range_bins();
  if (!(r_max_m <= kMostRange_m)) refuse("range", r_max_m, "at most 20000000 m");
}

const wire::FrameDescriptor& checked(const wire::FrameDescriptor& d) {
  check_described(d);
  return d;
}

}  // namespace

MapProjection::MapProjection(const wire::FrameDescriptor& d)
    : frame_(checked(d).origin_latitude_deg() * kDegree_rad, d.origin_longitude_deg() * kDegree_rad,
             d.radius_factor()),
      plane_(GeographicLib::Geodesic::WGS84()),
      latitude_deg_(d.pose().latitude_deg()),
      longitude_deg_(d.pose().longitude_deg()),
      reference_m_(d.map_reference_height_m()),
      north_rad_(d.north_rad()),
      antenna_m_(d.antenna_x_m(), d.antenna_y_m(), d.antenna_z_m()) {
  sector_.start_rad = d.azimuth_start_deg() * kDegree_rad;
  sector_.width_rad = d.azimuth_width_deg() * d.settings().azimuth_bins() * kDegree_rad;
  sector_.r_min_m = d.range_start_m();
  sector_.r_max_m = d.range_start_m() + d.range_spacing_m() * d.settings().range_bins();
  antenna_above_m_ = -offset({0, 0}).y;
}

glm::dvec3 MapProjection::offset(Place place, double above_reference_m) const {
  double latitude, longitude;
  plane_.Reverse(latitude_deg_, longitude_deg_, place.east_m, place.north_m, latitude, longitude);
  return frame_
             .world_from_geodetic(
                 {latitude * kDegree_rad, longitude * kDegree_rad, reference_m_ + above_reference_m})
             .m -
         antenna_m_;
}

MapProjection::Place MapProjection::place(double bearing_rad, double slant_m) const {
  const double along = bearing_rad + north_rad_;
  double below_m = antenna_above_m_;
  Geodetic at;
  // The reference surface falls away by d^2 / 2R: each step leaves a small part of what the last one left.
  constexpr int kSteps = 5;
  for (int step = 0; step < kSteps; ++step) {
    const double away_m = std::sqrt(std::max(0.0, slant_m * slant_m - below_m * below_m));
    at = frame_.geodetic_from_world(
        {antenna_m_ + glm::dvec3(away_m * std::sin(along), -below_m, away_m * std::cos(along))});
    below_m += at.height_m - reference_m_;
  }
  Place place;
  plane_.Forward(latitude_deg_, longitude_deg_, at.latitude_rad / kDegree_rad, at.longitude_rad / kDegree_rad,
                 place.east_m, place.north_m);
  return place;
}

}  // namespace obliq
