#include "server/radar/beam/patterns.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/radar/beam/pattern_cuts.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

/// Of the one-way gain: 60 dB down both ways.
constexpr double kEdge = 1e-3;
constexpr double kMostWidths = 4;

/// Half power at half a width from the middle.
double gaussian_gain(double offset, double width) {
  return std::exp(-4 * std::numbers::ln2 * (offset / width) * (offset / width));
}

std::optional<Taper> taper_of(const RadarSettings& s) {
  switch (s.beam.pattern) {
    case BeamPattern::uniform:
      return Taper::uniform();
    case BeamPattern::cosine:
      return Taper::half_cosine();
    case BeamPattern::taylor:
      return Taper::taylor(s.beam.nbar, s.beam.sidelobe_db);
    default:
      return std::nullopt;
  }
}

}  // namespace

AzimuthPattern::AzimuthPattern(const RadarSettings& s)
    : kind_(s.beam.pattern),
      width_rad_(s.beam.width_deg * kDegree_rad),
      taper_(taper_of(s)),
      file_(s.beam.file) {
  if (kind_ == BeamPattern::off) return;
  extent_rad_ = s.beam.extent_deg > 0 ? s.beam.extent_deg * kDegree_rad : chosen_extent_rad();
  extent_rad_ = std::min(extent_rad_, std::numbers::pi);
}

double AzimuthPattern::shape(double offset_rad) const {
  if (kind_ == BeamPattern::gaussian) return gaussian_gain(offset_rad, width_rad_);
  if (kind_ == BeamPattern::file) return file_ ? file_->azimuth.gain(offset_rad) : 0;
  return std::pow(taper_->transform(offset_rad / width_rad_ * taper_->half_power_width()), 2);
}

/// Where the gain has fallen below kEdge for good, at most kMostWidths away; of a file, all of it.
double AzimuthPattern::chosen_extent_rad() const {
  if (kind_ == BeamPattern::file) return file_ ? file_->azimuth.extent_rad(kEdge) : 0;
  constexpr int kSteps = 4096;
  for (int k = kSteps; k > 0; --k) {
    const double at = kMostWidths * width_rad_ * k / kSteps;
    if (shape(at) > kEdge) return kMostWidths * width_rad_ * std::min(k + 1, kSteps) / kSteps;
  }
  return width_rad_;
}

double AzimuthPattern::power_gain(double offset_rad) const {
  if (kind_ == BeamPattern::off) return offset_rad == 0 ? 1 : 0;
  return std::abs(offset_rad) <= extent_rad_ ? shape(offset_rad) : 0;
}

double AzimuthPattern::equivalent_width_rad() const {
  if (kind_ == BeamPattern::off) return 0;
  // Simpson's rule; a lobe has a hundred steps and more.
  constexpr int kSteps = 4096;
  const double step = 2 * extent_rad_ / kSteps;
  double sum = 0;
  for (int k = 0; k <= kSteps; ++k) {
    const double weight = k == 0 || k == kSteps ? 1 : (k % 2 == 1 ? 4 : 2);
    const double gain = shape(-extent_rad_ + k * step);
    sum += weight * gain * gain;
  }
  return sum * step / 3;
}

ElevationGain::ElevationGain(const RadarSettings& s, double tilt_rad)
    : kind_(s.beam.elevation),
      tilt_rad_(tilt_rad),
      width_rad_(s.beam.elevation_width_deg * kDegree_rad),
      cosecant_to_rad_(s.beam.cosecant_to_deg * kDegree_rad),
      file_(s.beam.file) {}

double ElevationGain::gaussian(double offset_rad) const { return gaussian_gain(offset_rad, width_rad_); }

double ElevationGain::power_gain(double elevation_rad) const {
  switch (kind_) {
    case ElevationPattern::off:
      return 1;
    case ElevationPattern::gaussian:
      return gaussian(elevation_rad - tilt_rad_);
    case ElevationPattern::file:
      return file_ ? file_->elevation.gain(elevation_rad - tilt_rad_) : 0;
    case ElevationPattern::cosecant:
      break;
  }
  // Depressions. A shoulder at or above the horizon has no cosecant.
  const double shoulder = width_rad_ / 2 - tilt_rad_;
  const double depression = -elevation_rad;
  if (depression <= shoulder || shoulder <= 0) return gaussian(elevation_rad - tilt_rad_);
  const double end = std::max(shoulder, cosecant_to_rad_);
  const double ratio = std::sin(shoulder) / std::sin(std::min(depression, end));
  return gaussian(width_rad_ / 2) * ratio * ratio * (depression > end ? gaussian(depression - end) : 1);
}

}  // namespace obliq
