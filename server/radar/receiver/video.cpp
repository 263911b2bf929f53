#include "server/radar/receiver/video.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "server/radar/receiver/decibel.h"
#include "server/radar/receiver/noise_power.h"
#include "terrain/base/wavelength.h"

namespace obliq {
namespace {

/// Of the ground that the scale is made for (Long; Nathanson: woods, farmland), and how much weaker echoes
/// are to be seen.
constexpr double kGamma_db = -15;
constexpr double kBelowGround_db = 20;
/// Of a radar that sends nothing and hears nothing.
constexpr double kLowestFloor_db = -400;

}  // namespace

double level_ground_power_w(const RadarSettings& s, double gamma_db, double slant_range_m, double height_m) {
  const double wavelength_m = wavelength_at(s.frequency_ghz);
  const double width_rad = s.sector_deg * std::numbers::pi / 180 / s.azimuth_bins;
  const double spacing_m = (s.r_max_m - s.r_min_m) / s.range_bins;
  const double cross_section_m2 = ratio_of_db(gamma_db) * width_rad * height_m * spacing_m;
  return echo_power_w(s.power_w, s.gain_db, wavelength_m, s.receiver.loss_db, cross_section_m2,
                      slant_range_m);
}

double video_floor_db(const RadarSettings& settings) {
  if (!settings.video.floor_auto) return settings.video.floor_db;
  const double r_max_m = settings.r_max_m;
  const double noise_w = noise_power_w(settings);
  double power = noise_w > 0 ? noise_w
                             : level_ground_power_w(settings, kGamma_db, r_max_m, r_max_m / 20) *
                                   ratio_of_db(-kBelowGround_db);
  if (settings.range_normalisation) power *= r_max_m * r_max_m * r_max_m * r_max_m;
  return std::max(kLowestFloor_db,
                  std::floor(db_of_ratio(std::max(power, std::numeric_limits<double>::min()))));
}

}  // namespace obliq
