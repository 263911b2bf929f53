#include "server/radar/receiver/weather.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/radar/beam/patterns.h"
#include "server/radar/beam/point_response.h"
#include "server/radar/receiver/gas_lines.h"
#include "server/radar/receiver/noise.h"
#include "server/radar/simd/lanes/exact_math.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

/// sum a exp(-((x - b) / c)^2) + m x + n, x = log10(f / GHz): P.838-3, equations 2 and 3, Tables 1 to 4.
struct RainCurve {
  struct Term {
    double a, b, c;
  };
  Term terms[5];
  double m, n;

  double at(double frequency_ghz) const {
    const double x = std::log10(frequency_ghz);
    double sum = m * x + n;
    for (const Term& t : terms) {
      if (t.a == 0) continue;
      const double u = (x - t.b) / t.c;
      sum += t.a * std::exp(-u * u);
    }
    return sum;
  }
};
constexpr RainCurve kLogK_horizontal{{{-5.33980, -0.10008, 1.13098},
                                      {-0.35351, 1.26970, 0.45400},
                                      {-0.23789, 0.86036, 0.15354},
                                      {-0.94158, 0.64552, 0.16817},
                                      {0, 0, 1}},
                                     -0.18961,
                                     0.71147};
constexpr RainCurve kLogK_vertical{{{-3.80595, 0.56934, 0.81061},
                                    {-3.44965, -0.22911, 0.51059},
                                    {-0.39902, 0.73042, 0.11899},
                                    {0.50167, 1.07319, 0.27195},
                                    {0, 0, 1}},
                                   -0.16398,
                                   0.63297};
constexpr RainCurve kAlpha_horizontal{{{-0.14318, 1.82442, -0.55187},
                                       {0.29591, 0.77564, 0.19822},
                                       {0.32177, 0.63773, 0.13164},
                                       {-5.37610, -0.96230, 1.47828},
                                       {16.1721, -3.29980, 3.43990}},
                                      0.67849,
                                      -1.95537};
constexpr RainCurve kAlpha_vertical{{{-0.07771, 2.33840, -0.76284},
                                     {0.56727, 0.95545, 0.54039},
                                     {-0.20238, 1.14520, 0.26809},
                                     {-48.2991, 0.791669, 0.116226},
                                     {48.5833, 0.791459, 0.116479}},
                                    -0.053739,
                                    0.83433};

// The standard atmosphere at sea level.
constexpr double kDryAir_hpa = 1013.25;
constexpr double kTheta = 300 / 288.15;
constexpr double kVapour_hpa = 7.5 * 288.15 / 216.7;
constexpr double kAir_hpa = kDryAir_hpa + kVapour_hpa;

/// Line shape, P.676-12, equation 5: width and interference in GHz.
double shape(double f, double line, double width, double delta) {
  const auto wing = [&](double away) { return (width - delta * away) / (away * away + width * width); };
  return f / line * (wing(line - f) + wing(line + f));
}

/// Equations 3 to 7: strength times shape.
double oxygen(double f, const GasLine& line) {
  const double strength =
      line.a1 * 1e-7 * kDryAir_hpa * std::pow(kTheta, 3) * std::exp(line.a2 * (1 - kTheta));
  const double pressure =
      line.a3 * 1e-4 * (kDryAir_hpa * std::pow(kTheta, 0.8 - line.a4) + 1.1 * kVapour_hpa * kTheta);
  const double width = std::sqrt(pressure * pressure + 2.25e-6);
  const double delta = (line.a5 + line.a6 * kTheta) * 1e-4 * kAir_hpa * std::pow(kTheta, 0.8);
  return strength * shape(f, line.ghz, width, delta);
}
double water(double f, const GasLine& line) {
  const double strength =
      line.a1 * 0.1 * kVapour_hpa * std::pow(kTheta, 3.5) * std::exp(line.a2 * (1 - kTheta));
  const double pressure =
      line.a3 * 1e-4 *
      (kDryAir_hpa * std::pow(kTheta, line.a4) + line.a5 * kVapour_hpa * std::pow(kTheta, line.a6));
  const double width =
      0.535 * pressure + std::sqrt(0.217 * pressure * pressure + 2.1316e-12 * line.ghz * line.ghz / kTheta);
  return strength * shape(f, line.ghz, width, 0);
}

/// Equations 8 and 9: the dry continuum.
double continuum(double f) {
  const double d = 5.6e-4 * kAir_hpa * std::pow(kTheta, 0.8);
  return f * kDryAir_hpa * kTheta * kTheta *
         (6.14e-5 / (d * (1 + (f / d) * (f / d))) +
          1.4e-12 * kDryAir_hpa * std::pow(kTheta, 1.5) / (1 + 1.9e-5 * std::pow(f, 1.5)));
}

/// The part of the path to the ground that is below the rain's top.
double share_in_rain(const AtmosphereSettings& atmosphere, const AirView& air) {
  const double depth_m = atmosphere.rain_top_m - air.ground_m;
  if (depth_m <= 0) return 0;
  const double height_m = air.antenna_m - air.ground_m;
  return height_m <= depth_m ? 1 : depth_m / height_m;
}

/// Integral of the squared gain over the sine of elevation: Simpson's rule.
double seen_between(const ElevationGain& gain, double from, double to) {
  if (!(to > from)) return 0;
  constexpr int kSteps = 32;
  double sum = 0;
  for (int k = 0; k <= kSteps; ++k) {
    const double g = gain.power_gain(std::asin(from + (to - from) * k / kSteps));
    sum += (k == 0 || k == kSteps ? 1 : (k % 2 == 1 ? 4 : 2)) * g * g;
  }
  return sum * (to - from) / (3 * kSteps);
}

}  // namespace

double rain_attenuation_db_km(double rain_mm_h, double frequency_ghz, Polarisation polarisation) {
  if (rain_mm_h <= 0) return 0;
  const bool horizontal = polarisation == Polarisation::horizontal;
  // The Recommendation begins at 1 GHz, where attenuation by rain is negligible.
  const double f = std::max(frequency_ghz, 1.0);
  const double k = std::pow(10, (horizontal ? kLogK_horizontal : kLogK_vertical).at(f));
  return k * std::pow(rain_mm_h, (horizontal ? kAlpha_horizontal : kAlpha_vertical).at(f));
}

double gas_attenuation_db_km(double frequency_ghz) {
  double sum = continuum(frequency_ghz);
  for (const GasLine& line : kOxygenLines) sum += oxygen(frequency_ghz, line);
  for (const GasLine& line : kWaterLines) sum += water(frequency_ghz, line);
  return 0.1820 * frequency_ghz * sum;
}

double rain_reflectivity_m2_m3(double rain_mm_h, double wavelength_m) {
  constexpr double kDielectric = 0.93;
  const double z_m3 = 200 * std::pow(rain_mm_h, 1.6) * 1e-18;
  const double pi2 = std::numbers::pi * std::numbers::pi;
  const double lambda2 = wavelength_m * wavelength_m;
  return pi2 * pi2 * std::numbers::pi * kDielectric * z_m3 / (lambda2 * lambda2);
}

double path_loss_db_km(const RadarSettings& settings, const AirView& air) {
  const AtmosphereSettings& atmosphere = settings.atmosphere;
  double db_km = atmosphere.gas ? gas_attenuation_db_km(settings.frequency_ghz) : 0;
  db_km += share_in_rain(atmosphere, air) *
           rain_attenuation_db_km(atmosphere.rain_mm_h, settings.frequency_ghz, atmosphere.polarisation);
  return std::round(db_km * 1e12) / 1e12;
}

double path_power_factor(double loss_db_km, double slant_range_m) {
  return ratio_of_db(-2 * loss_db_km * slant_range_m / 1000);
}

std::vector<double> rain_echo_power_w(const RadarSettings& s, const AirView& air) {
  if (!(s.atmosphere.rain_mm_h > 0)) return {};
  const double wavelength_m = wavelength_at(s.frequency_ghz);
  const double eta = rain_reflectivity_m2_m3(s.atmosphere.rain_mm_h, wavelength_m);
  const double width_rad =
      s.beam.pattern == BeamPattern::off ? s.azimuth_bin_rad() : AzimuthPattern(s).equivalent_width_rad();
  const ElevationGain elevation(s, air.tilt_rad);
  const double spacing_m = s.range_bin_m();
  const double one_m2_at_1_m = echo_power_w(s.power_w, s.gain_db, wavelength_m, s.receiver.loss_db, 1, 1);
  const double loss_db_km = path_loss_db_km(s, air);
  const double length_m = s.pulse.kind == PulseKind::off ? spacing_m : PointResponse(s).equivalent_length_m();
  std::vector<double> power_w;
  for (int bin = 0; bin < s.range_bins; ++bin) {
    const double r = s.r_min_m + (bin + 0.5) * spacing_m;
    const double sin_top = std::clamp((s.atmosphere.rain_top_m - air.antenna_m) / r, -1.0, 1.0);
    const double sin_ground = std::clamp((air.ground_m - air.antenna_m) / r, -1.0, 1.0);
    const double solid_angle_sr = width_rad * seen_between(elevation, sin_ground, sin_top);
    power_w.push_back(one_m2_at_1_m * eta * solid_angle_sr * length_m / (r * r) *
                      path_power_factor(loss_db_km, r));
  }
  return power_w;
}

}  // namespace obliq
