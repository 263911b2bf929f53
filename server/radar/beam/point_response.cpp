#include "server/radar/beam/point_response.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "terrain/base/units.h"

namespace obliq {
namespace {

Taper window_of(const RadarSettings& s) {
  switch (s.pulse.window) {
    case PulseWindow::hamming:
      return Taper::hamming();
    case PulseWindow::hann:
      return Taper::hann();
    case PulseWindow::taylor:
      return Taper::taylor(s.pulse.nbar, s.pulse.sidelobe_db);
    case PulseWindow::none:
      break;
  }
  return Taper::uniform();
}

double resolution_of(const RadarSettings& s) {
  switch (s.pulse.kind) {
    case PulseKind::rectangular:
      return kSpeedOfLight_m_s / 2 * s.pulse.length_us * 1e-6;
    case PulseKind::compressed:
      return s.pulse.bandwidth_mhz > 0 ? kSpeedOfLight_m_s / 2 / (s.pulse.bandwidth_mhz * 1e6)
                                       : s.range_bin_m();
    case PulseKind::off:
      break;
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace

PointResponse::PointResponse(const RadarSettings& settings)
    : kind_(settings.pulse.kind),
      resolution_m_(resolution_of(settings)),
      half_pulse_m_(kSpeedOfLight_m_s / 2 * settings.pulse.length_us * 1e-6),
      taper_(window_of(settings)) {}

double PointResponse::at(double offset_m) const {
  switch (kind_) {
    case PulseKind::rectangular:
      return std::max(0.0, 1 - std::abs(offset_m) / resolution_m_);
    case PulseKind::compressed:
      return taper_.transform(offset_m / resolution_m_);
    case PulseKind::off:
      break;
  }
  return offset_m == 0 ? 1 : 0;
}

double PointResponse::equivalent_length_m() const {
  if (kind_ == PulseKind::off) return 0;
  return resolution_m_ * (kind_ == PulseKind::rectangular ? 2.0 / 3 : taper_.noise_width());
}

double PointResponse::window_loss_db() const {
  return kind_ == PulseKind::compressed ? 10 * std::log10(taper_.noise_width()) : 0;
}

int PointResponse::reach_bins(double bin_m, int extent_bins) const {
  if (kind_ == PulseKind::off) return 0;
  if (kind_ == PulseKind::compressed) return extent_bins;
  return static_cast<int>(std::min<double>(extent_bins, std::ceil(resolution_m_ / bin_m)));
}

std::vector<double> PointResponse::kernel(double bin_m, int extent_bins) const {
  if (kind_ == PulseKind::off) return {1};
  std::vector<double> h;
  for (int j = -extent_bins; j <= extent_bins; ++j) h.push_back(at(j * bin_m));
  if (kind_ == PulseKind::rectangular) {
    double sum = 0;
    for (const double x : h) sum += x * x;
    const double scale = std::sqrt(equivalent_length_m() / bin_m / sum);
    for (double& x : h) x *= scale;
  }
  return h;
}

}  // namespace obliq
