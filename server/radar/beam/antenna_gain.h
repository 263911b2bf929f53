#pragma once
#include <numbers>
#include <vector>

#include "server/radar/beam/beam_on_ground.h"
#include "server/radar/settings.h"
#include "server/radar/simd/echoes/cross_section.h"

namespace obliq {

/// One-way power gain of the antenna over elevation, as samples and echoes need it: a table over the sines
/// that surface in the swath may have. Its bearings are the beam's (AzimuthPattern). In the sharp frame of a
/// beam it is multiplied by the root of the beam's width on ground at that elevation, in radians: the sums
/// over azimuths then keep each echo's power, whatever the elevation that they take for a row. Immutable.
class AntennaGain {
 public:
  /// Sines of elevation about the world's vertical; lean: from those to sines about the antenna's own
  /// vertical (ElevationTable), which are `rise` times as large.
  struct View {
    double tilt_rad = 0;
    double least_sine = -1;
    double greatest_sine = 1;
    double lean_x = 0;
    double lean_z = 0;
    double rise = 1;
  };
  /// widths: of the beam whose sharp frame it is; null: of none.
  AntennaGain(const RadarSettings& settings, const View& view, const BeamWidths* widths = nullptr);
  AntennaGain(const AntennaGain&) = delete;
  AntennaGain& operator=(const AntennaGain&) = delete;

  double tilt_rad() const { return tilt_rad_; }
  /// The sine about the antenna's own vertical is the table's times this.
  double rise() const { return rise_; }
  /// Power gain on the boresight.
  double peak() const { return peak_; }
  bool has_pattern() const { return table_.gain != nullptr; }
  /// Whether its bins are a beam's sharp ones or looked at by Doppler, which need the elevation of what they
  /// hold.
  bool keeps_elevation() const { return keeps_elevation_; }
  const ElevationTable& elevation() const { return table_; }

  /// Towards a point: its horizontal offset from the antenna and its slant range.
  double power_gain(double sin_elevation, double dx_m, double dz_m, double range_m) const {
    if (!has_pattern()) return peak_;
    return peak_ * table_.at(sin_elevation + (table_.lean_x * dx_m + table_.lean_z * dz_m) / range_m);
  }
  /// The sine that bins keep of a point that they hold: the table's where the antenna rolls with its
  /// platform.
  double kept_sine(double sin_elevation, double dx_m, double dz_m, double range_m) const {
    if (rise_ == 1) return sin_elevation;
    return sin_elevation + (table_.lean_x * dx_m + table_.lean_z * dz_m) / range_m;
  }

 private:
  double tilt_rad_;
  double rise_;
  double peak_;
  bool keeps_elevation_;
  std::vector<float> gains_;
  ElevationTable table_;
};

/// The monostatic radar equation: K G^2 sigma / r^4 (Richards 2014, eq. 2.8), with the constant
/// K = P lambda^2 / (4 pi)^3. spreading: r^4, or 1 of a normalised image; times the losses.
inline double radar_equation(double constant, double gain, double cross_section_m2, double spreading) {
  return constant * gain * gain * cross_section_m2 / spreading;
}
inline double radar_equation_constant(double power_w, double wavelength_m) {
  constexpr double kFourPi = 4 * std::numbers::pi;
  return power_w * wavelength_m * wavelength_m / (kFourPi * kFourPi * kFourPi);
}

}  // namespace obliq
