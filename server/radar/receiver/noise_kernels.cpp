#include "server/radar/receiver/noise_kernels.h"

#include <algorithm>
#include <cmath>

#include "server/radar/beam/point_response.h"

namespace obliq {
namespace {

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

std::vector<std::vector<double>> noise_kernels(const RadarSettings& settings) {
  const PointResponse pulse(settings);
  if (settings.pulse.kind == PulseKind::off) return {{1.0}};
  const double bin_m = (settings.r_max_m - settings.r_min_m) / settings.range_bins;
  if (settings.pulse.kind == PulseKind::rectangular) return boxes(pulse.half_pulse_m() / bin_m);
  std::vector<double> kernel = pulse.kernel(bin_m, settings.pulse.extent_bins);
  double energy = 0;
  for (const double h : kernel) energy += h * h;
  for (double& h : kernel) h /= std::sqrt(energy);
  return {kernel};
}

}  // namespace obliq
