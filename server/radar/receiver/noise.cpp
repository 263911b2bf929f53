#include "server/radar/receiver/noise.h"

#include <algorithm>
#include <cmath>

#include "server/radar/beam/antenna_gain.h"
#include "server/radar/beam/point_response.h"
#include "server/radar/doppler/doppler_response.h"
#include "server/radar/doppler/ground_doppler.h"
#include "server/radar/simd/lanes/exact_math.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

constexpr double kBoltzmann_j_k = 1.380649e-23;  // exact, SI

/// A triangle that ends r bins away, sampled at whole bins, is that of boxes of n and of n + 1 bins, n the
/// whole part of r and f the rest: r - k = (1 - f) (n - k) + f (n + 1 - k).
std::vector<std::vector<double>> boxes(double ratio) {
  const double whole = std::floor(ratio);
  const double rest = ratio - whole;
  std::vector<std::vector<double>> kernels;
  const auto add = [&](double share, double bins) {
    if (share > 0 && bins > 0)
      kernels.emplace_back(static_cast<std::size_t>(bins), std::sqrt(share / std::max(ratio, 1.0)));
  };
  // A pulse shorter than a bin leaves the bins independent.
  if (ratio < 1) return {{1.0}};
  add(1 - rest, whole);
  add(rest, whole + 1);
  return kernels;
}

}  // namespace

NoiseBand noise_band(const RadarSettings& settings) {
  const PointResponse pulse(settings);
  if (std::isfinite(pulse.resolution_m()))
    return {kSpeedOfLight_m_s / (2 * pulse.half_pulse_m()), ratio_of_db(pulse.window_loss_db())};
  const double range_spacing_m = settings.range_bin_m();
  return {kSpeedOfLight_m_s / (2 * range_spacing_m), 1};
}

double system_temperature_k(double noise_figure_db, double antenna_temperature_k, double reference_k) {
  return antenna_temperature_k + reference_k * (ratio_of_db(noise_figure_db) - 1);
}

double noise_power_w(double temperature_k, const NoiseBand& band) {
  return kBoltzmann_j_k * temperature_k * band.window_loss * band.bandwidth_hz;
}

double noise_power_w(const RadarSettings& settings, const AirView& air) {
  return noise_power_w(settings, air, (settings.r_min_m + settings.r_max_m) / 2);
}

double noise_power_w(const RadarSettings& settings, const AirView& air, double slant_range_m) {
  const ReceiverSettings& receiver = settings.receiver;
  if (!receiver.noise) return 0;
  const double train_s = aperture_s_a_m(settings, air.across_m_s) * slant_range_m;
  const double factor = settings.mode == RadarMode::sar
                            ? aperture_noise_factor(settings.doppler, train_s * settings.pulse.prf_hz)
                            : doppler_noise_factor(settings);
  return factor *
         noise_power_w(system_temperature_k(receiver.noise_figure_db, receiver.antenna_temperature_k),
                       noise_band(settings));
}

double echo_power_w(double power_w, double gain_db, double wavelength_m, double loss_db,
                    double cross_section_m2, double slant_range_m) {
  const double r2 = slant_range_m * slant_range_m;
  return radar_equation(radar_equation_constant(power_w, wavelength_m), ratio_of_db(gain_db),
                        cross_section_m2, ratio_of_db(loss_db) * r2 * r2);
}

std::vector<std::vector<double>> noise_kernels(const RadarSettings& settings) {
  const PointResponse pulse(settings);
  if (settings.pulse.kind == PulseKind::off) return {{1.0}};
  const double bin_m = settings.range_bin_m();
  if (settings.pulse.kind == PulseKind::rectangular) return boxes(pulse.half_pulse_m() / bin_m);
  std::vector<double> kernel = pulse.kernel(bin_m, settings.pulse.extent_bins);
  double energy = 0;
  for (const double h : kernel) energy += h * h;
  for (double& h : kernel) h /= std::sqrt(energy);
  return {kernel};
}

}  // namespace obliq
