#include "server/radar/beam/sub_bins.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/radar/beam/patterns.h"
#include "server/radar/beam/point_response.h"
#include "server/radar/doppler/ground_doppler.h"

namespace obliq {
namespace {

constexpr double kBinsABeamwidth = 2;
/// Of an image of synthetic aperture.
constexpr double kBinsACell = 2;
/// Of an antenna that is not stabilised an echo is shared by two neighbouring bins: with so many of them that
/// takes 0.2 % from the voltages' power in the mean, and moves nothing.
constexpr double kSharedBinsABeamwidth = 16;

/// A whole number of parts is not one more for a last bit.
int parts(double bins) { return static_cast<int>(std::clamp(std::ceil(bins * (1 - 1e-9)), 1.0, 1e6)); }

}  // namespace

double narrowest_beam_rad(const RadarSettings& s) {
  if (s.beam.pattern == BeamPattern::file) return AzimuthPattern(s).equivalent_width_rad();
  return s.beam.width_deg * std::numbers::pi / 180;
}

double azimuth_resolution_rad(const RadarSettings& s) {
  return s.beam.pattern == BeamPattern::off ? s.azimuth_bin_rad() : narrowest_beam_rad(s);
}

int azimuth_sub_bins(const RadarSettings& s, double across_m_s) {
  const double width_rad = s.azimuth_bin_rad();
  if (s.mode == RadarMode::sar) return parts(kBinsACell * width_rad * s.r_max_m / s.doppler.resolution_m);
  if (s.beam.pattern == BeamPattern::off) return 1;
  const double beam_rad = narrowest_beam_rad(s);
  const double bins = std::max(kBinsABeamwidth, rows_a_beamwidth(s, beam_rad, across_m_s));
  const int needed = parts(bins * width_rad / beam_rad);
  if (s.beam.stabilised || needed > kMostSubBins) return needed;
  return std::min(kMostSubBins, parts(kSharedBinsABeamwidth * width_rad / narrowest_beam_rad(s)));
}

int range_sub_bins(const RadarSettings& s) {
  if (s.pulse.kind == PulseKind::off) return 1;
  return parts(s.range_bin_m() / PointResponse(s).resolution_m());
}

}  // namespace obliq
