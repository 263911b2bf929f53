#include "server/radar/doppler/doppler_warnings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "terrain/base/units.h"

namespace obliq {
namespace {

/// What moves so little over its train stays a point: half a range bin.
constexpr double kMostWalk_bins = 0.5;

}  // namespace

std::vector<std::string> doppler_warnings(const RadarSettings& s, const SectorVelocity& velocity) {
  std::vector<std::string> warnings;
  const bool has_map = s.mode == RadarMode::dbs;
  if (!has_map && s.mode != RadarMode::pulses) return warnings;
  const double sector_rad = s.sector_deg * kDegree_rad;
  const double across_m_s = velocity.most_across_m_s(sector_rad);
  if (!(across_m_s > 0)) {
    if (has_map)
      warnings.emplace_back(
          "radar.mode = \"dbs\" of an antenna without a velocity across its beam: the map is the real "
          "beam's; "
          "poses need a velocity, or two of them each a time");
    return warnings;
  }
  const double wavelength_m = wavelength_at(s.frequency_ghz);
  const double train_s = coherent_time_s(s);
  if (s.beam.pattern != BeamPattern::file) {
    const double width_hz = 2 * across_m_s * s.beam.width_deg * kDegree_rad / wavelength_m;
    if (width_hz > s.pulse.prf_hz)
      warnings.push_back(fmt::format(
          "pulse.prf_hz = {:.6g}: the ground in the beam is {:.0f} Hz wide, so that azimuths are ambiguous; "
          "above {:.0f} Hz they are not",
          s.pulse.prf_hz, width_hz, std::ceil(width_hz)));
  }
  const double walked_m = std::hypot(velocity.level_m_s(), velocity.up_m_s) * train_s;
  if (walked_m > kMostWalk_bins * s.range_bin_m())
    warnings.push_back(fmt::format(
        "doppler.pulses = {}: the antenna flies {:.1f} m in a train, more than half a range bin of {:.1f} m, "
        "and echoes are taken to stay in theirs",
        s.doppler.pulses, walked_m, s.range_bin_m()));
  // The quadratic phase that an unfocused train leaves.
  const double focused_m = 2 * std::pow(across_m_s * train_s, 2) / wavelength_m;
  if (has_map && focused_m > s.r_min_m)
    warnings.push_back(
        fmt::format("doppler.pulses = {}: nearer than {:.1f} km a real map of so long a train is out of "
                    "focus; this one is "
                    "not",
                    s.doppler.pulses, focused_m / 1000));
  return warnings;
}

}  // namespace obliq
