#pragma once
// The Doppler frequency of ground that stands still under an antenna that moves.
#include <glm/vec3.hpp>

#include "server/radar/settings.h"
#include "server/radar/simd/lanes/exact_math.h"

namespace obliq {

/// Of an antenna over the ground, in its sector's own axes: along the centre's bearing, to the right of it,
/// upwards. Of an antenna that is not stabilised, in its own (AntennaAxes).
struct SectorVelocity {
  double ahead_m_s = 0;
  double right_m_s = 0;
  double up_m_s = 0;

  double level_m_s() const;
  /// Across a line of sight at this azimuth off the sector's centre, on the level.
  double across_m_s(double azimuth_rad) const;
  /// The greatest of those in a sector.
  double most_across_m_s(double sector_rad) const;
  /// The least at the sector's edges and middle.
  double least_across_m_s(double sector_rad) const;
  bool is_zero() const { return ahead_m_s == 0 && right_m_s == 0 && up_m_s == 0; }
  bool operator==(const SectorVelocity&) const = default;
};

/// f = (2 / lambda) (cos e (v_ahead cos th + v_right sin th) + v_up sin e), closing positive: th the azimuth
/// off the sector's centre, e the elevation. Immutable.
class GroundDoppler {
 public:
  GroundDoppler() = default;
  GroundDoppler(const SectorVelocity& velocity, double wavelength_m);

  /// Of what stands at the antenna's own height.
  double level_hz(const SinCos& azimuth) const { return ahead_hz_ * azimuth.cos + right_hz_ * azimuth.sin; }
  double up_hz() const { return up_hz_; }
  double hz(const SinCos& azimuth, double sin_elevation) const;

 private:
  double ahead_hz_ = 0;
  double right_hz_ = 0;
  double up_hz_ = 0;
};

/// Time that a bin's echo is added up over: c pulses apart, the train of dbs and pulses. 0: a map. An image
/// of synthetic aperture takes its own (DopplerPlan).
double coherent_time_s(const RadarSettings& settings);

/// Of pulses: the range whose echo comes back before the next pulse, after the shortest interval of a
/// stagger.
double unambiguous_range_m(const RadarSettings& settings, double prf_hz);

/// Time over range of the train of a synthetic aperture, T = lambda r / (2 v sin psi resolution), s/m; 0
/// where the antenna does not fly across it.
double aperture_s_a_m(const RadarSettings& settings, double across_m_s);

/// Doppler cells of the ground in a beam, B = 2 v theta3 sin(psi) T / lambda; across_m_s: v sin(psi).
double cells_in_beam(const RadarSettings& settings, double beam_rad, double across_m_s);

/// Sharp rows that a beamwidth needs, B + 3: the sum over rows then has the covariance of the ground between
/// them, to 1e-6, over the whole train. 0: Doppler asks for none.
double rows_a_beamwidth(const RadarSettings& settings, double beam_rad, double across_m_s);

}  // namespace obliq
