#include "server/control/gimbal.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <glm/vec3.hpp>

#include "server/control/mount.h"
#include "server/radar/beam/antenna_axes.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

/// Shorter ways are rounding.
constexpr double kLeast_deg = 1e-6;
/// Under roll and pitch a turn in bearing is not quite one of the gimbal.
constexpr int kMostSteps = 40;
constexpr double kAllRound_deg = 360;

struct Span {
  double least = 0;
  double greatest = 0;

  void add(double angle) {
    least = std::min(least, angle);
    greatest = std::max(greatest, angle);
  }
};

struct GimbalAngles {
  Span azimuth_deg;
  Span elevation_deg;
};

/// Of the sector's centre and both its edges.
GimbalAngles angles_of(const Mount& mount, const RadarSettings& settings, const PoseSettings& pose) {
  const double centre_deg = pose.bearing_deg - pose.heading_deg;
  const double half_deg = settings.sector_deg / 2;
  const auto from_look = [&](double azimuth_deg) {
    return std::remainder(azimuth_deg - mount.look_deg, 360.0);
  };
  const AntennaAxes axes(pose.roll_deg * kDegree_rad, pose.pitch_deg * kDegree_rad, 0);
  if (!settings.beam.stabilised || axes.is_level()) {
    const double centre = from_look(centre_deg);
    return {{centre - half_deg, centre + half_deg}, {pose.tilt_deg, pose.tilt_deg}};
  }
  const auto own = [&](double azimuth_deg) {
    const double azimuth_rad = azimuth_deg * kDegree_rad;
    const double tilt_rad = pose.tilt_deg * kDegree_rad;
    return axes.own({std::cos(tilt_rad) * std::cos(azimuth_rad), std::cos(tilt_rad) * std::sin(azimuth_rad),
                     std::sin(tilt_rad)});
  };
  const auto azimuth_of = [](const glm::dvec3& v) { return std::atan2(v.y, v.x) / kDegree_rad; };
  const auto elevation_of = [](const glm::dvec3& v) {
    return std::asin(std::clamp(v.z, -1.0, 1.0)) / kDegree_rad;
  };
  const glm::dvec3 middle = own(centre_deg);
  const double centre = from_look(azimuth_of(middle));
  GimbalAngles angles{{centre, centre}, {elevation_of(middle), elevation_of(middle)}};
  for (const double edge_deg : {centre_deg - half_deg, centre_deg + half_deg}) {
    const glm::dvec3 edge = own(edge_deg);
    angles.azimuth_deg.add(centre + std::remainder(azimuth_of(edge) - azimuth_of(middle), 360.0));
    angles.elevation_deg.add(elevation_of(edge));
  }
  return angles;
}

bool is_wider(const Span& needed, const Span& limits) {
  return limits.greatest - limits.least < kAllRound_deg &&
         needed.greatest - needed.least > limits.greatest - limits.least + kLeast_deg;
}

/// The way back between the limits, or to their middle where more is needed; 0: none is.
double way_back(const Span& needed, const Span& limits) {
  if (limits.greatest - limits.least >= kAllRound_deg) return 0;
  const double below = limits.least - needed.least;
  const double above = needed.greatest - limits.greatest;
  if (below <= kLeast_deg && above <= kLeast_deg) return 0;
  if (is_wider(needed, limits)) return (below - above) / 2;
  return below > kLeast_deg ? below : -above;
}

std::string limit_text(std::string_view what, double turned_deg, const Span& asked, const Span& limits) {
  if (is_wider(asked, limits))
    return fmt::format("{}: the sector needs {:.1f} deg, the gimbal has {:.6g}", what,
                       asked.greatest - asked.least, limits.greatest - limits.least);
  if (std::abs(turned_deg) <= kLeast_deg) return {};
  return fmt::format("{} at its limit of {:.6g} deg, {:.1f} deg short", what,
                     turned_deg < 0 ? limits.greatest : limits.least, std::abs(turned_deg));
}

bool is_free(const Mount& mount) { return mount.gimbal == GimbalLimits{}; }
Span azimuths_of(const Mount& mount) { return {mount.gimbal.azimuth_min_deg, mount.gimbal.azimuth_max_deg}; }
Span elevations_of(const Mount& mount) {
  return {mount.gimbal.elevation_min_deg, mount.gimbal.elevation_max_deg};
}

std::string limit_at(const Mount& mount, const RadarSettings& settings, const PoseSettings& asked) {
  const GimbalAngles needed = angles_of(mount, settings, asked);
  const PoseSettings held = held_by(mount, settings, asked);
  const double turned_deg = std::remainder(held.bearing_deg - asked.bearing_deg, 360.0);
  std::string text = limit_text("azimuth", turned_deg, needed.azimuth_deg, azimuths_of(mount));
  if (asked.tilt_auto) return text;
  const std::string of_elevation =
      limit_text("elevation", held.tilt_deg - asked.tilt_deg, needed.elevation_deg, elevations_of(mount));
  return text + (text.empty() || of_elevation.empty() ? "" : "; ") + of_elevation;
}

}  // namespace

PoseSettings held_by(const Mount& mount, const RadarSettings& settings, const PoseSettings& asked) {
  PoseSettings held = asked;
  if (is_free(mount)) return held;
  double turn_deg = 1, lift_deg = 1;
  for (int step = 0; step < kMostSteps && (turn_deg != 0 || lift_deg != 0); ++step) {
    turn_deg = way_back(angles_of(mount, settings, held).azimuth_deg, azimuths_of(mount));
    if (turn_deg != 0) held.bearing_deg = std::remainder(held.bearing_deg + turn_deg, 360.0);
    lift_deg =
        asked.tilt_auto ? 0 : way_back(angles_of(mount, settings, held).elevation_deg, elevations_of(mount));
    held.tilt_deg = std::clamp(held.tilt_deg + lift_deg, -90.0, 90.0);
  }
  return held;
}

std::string limit_met(const Mount& mount, const RadarSettings& settings, const PoseSettings& asked) {
  if (is_free(mount)) return {};
  if (settings.scan_mode == ScanMode::frame || settings.scan_bars_deg.empty())
    return limit_at(mount, settings, asked);
  PoseSettings barred = asked;
  barred.tilt_auto = false;
  for (const double bar_deg : settings.scan_bars_deg) {
    barred.tilt_deg = bar_deg;
    if (std::string text = limit_at(mount, settings, barred); !text.empty()) return text;
  }
  return {};
}

}  // namespace obliq
