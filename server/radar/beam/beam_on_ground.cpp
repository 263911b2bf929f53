#include "server/radar/beam/beam_on_ground.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "terrain/base/asking.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

constexpr int kFunction = 40;  // of a gain, in units of ask()
constexpr int kGains = 1024;
constexpr double kLeastWidth_rad = 1e-30;

}  // namespace

double cosine_steps::cosine(int step) { return std::pow(kRatio, -step); }

int cosine_steps::nearest(double sin_elevation) {
  // Squared sines half way between two steps.
  static const auto limits = [] {
    std::array<double, kCount - 1> all{};
    for (int k = 0; k + 1 < kCount; ++k)
      all[static_cast<std::size_t>(k)] = 1 - std::pow(kRatio, -(2 * k + 1));
    return all;
  }();
  return static_cast<int>(std::ranges::upper_bound(limits, sin_elevation * sin_elevation) - limits.begin());
}

BeamOnGround::BeamOnGround(const AzimuthPattern& pattern, double turn_rad, double spacing_rad)
    : pattern_(pattern), turn_rad_(turn_rad), spacing_rad_(spacing_rad) {}

double BeamOnGround::still(double azimuth_rad, double cos_elevation) const {
  const double u = std::asin(std::clamp(cos_elevation * std::sin(azimuth_rad), -1.0, 1.0));
  return pattern_.power_gain(std::cos(azimuth_rad) >= 0 ? u : std::copysign(kPi, azimuth_rad) - u);
}

double BeamOnGround::gain(double azimuth_rad, double cos_elevation) const {
  const auto at = [&](double part) { return still(azimuth_rad + part * turn_rad_, cos_elevation); };
  return turn_rad_ > 0 ? (at(-0.5) + 4 * at(0) + at(0.5)) / 6 : at(0);
}

double BeamOnGround::extent_rad(double cos_elevation) const {
  const double own_rad = pattern_.extent_rad();
  if (own_rad >= kPi / 2) return kPi;
  const double sine = std::sin(own_rad);
  const double still_rad = sine < cos_elevation ? std::asin(sine / cos_elevation) : kPi / 2;
  return std::min(kPi, still_rad + turn_rad_ / 2);
}

double BeamOnGround::width_rad(double cos_elevation) const {
  const double extent = extent_rad(cos_elevation);
  const auto steps = static_cast<int>(std::clamp(2 * extent_rad(1) / spacing_rad_, 64.0, 16384.0));
  const double step = extent / steps;
  double sum = 0;
  for (int k = -steps; k <= steps; ++k) {
    if ((k + steps) % kGains == 0) ask(kFunction * std::min(kGains, steps - k + 1));
    const double g = gain(k * step, cos_elevation);
    sum += (std::abs(k) == steps ? 0.5 : 1.0) * g * g;
  }
  return sum * step;
}

BeamWidths::BeamWidths(const BeamOnGround& beam, double least_cosine) {
  for (int k = 0;; ++k) {
    const double cosine = cosine_steps::cosine(k);
    log_rad_.push_back(std::log(std::max(kLeastWidth_rad, beam.width_rad(cosine))));
    if (cosine <= least_cosine) return;
  }
}

double BeamWidths::at(double cos_elevation) const {
  static const double per_log = 1 / std::log(cosine_steps::kRatio);
  const auto last = static_cast<double>(log_rad_.size() - 1);
  const double place = std::clamp(-std::log(cos_elevation) * per_log, 0.0, last);
  const auto k = static_cast<std::size_t>(place);
  if (k + 1 == log_rad_.size()) return std::exp(log_rad_[k]);
  return std::exp(log_rad_[k] + (place - static_cast<double>(k)) * (log_rad_[k + 1] - log_rad_[k]));
}

}  // namespace obliq
