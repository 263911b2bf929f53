#include "server/radar/doppler/ground_doppler.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "terrain/base/units.h"

namespace obliq {
double SectorVelocity::level_m_s() const { return std::hypot(ahead_m_s, right_m_s); }

double SectorVelocity::across_m_s(double azimuth_rad) const {
  const SinCos at = sincos_turns(azimuth_rad / kTurn_rad);
  return std::abs(right_m_s * at.cos - ahead_m_s * at.sin);
}

double SectorVelocity::least_across_m_s(double sector_rad) const {
  return std::min({across_m_s(-sector_rad / 2), across_m_s(0), across_m_s(sector_rad / 2)});
}

double SectorVelocity::most_across_m_s(double sector_rad) const {
  // Abeam of the course lies a quarter on from it, on either side.
  const double course_rad = bearing_of(right_m_s, ahead_m_s);
  for (const double side : {-1.0, 1.0})
    if (std::abs(std::remainder(course_rad + side * kTurn_rad / 4, kTurn_rad)) <= sector_rad / 2)
      return level_m_s();
  return std::max(across_m_s(-sector_rad / 2), across_m_s(sector_rad / 2));
}

GroundDoppler::GroundDoppler(const SectorVelocity& velocity, double wavelength_m)
    : ahead_hz_(2 * velocity.ahead_m_s / wavelength_m),
      right_hz_(2 * velocity.right_m_s / wavelength_m),
      up_hz_(2 * velocity.up_m_s / wavelength_m) {}

double GroundDoppler::hz(const SinCos& azimuth, double sin_elevation) const {
  const double cosine = std::sqrt(std::max(0.0, 1 - sin_elevation * sin_elevation));
  return level_hz(azimuth) * cosine + up_hz_ * sin_elevation;
}

double coherent_time_s(const RadarSettings& settings) {
  switch (settings.mode) {
    case RadarMode::mti:
      return settings.doppler.canceller / settings.pulse.prf_hz;
    case RadarMode::dbs:
      return settings.doppler.pulses / settings.pulse.prf_hz;
    case RadarMode::pulses: {
      // Of a stagger its mean interval; it may end with longer ones, by no more than a pattern.
      double mean = 1;
      if (const auto& ratios = settings.pulse.stagger; !ratios.empty())
        mean = std::accumulate(ratios.begin(), ratios.end(), 0.0) / static_cast<double>(ratios.size());
      return settings.doppler.pulses * mean / settings.pulse.prf_hz;
    }
    default:
      return 0;
  }
}

double unambiguous_range_m(const RadarSettings& settings, double prf_hz) {
  const auto& ratios = settings.pulse.stagger;
  const double shortest = ratios.empty() ? 1 : *std::ranges::min_element(ratios);
  return kSpeedOfLight_m_s / 2 * shortest / prf_hz;
}

double aperture_s_a_m(const RadarSettings& settings, double across_m_s) {
  if (!(across_m_s > 0)) return 0;
  return wavelength_at(settings.frequency_ghz) / (2 * across_m_s * settings.doppler.resolution_m);
}

double cells_in_beam(const RadarSettings& settings, double beam_rad, double across_m_s) {
  return 2 * across_m_s * beam_rad * coherent_time_s(settings) / wavelength_at(settings.frequency_ghz);
}

double rows_a_beamwidth(const RadarSettings& settings, double beam_rad, double across_m_s) {
  if (!(coherent_time_s(settings) > 0)) return 0;
  return cells_in_beam(settings, beam_rad, across_m_s) + settings.doppler.rows_beside_cells;
}

}  // namespace obliq
