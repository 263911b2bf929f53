#include "server/radar/receiver/receiver.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "server/radar/receiver/noise.h"
#include "server/radar/simd/kernels.h"
#include "server/radar/simd/lanes/exact_math.h"
#include "terrain/base/asking.h"
#include "terrain/base/hash.h"

namespace obliq {
namespace {

// In units of ask(): gains and converter, a complex draw; and products that a kernel adds up in one.
constexpr int kReceptionABin = 6;
constexpr int kDrawABin = 4;
constexpr int kGainsABin = 40;
constexpr int kProducts = 16;

constexpr double kLargest = static_cast<double>(std::numeric_limits<float>::max());

std::uint64_t noise_key(const RadarSettings& settings, std::string_view radar, std::uint64_t counter) {
  const auto seed = static_cast<std::uint64_t>(settings.receiver.noise_seed);
  return mix64(mix64(mix64(seed) ^ checksum(radar.data(), radar.size())) ^ counter);
}

std::size_t longest(const std::vector<std::vector<double>>& kernels) {
  std::size_t taps = 1;
  for (const auto& kernel : kernels) taps = std::max(taps, kernel.size());
  return taps;
}

/// What a float holds: nothing that is not finite leaves.
float finite(double volts) {
  return std::isnan(volts) ? 0.0F : static_cast<float>(std::clamp(volts, -kLargest, kLargest));
}

}  // namespace

double stc_gain_db(const ReceiverSettings& receiver, double slant_range_m) {
  if (!(slant_range_m < receiver.stc_range_m)) return 0;
  const double share = std::max(slant_range_m / receiver.stc_range_m, std::numeric_limits<double>::min());
  return -std::min(receiver.stc_db, -receiver.stc_power * db_of_ratio(share));
}

double adc_step(const ReceiverSettings& receiver) {
  if (receiver.adc_bits == 0) return 0;
  constexpr double kMilliwatts = 1000;
  const double full_scale = std::sqrt(ratio_of_db(receiver.full_scale_dbm) / kMilliwatts);
  return std::ldexp(full_scale, 1 - receiver.adc_bits);
}

/// A row on its way, with room for whole lanes.
struct Receiver::Scratch {
  Scratch(std::size_t n_range, std::size_t n_taps)
      : re(n_range + kSpare),
        im(n_range + kSpare),
        white_re(n_range + n_taps + 2 * kSpare),
        white_im(white_re),
        ones(n_range + kSpare, 1.0F),
        look(2 * (n_range + kSpare)) {}
  static constexpr std::size_t kSpare = 8;
  std::vector<double> re, im;
  std::vector<double> white_re, white_im;
  std::vector<float> ones, look;
};

Receiver::Receiver(const RadarSettings& settings, std::string_view radar, std::uint64_t counter,
                   const AirView& air)
    : is_on_(has_receiver(settings)),
      counter_(counter),
      key_(noise_key(settings, radar, counter)),
      noise_power_w_(obliq::noise_power_w(settings, air)),
      noise_kernels_(obliq::noise_kernels(settings)),
      rain_power_(rain_echo_power_w(settings, air)),
      video_(obliq::video_scale(settings, air)),
      looks_(settings.video.looks > 1 ? LooksLaw::of(settings.video.looks) : nullptr) {
  const ReceiverSettings& receiver = settings.receiver;
  const double echo_power = ratio_of_db(-receiver.loss_db);
  echo_voltage_ = std::sqrt(echo_power);
  has_noise_ = noise_power_w_ > 0 || !rain_power_.empty();
  lsb_ = adc_step(receiver);
  most_counts_ = std::ldexp(1.0, receiver.adc_bits - 1);
  const double spacing_m = settings.range_bin_m();
  ask(kGainsABin * std::int64_t{settings.range_bins});
  for (int bin = 0; bin < settings.range_bins; ++bin) {
    const double range_m = settings.r_min_m + (bin + 0.5) * spacing_m;
    const double r2 = settings.range_normalisation ? range_m * range_m : 1;
    power_gain_.push_back(ratio_of_db(receiver.gain_db + stc_gain_db(receiver, range_m)));
    voltage_gain_.push_back(std::sqrt(power_gain_.back()));
    const double noise_w = noise_power_w_ > 0 ? obliq::noise_power_w(settings, air, range_m) : 0;
    noise_out_w_.push_back(noise_w * (r2 * r2));
    power_factor_.push_back(echo_power * (r2 * r2));
    look_voltage_.push_back(is_on_ ? std::sqrt(power_factor_.back()) : 1);
    const double rain_w = rain_power_.empty() ? 0 : rain_power_[static_cast<std::size_t>(bin)];
    noise_voltage_.push_back(std::sqrt(noise_w + rain_w));
    if (settings.range_normalisation && is_on_) range2_m2_.push_back(r2);
    if (!rain_power_.empty()) rain_power_[static_cast<std::size_t>(bin)] = rain_w * (r2 * r2);
  }
}

void Receiver::receive(BinBlock& bins, const ReceivedPlanes& wanted) const {
  const bool integrates = looks_ != nullptr && wanted.any_video();
  if (is_on_ || integrates) {
    const auto n_range = static_cast<std::size_t>(bins.n_range);
    Scratch scratch(wanted.iq || integrates ? n_range : 0, longest(noise_kernels_));
    VideoCoder coder(video_, integrates && wanted.video8, integrates && wanted.video16, bins);
    for (int a = 0; a < bins.n_azimuth; ++a) {
      const std::size_t row = static_cast<std::size_t>(a) * n_range;
      ask(kReceptionABin * bins.n_range);
      if (is_on_) {
        for (std::size_t r = 0; r < n_range; ++r) bins.power_w[row + r] *= power_factor_[r];
        for (std::size_t r = 0; r < rain_power_.size(); ++r) bins.power_w[row + r] += rain_power_[r];
      }
      if (wanted.iq || integrates) make_noise(static_cast<std::uint64_t>(bins.first_azimuth + a), scratch);
      if (integrates) {
        integrate_row(bins, a, scratch, coder.power());
        coder.code(a);
      }
      if (is_on_ && wanted.iq) receive_row(bins.iq.data() + row, scratch);
    }
  }
  if (looks_ == nullptr && wanted.any_video()) add_video_of_iq(video_, wanted.video8, wanted.video16, bins);
}

void Receiver::receive(PulseTrain& train) const {
  if (!is_on_) return;
  // Numbers beyond those of azimuth bins: 2^13 of these and 2^10 pulses are the most.
  constexpr std::uint64_t kFirst = std::uint64_t{1} << 24;
  constexpr std::uint64_t kPulses = std::uint64_t{1} << 10;
  const auto n_range = static_cast<std::size_t>(train.n_range);
  Scratch scratch(n_range, longest(noise_kernels_));
  for (int pulse = 0; pulse < train.n_pulses; ++pulse) {
    ask(std::int64_t{kReceptionABin} * train.n_range);
    make_noise(kFirst + static_cast<std::uint64_t>(train.azimuths.first) * kPulses +
                   static_cast<std::uint64_t>(pulse),
               scratch);
    receive_row(train.iq.data() + static_cast<std::size_t>(pulse) * n_range, scratch);
  }
}

/// Adds a row's echoes to its noise; then what comes after.
void Receiver::receive_row(std::complex<float>* iq, Scratch& scratch) const {
  const std::size_t n_range = voltage_gain_.size();
  double* const re = scratch.re.data();
  double* const im = scratch.im.data();
  for (std::size_t r = 0; r < n_range; ++r) {
    const double gain = voltage_gain_[r];
    re[r] = (re[r] + echo_voltage_ * static_cast<double>(iq[r].real())) * gain;
    im[r] = (im[r] + echo_voltage_ * static_cast<double>(iq[r].imag())) * gain;
  }
  if (lsb_ > 0) {
    const auto convert = [this](double volts) {
      return nearest_integer(std::clamp(volts / lsb_, -most_counts_, most_counts_ - 1)) * lsb_;
    };
    std::transform(re, re + n_range, re, convert);
    std::transform(im, im + n_range, im, convert);
  }
  if (!range2_m2_.empty())
    for (std::size_t r = 0; r < n_range; ++r) {
      re[r] *= range2_m2_[r];
      im[r] *= range2_m2_[r];
    }
  for (std::size_t r = 0; r < n_range; ++r) iq[r] = {finite(re[r]), finite(im[r])};
}

/// Noise of a row, into scratch.re and scratch.im.
void Receiver::make_noise(std::uint64_t azimuth, Scratch& scratch) const {
  std::fill_n(scratch.re.begin(), voltage_gain_.size(), 0.0);
  std::fill_n(scratch.im.begin(), voltage_gain_.size(), 0.0);
  if (!has_noise_) return;
  const Kernels& kernels = active_kernels();
  const auto n_range = static_cast<int>(voltage_gain_.size());
  const std::uint64_t cell = azimuth << 32;
  std::uint64_t key = key_;
  for (const std::vector<double>& kernel : noise_kernels_) {
    const auto n_taps = static_cast<int>(kernel.size());
    kernels.white_noise({key, cell, n_range + n_taps - 1, scratch.white_re.data(), scratch.white_im.data()});
    ask(kDrawABin * (n_range + n_taps));
    kernels.filter_row({n_range, n_taps, kernel.data(), scratch.white_re.data(), scratch.re.data()});
    ask(std::int64_t{n_range} * n_taps / kProducts);
    kernels.filter_row({n_range, n_taps, kernel.data(), scratch.white_im.data(), scratch.im.data()});
    ask(std::int64_t{n_range} * n_taps / kProducts);
    key = mix64(key + 1);
  }
  for (std::size_t r = 0; r < noise_voltage_.size(); ++r) {
    scratch.re[r] *= noise_voltage_[r];
    scratch.im[r] *= noise_voltage_[r];
  }
}

/// Powers of several looks of a row: one look of echo and noise together, without the converter, says where
/// in the law of the looks' mean a bin lies.
void Receiver::integrate_row(const BinBlock& bins, int azimuth, Scratch& scratch, double* power) const {
  const auto n_range = static_cast<std::size_t>(bins.n_range);
  const std::size_t row = static_cast<std::size_t>(azimuth) * n_range;
  const bool white = bins.look.empty();
  if (white)
    active_kernels().draw_speckle({mix64(key_),
                                   static_cast<std::uint64_t>(bins.first_azimuth + azimuth) << 32,
                                   bins.n_range, scratch.ones.data(), scratch.look.data()});
  for (std::size_t r = 0; r < n_range; ++r) {
    const double mean = bins.power_w[row + r] + noise_out_w_[r];
    if (!(mean > 0)) {
      power[r] = 0;
      continue;
    }
    const double r2 = range2_m2_.empty() ? 1 : range2_m2_[r];
    const double rain = rain_power_.empty() ? 0 : rain_power_[r];
    double re = 0, im = 0;
    if (white) {
      const double echo = std::sqrt(std::max(0.0, bins.power_w[row + r] - rain));
      re = echo * static_cast<double>(scratch.look[2 * r]);
      im = echo * static_cast<double>(scratch.look[2 * r + 1]);
    } else {
      re = look_voltage_[r] * static_cast<double>(bins.look[row + r].real());
      im = look_voltage_[r] * static_cast<double>(bins.look[row + r].imag());
    }
    const double scale = 1 / std::sqrt(mean);
    const double looks = looks_->mean((re + r2 * scratch.re[r]) * scale, (im + r2 * scratch.im[r]) * scale);
    power[r] = std::min(mean * power_gain_[r] * looks, std::numeric_limits<double>::max());
  }
}

}  // namespace obliq
