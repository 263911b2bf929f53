#include "server/radar/receiver/video.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include "server/radar/receiver/noise.h"
#include "server/radar/simd/kernels.h"
#include "server/radar/simd/lanes/exact_math.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

/// Of the ground that the scale is made for (Long; Nathanson: woods, farmland), and how much weaker echoes
/// are to be seen.
constexpr double kGamma_db = -15;
constexpr double kBelowGround_db = 20;
/// Floor for zero power and no noise.
constexpr double kLowestFloor_db = -400;

constexpr std::size_t kSpare = 8;  // lanes of a kernel

}  // namespace

VideoScale video_scale(const RadarSettings& settings, const AirView& air) {
  // In range a time constant is as long as a pulse of that time; of one bin nothing would be left.
  constexpr int kFewestBins = 2;
  const double bins = settings.video.ftc_us * 1e-6 * kSpeedOfLight_m_s / 2 / settings.range_bin_m();
  const int ftc_bins = settings.video.ftc_us > 0
                           ? std::max(kFewestBins, static_cast<int>(std::lround(std::min(bins, 1e6))))
                           : 0;
  return {video_floor_db(settings, air), settings.video.span_db, ftc_bins};
}

void take_mean_away(std::span<double> power, int bins) {
  std::vector<double> sums(power.size() + 1);  // of all before
  for (std::size_t k = 0; k < power.size(); ++k) sums[k + 1] = sums[k] + power[k];
  for (std::size_t k = 0; k < power.size(); ++k) {
    const std::size_t n = std::min(k + 1, static_cast<std::size_t>(bins));
    power[k] = std::max(0.0, power[k] - (sums[k + 1] - sums[k + 1 - n]) / static_cast<double>(n));
  }
}

double level_ground_power_w(const RadarSettings& s, double gamma_db, double slant_range_m, double height_m) {
  const double wavelength_m = wavelength_at(s.frequency_ghz);
  const double width_rad = s.azimuth_bin_rad();
  const double spacing_m = s.range_bin_m();
  const double cross_section_m2 = ratio_of_db(gamma_db) * width_rad * height_m * spacing_m;
  return echo_power_w(s.power_w, s.gain_db, wavelength_m, s.receiver.loss_db, cross_section_m2,
                      slant_range_m);
}

double video_floor_db(const RadarSettings& settings, const AirView& air) {
  if (!settings.video.floor_auto) return settings.video.floor_db;
  const double r_max_m = settings.r_max_m;
  const double noise_w =
      settings.range_normalisation ? noise_power_w(settings, air, r_max_m) : noise_power_w(settings, air);
  double power = noise_w > 0 ? noise_w
                             : level_ground_power_w(settings, kGamma_db, r_max_m, r_max_m / 20) *
                                   ratio_of_db(-kBelowGround_db);
  if (settings.range_normalisation) power *= r_max_m * r_max_m * r_max_m * r_max_m;
  return std::max(kLowestFloor_db,
                  std::floor(db_of_ratio(std::max(power, std::numeric_limits<double>::min()))));
}

VideoCoder::VideoCoder(const VideoScale& scale, bool video8, bool video16, BinBlock& bins)
    : scale_(scale),
      video8_(video8),
      video16_(video16),
      bins_(bins),
      power_(static_cast<std::size_t>(bins.n_range) + kSpare),
      level_(power_.size()) {
  if (video8) bins.video8.resize(bins.state.size());
  if (video16) bins.video16.resize(bins.state.size());
}

void VideoCoder::code(int azimuth) {
  if (scale_.ftc_bins > 0)
    take_mean_away(std::span(power_).first(static_cast<std::size_t>(bins_.n_range)), scale_.ftc_bins);
  const std::size_t first = static_cast<std::size_t>(azimuth) * static_cast<std::size_t>(bins_.n_range);
  if (video8_) code(first, bins_.video8);
  if (video16_) code(first, bins_.video16);
}

template <typename Level>
void VideoCoder::code(std::size_t first, std::vector<Level>& plane) {
  constexpr double highest = std::numeric_limits<Level>::max();
  active_kernels().video_levels({bins_.n_range, power_.data(), scale_.floor_db,
                                 (highest - 1) / scale_.span_db, highest, level_.data()});
  std::transform(level_.begin(), level_.begin() + bins_.n_range,
                 plane.begin() + static_cast<std::ptrdiff_t>(first),
                 [](std::int32_t level) { return static_cast<Level>(level); });
}

void add_video_of_iq(const VideoScale& scale, bool video8, bool video16, BinBlock& bins) {
  VideoCoder coder(scale, video8, video16, bins);
  const std::complex<float>* iq = bins.iq.data();
  for (int azimuth = 0; azimuth < bins.n_azimuth; ++azimuth) {
    for (int r = 0; r < bins.n_range; ++r) coder.power()[r] = std::norm(std::complex<double>(*iq++));
    coder.code(azimuth);
  }
}

}  // namespace obliq
