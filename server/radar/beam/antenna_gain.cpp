#include "server/radar/beam/antenna_gain.h"

#include <algorithm>
#include <cmath>

#include "server/radar/beam/patterns.h"

namespace obliq {
namespace {

/// Floor of the gain, -80 dB one way, so that the ground of every bin is counted.
constexpr double kLeastGain = 1e-8;

}  // namespace

AntennaGain::AntennaGain(const RadarSettings& settings, const View& view, const BeamWidths* widths)
    : tilt_rad_(view.tilt_rad),
      rise_(view.rise),
      peak_(std::pow(10.0, settings.gain_db / 10)),
      keeps_elevation_(widths != nullptr || uses_doppler(settings)) {
  if (settings.beam.elevation == ElevationPattern::off && !keeps_elevation_) return;
  const ElevationGain pattern(settings, view.tilt_rad);
  constexpr int kSteps = ElevationTable::kSteps;
  table_.from = std::clamp(view.least_sine, -1 / rise_, 1 / rise_);
  const double to = std::clamp(view.greatest_sine, table_.from + 1e-3, 1.01 / rise_);
  table_.per_sine = kSteps / (to - table_.from);
  table_.lean_x = view.lean_x;
  table_.lean_z = view.lean_z;
  // Straight below, where widths grow as 1 / cos(e), the first step's mean is right if it begins at a third
  // of the cosine at which it ends.
  const double steepest = std::sqrt(2 * rise_ / table_.per_sine) / 3;
  for (int k = 0; k <= kSteps; ++k) {
    const double sine = std::min(1.0, rise_ * (table_.from + k / table_.per_sine));
    double gain = std::max(kLeastGain, pattern.power_gain(std::asin(sine)));
    if (widths != nullptr)
      gain *= std::sqrt(widths->at(std::max(steepest, std::sqrt(std::max(0.0, 1 - sine * sine)))));
    gains_.push_back(static_cast<float>(gain));
  }
  table_.gain = gains_.data();
}

}  // namespace obliq
