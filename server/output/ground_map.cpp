#include "server/output/ground_map.h"

#include <GeographicLib/AzimuthalEquidistant.hpp>
#include <algorithm>
#include <cmath>
#include <glm/vec3.hpp>
#include <numbers>
#include <string>

#include "proto/obliq.pb.h"
#include "terrain/constants.h"
#include "terrain/errors.h"
#include "terrain/frames.h"

namespace obliq {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kMaxSide = 2048;
/// Pixels between exactly projected points; between them world coordinates are interpolated bilinearly. Over
/// 1 km the plane's curvature leaves (1 km)^2 / 8 R = 2 cm.
constexpr int kLattice = 16;

/// Exact world offsets from the antenna for map positions.
class MapProjection {
 public:
  MapProjection(const wire::FrameDescriptor& d)
      : frame_(d.origin_latitude_deg() * kDegree_rad, d.origin_longitude_deg() * kDegree_rad,
               d.radius_factor()),
        plane_(GeographicLib::Geodesic::WGS84()),
        latitude_deg_(d.pose().latitude_deg()),
        longitude_deg_(d.pose().longitude_deg()),
        height_m_(d.map_reference_height_m()),
        antenna_(d.antenna_x_m(), d.antenna_y_m(), d.antenna_z_m()) {}

  glm::dvec3 offset(double east_m, double north_m) const {
    double latitude, longitude;
    plane_.Reverse(latitude_deg_, longitude_deg_, east_m, north_m, latitude, longitude);
    return frame_.world_from_geodetic({latitude * kDegree_rad, longitude * kDegree_rad, height_m_}).m -
           antenna_;
  }

 private:
  WorldFrame frame_;
  GeographicLib::AzimuthalEquidistant plane_;
  double latitude_deg_;
  double longitude_deg_;
  double height_m_;
  glm::dvec3 antenna_;
};

/// Bounds of a sector in map axes: its corners, its arc's extreme points and the inner arc.
struct Bounds {
  double left = 0, right = 0, bottom = 0, top = 0;
  bool empty = true;

  void add(double bearing_rad, double ground_m) {
    const double x = ground_m * std::sin(bearing_rad);
    const double y = ground_m * std::cos(bearing_rad);
    left = empty ? x : std::min(left, x);
    right = empty ? x : std::max(right, x);
    bottom = empty ? y : std::min(bottom, y);
    top = empty ? y : std::max(top, y);
    empty = false;
  }
};

Bounds sector_bounds(const wire::FrameDescriptor& d, double up_rad, double near_m, double far_m) {
  const double start = d.azimuth_start_deg() * kDegree_rad - up_rad;
  const double sector = d.azimuth_width_deg() * d.settings().azimuth_bins() * kDegree_rad;
  Bounds bounds;
  for (const double g : {near_m, far_m}) {
    bounds.add(start, g);
    bounds.add(start + sector, g);
    for (double quarter = std::ceil(start / (kPi / 2)); quarter * kPi / 2 <= start + sector; ++quarter)
      bounds.add(quarter * kPi / 2, g);
  }
  return bounds;
}

/// A descriptor may come from any server: refuse what no map can be made of.
void check_described(const wire::FrameDescriptor& d) {
  const auto positive = [](const char* field, double value) {
    if (!(value > 0) || !std::isfinite(value))
      throw InputError(std::string("frame descriptor: ") + field + ": found " + std::to_string(value) +
                       "; allowed: a positive number");
  };
  positive("azimuth_width_deg", d.azimuth_width_deg());
  positive("range_spacing_m", d.range_spacing_m());
  if (!(d.range_start_m() >= 0) || !std::isfinite(d.range_start_m()))
    throw InputError("frame descriptor: range_start_m: found " + std::to_string(d.range_start_m()) +
                     "; allowed: a number from 0");
  const double sector_deg = d.azimuth_width_deg() * d.settings().azimuth_bins();
  // Where every n-th bin stands for n, the last may reach around to the first.
  const bool stepped = d.has_window() && d.window().azimuth_step() > 1 && d.settings().azimuth_bins() > 1;
  const double past_the_last_deg = stepped ? d.azimuth_width_deg() : 0;
  if (!(sector_deg - past_the_last_deg < 360.001) || !(std::abs(d.azimuth_start_deg()) <= 3600))
    throw InputError("frame descriptor: found a sector of " + std::to_string(sector_deg) + " degrees from " +
                     std::to_string(d.azimuth_start_deg()) + "; allowed: at most 360 degrees from a bearing");
  for (const double value :
       {d.antenna_x_m(), d.antenna_y_m(), d.antenna_z_m(), d.north_rad(), d.map_reference_height_m(),
        d.azimuth_start_deg(), d.origin_latitude_deg(), d.origin_longitude_deg(), d.pose().latitude_deg(),
        d.pose().longitude_deg(), d.pose().bearing_deg()})
    if (!std::isfinite(value))
      throw InputError(
          "frame descriptor: found a position or bearing that is no number; allowed: finite numbers");
}

double magnitude_of(const BinBlock& bins, std::size_t bin) {
  if (!bins.iq.empty()) return std::abs(std::complex<double>(bins.iq[bin]));
  return bins.power_w.empty() ? 0 : std::sqrt(bins.power_w[bin]);
}

}  // namespace

bool can_be_drawn(const BinBlock& bins) { return !bins.iq.empty() || !bins.power_w.empty(); }

GroundMap map_to_ground(const wire::FrameDescriptor& d, const BinBlock& bins, double up_bearing_rad) {
  check_described(d);
  const double r_min = d.range_start_m();
  const double r_max = r_min + d.range_spacing_m() * bins.n_range;
  const MapProjection projection(d);
  const double above = -projection.offset(0, 0).y;
  const double near_m = std::sqrt(std::max(0.0, r_min * r_min - above * above));
  // On a falling earth a slant range reaches a little less far than over flat ground.
  const Bounds bounds = sector_bounds(d, up_bearing_rad, near_m, r_max);

  GroundMap map;
  map.up_rad = up_bearing_rad;
  map.antenna_above_m = above;
  map.of_power = bins.iq.empty();
  map.unit = map.of_power ? d.power_unit() : d.unit();
  const double extent = std::max(bounds.right - bounds.left, bounds.top - bounds.bottom);
  map.pixel_m = std::max(d.range_spacing_m(), extent / kMaxSide);
  map.width =
      std::clamp(static_cast<int>(std::ceil((bounds.right - bounds.left) / map.pixel_m)), 1, kMaxSide);
  map.height =
      std::clamp(static_cast<int>(std::ceil((bounds.top - bounds.bottom) / map.pixel_m)), 1, kMaxSide);
  map.left_m = bounds.left;
  map.top_m = bounds.top;
  const auto n = static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height);
  map.magnitude_db.assign(n, GroundMap::kNoValue);
  map.slant_range_m.assign(n, 0);
  map.state.assign(n, GroundMap::kOutside);

  const double sin_up = std::sin(up_bearing_rad);
  const double cos_up = std::cos(up_bearing_rad);
  const auto exact = [&](double column, double row) {
    const double right = map.left_m + (column + 0.5) * map.pixel_m;
    const double ahead = map.top_m - (row + 0.5) * map.pixel_m;
    return projection.offset(right * cos_up + ahead * sin_up, ahead * cos_up - right * sin_up);
  };
  const double start = d.azimuth_start_deg() * kDegree_rad + d.north_rad();
  const double width = d.azimuth_width_deg() * kDegree_rad;
  for (int row0 = 0; row0 < map.height; row0 += kLattice) {
    for (int column0 = 0; column0 < map.width; column0 += kLattice) {
      const glm::dvec3 p00 = exact(column0, row0);
      const glm::dvec3 p10 = exact(column0 + kLattice, row0);
      const glm::dvec3 p01 = exact(column0, row0 + kLattice);
      const glm::dvec3 p11 = exact(column0 + kLattice, row0 + kLattice);
      for (int row = row0; row < std::min(map.height, row0 + kLattice); ++row) {
        const double v = static_cast<double>(row - row0) / kLattice;
        for (int column = column0; column < std::min(map.width, column0 + kLattice); ++column) {
          const double u = static_cast<double>(column - column0) / kLattice;
          const glm::dvec3 p = (1 - v) * ((1 - u) * p00 + u * p10) + v * ((1 - u) * p01 + u * p11);
          const double r = std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z);
          if (r < r_min || r >= r_max) continue;
          double offset = std::fmod(std::atan2(p.x, p.z) - start, 2 * kPi);
          if (offset < 0) offset += 2 * kPi;
          if (!(offset < width * bins.n_azimuth)) continue;
          const int azimuth = std::min(bins.n_azimuth - 1, static_cast<int>(offset / width));
          const int range = std::min(bins.n_range - 1, static_cast<int>((r - r_min) / d.range_spacing_m()));
          const std::size_t bin = static_cast<std::size_t>(azimuth) * static_cast<std::size_t>(bins.n_range) +
                                  static_cast<std::size_t>(range);
          const std::size_t pixel = static_cast<std::size_t>(row) * static_cast<std::size_t>(map.width) +
                                    static_cast<std::size_t>(column);
          map.slant_range_m[pixel] = static_cast<float>(r);
          const bool empty = !bins.count.empty() && bins.count[bin] == 0;
          const double magnitude = empty ? 0 : magnitude_of(bins, bin);
          if (magnitude > 0 && std::isfinite(magnitude))
            map.magnitude_db[pixel] = static_cast<float>(20 * std::log10(magnitude));
          map.state[pixel] = !bins.state.empty() ? bins.state[bin]
                             : magnitude > 0     ? static_cast<std::uint8_t>(BinState::sampled)
                                                 : GroundMap::kUnknown;
        }
      }
    }
  }
  return map;
}

}  // namespace obliq
