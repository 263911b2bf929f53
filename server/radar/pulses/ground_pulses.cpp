#include "server/radar/pulses/ground_pulses.h"

#include <algorithm>
#include <cmath>

#include "server/radar/beam/doppler_rows.h"
#include "server/radar/beam/echo_sums.h"
#include "server/radar/beam/point_response.h"
#include "server/radar/beam/sub_bins.h"
#include "server/radar/simd/kernels.h"
#include "server/radar/simd/lanes/exact_math.h"
#include "terrain/base/asking.h"
#include "terrain/base/hash.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

constexpr double kLeastRange_m = 1;
// In units of ask(): a gain, a bin of a row, products that a kernel adds up in one.
constexpr int kGainWork = 40;
constexpr int kBinWork = 8;
constexpr int kProducts = 8;
/// Of what moves in the wind, so many rows in a beamwidth at least: fewer are no Gaussian process.
constexpr double kMovingRows = 16;
/// Laws that their speeds are drawn from.
constexpr int kSpeedLaws = 3;
/// Of draws beside those of a row's own I&Q.
constexpr std::uint64_t kMovingDraw = 0x6d6f76696e67;
constexpr std::uint64_t kSpeedDraw = 0x7370656564;
constexpr std::uint64_t kSeaDraw = 0x736561;

}  // namespace

GroundPulses::GroundPulses(const FramePlan& plan, const PulseTimes& times, const Boresight& boresight)
    : plan_(plan),
      sum_(*plan.sum()),
      times_(times),
      boresight_(boresight),
      pattern_(plan.settings()),
      beam_(pattern_, 0, sum_.row_rad()),
      stride_(sharp_stride(sum_)),
      pad_(sum_.gate_voltage.size() + EchoSums::kSpare),
      row_floats_(stride_ + 2 * pad_),
      re_(row_floats_ * static_cast<std::size_t>(times.n())),
      im_(re_.size()),
      range_re_(stride_ + EchoSums::kSpare),
      range_im_(range_re_.size()) {
  place_rows();
  const double rows = narrowest_beam_rad(plan.settings()) / sum_.row_rad();
  if (!sum_.doppler->windy().empty()) {
    speeds_ = kSpeedLaws * static_cast<int>(std::ceil(kMovingRows / (kSpeedLaws * rows)));
    const RadarSettings& s = plan.settings();
    moving_hz_ = 2 / WindSpectrum(s.atmosphere.wind_m_s, s.frequency_ghz).beta_s_m / sum_.wavelength_m;
  }
  if (sum_.doppler->has_sea()) {
    sea_speeds_ = static_cast<int>(std::ceil(kMovingRows / rows));
    sea_hz_ = SeaMotion(plan.settings()).deviation_hz(sum_.wavelength_m);
  }
  levels_.resize(cosine_steps::kCount);
  gains_.resize(static_cast<std::size_t>(window_.n_taps) * cosine_steps::kCount);
  int before = 0;
  for (int k = 0; k < times.pattern(); ++k) {
    first_of_like_.push_back(before);
    before += std::max(0, times.n_like(k));
  }
  const DopplerPlan& doppler = *sum_.doppler;
  const SectorVelocity& v = doppler.velocity();
  const double speed2 = v.ahead_m_s * v.ahead_m_s + v.right_m_s * v.right_m_s + v.up_m_s * v.up_m_s;
  const SinCos middle = sincos_turns(boresight.middle_rad / kTurn_rad);
  for (std::size_t m = 0; m < stride_ && speed2 > 0; ++m) {
    const double range_m = std::max(
        kLeastRange_m, sum_.sharp.r_min_m + (static_cast<double>(m) + 0.5) * sum_.sharp.range_bin_m());
    const double closing_m_s =
        doppler.ground().hz(middle, doppler.level_sine(range_m)) * sum_.wavelength_m / 2;
    const double across2 = std::max(0.0, speed2 - closing_m_s * closing_m_s);
    turns_a_s2_.push_back(-across2 / (sum_.wavelength_m * range_m));
  }
  ask(kBinWork * static_cast<std::int64_t>(stride_));
}

void GroundPulses::place_rows() {
  const double half_turn_rad = std::abs(boresight_.rate_rad_s) * times_.length_s() / 2;
  const auto row_at = [&](double azimuth_rad) {
    return static_cast<int>(std::floor((azimuth_rad - sum_.start_rad) / sum_.row_rad())) + sum_.first_azimuth;
  };
  const int reach = -sum_.first_tap;
  int first = row_at(boresight_.middle_rad - half_turn_rad) - reach;
  int last = row_at(boresight_.middle_rad + half_turn_rad) + reach;
  if (sum_.wraps) {
    last = std::min(last, first + sum_.n_rows - 1);
  } else {
    first = std::max(first, 0);
    last = std::min(last, sum_.n_rows - 1);
  }
  window_ = {1, sum_.n_rows, 1, first, 0, last - first + 1, sum_.wraps};
  const int n = sum_.n_azimuth;
  const auto bin_at = [&](double azimuth_rad) {
    return std::clamp(static_cast<int>(std::floor((azimuth_rad - sum_.start_rad) / sum_.output_rad)), 0,
                      n - 1);
  };
  const int first_bin = bin_at(boresight_.middle_rad - half_turn_rad);
  azimuths_ = {first_bin, bin_at(boresight_.middle_rad + half_turn_rad) - first_bin + 1};
}

void GroundPulses::add(const EchoRows::Ready& rows, const PulseTrip& trip, std::uint64_t key,
                       PulseTrain& train) {
  cut_by_eclipse(trip);
  std::ranges::fill(re_, 0.0F);
  std::ranges::fill(im_, 0.0F);
  const int parts = 1 + speeds_ + sea_speeds_;
  const auto some = static_cast<std::size_t>(std::max(1, kPulseRows / parts));
  for (std::size_t first = 0; first < rows.rows.size(); first += some) {
    std::vector<Row> taken;
    const std::size_t end = std::min(rows.rows.size(), first + some);
    taken.reserve((end - first) * static_cast<std::size_t>(parts));
    for (std::size_t k = first; k < end; ++k)
      take(*rows.rows[k], sum_.sharp_azimuth(window_.first_azimuth + static_cast<int>(k)), key, taken);
    sum_rows(rows, first, trip, taken, parts);
  }
  if (!turns_a_s2_.empty()) turn_pulses(trip);
  for (const int pulse : times_.pulses_like(trip.pulses)) sum_ranges(pulse, train);
}

/// Echoes of a later trip that come back while the antenna transmits: by the range at which they show. Those
/// of the first trip are cut in the rows already (EchoPlan::amplitude).
void GroundPulses::cut_by_eclipse(const PulseTrip& trip) {
  eclipsed_.clear();
  const RadarSettings& s = plan_.settings();
  if (trip.shift_m == 0 || !s.pulse.eclipse || s.pulse.kind == PulseKind::off) return;
  const PointResponse response(s);
  for (std::size_t m = 0; m < stride_; ++m) {
    const double shown_m =
        sum_.sharp.r_min_m + (static_cast<double>(m) + 0.5) * sum_.sharp.range_bin_m() - trip.shift_m;
    eclipsed_.push_back(static_cast<float>(std::max(0.0, response.left_by_eclipse(shown_m))));
  }
  ask(kBinWork * static_cast<std::int64_t>(stride_));
}

/// Voltages of a row, less what its eclipse takes; iq: [stride][2].
void GroundPulses::set_iq(Row& row, const float* iq) const {
  row.re.resize(stride_);
  row.im.resize(stride_);
  for (std::size_t m = 0; m < stride_; ++m) {
    const float left = eclipsed_.empty() ? 1.0F : eclipsed_[m];
    row.re[m] = iq[2 * m] * left;
    row.im[m] = iq[2 * m + 1] * left;
  }
}

/// A row, and where woods may move in the wind, or the sea, others of what moves.
void GroundPulses::take(const SharpWedge& wedge, int azimuth, std::uint64_t key, std::vector<Row>& all) {
  Row& row = all.emplace_back();
  row.hz.resize(stride_);
  const DopplerPlan& doppler = *sum_.doppler;
  const SinCos at = sincos_turns(sum_.row_middle_rad(azimuth) / kTurn_rad);
  active_kernels().doppler_turns(
      {{static_cast<int>(stride_), wedge.sine_row(azimuth), doppler.turns_a_hz().data(),
        doppler.ground().level_hz(at), doppler.ground().up_hz()},
       row.hz.data()});
  std::vector<float> drawn;
  const float* iq = nullptr;
  if (sum_.draws()) {
    drawn.resize(2 * stride_);
    draw_sharp_row(sum_, azimuth, key, wedge.power_row(azimuth), drawn.data());
    iq = drawn.data();
  } else {
    iq = wedge.iq_row(azimuth);
  }
  set_iq(row, iq);
  ask(kBinWork * static_cast<std::int64_t>(stride_));
  if (!doppler.has_moving()) return;
  std::vector<float> moving(stride_), sea(stride_);
  if (!doppler.windy().empty()) moving_power(doppler, wedge, azimuth, moving);
  if (doppler.has_sea()) power_of_materials(wedge, azimuth, doppler.sea().materials, 1, sea);
  const float* const power = wedge.power_row(azimuth);
  for (std::size_t m = 0; m < stride_; ++m) {
    const float away = moving[m] + sea[m];
    if (!(away > 0)) continue;
    const float left = std::sqrt(std::max(0.0F, 1 - away / power[m]));
    row.re[m] *= left;
    row.im[m] *= left;
    moving[m] /= static_cast<float>(std::max(1, speeds_));
    sea[m] /= static_cast<float>(std::max(1, sea_speeds_));
  }
  const std::vector<double> hz = row.hz;
  for (int number = 0; number < speeds_; ++number)
    add_moving(azimuth, moving, number, mix64(key + static_cast<std::uint64_t>(number) + 1), hz,
               all.emplace_back());
  if (!doppler.has_sea()) return;
  std::vector<double> sea_hz(stride_);
  active_kernels().doppler_turns(
      {{static_cast<int>(stride_), wedge.sine_row(azimuth), doppler.turns_a_hz().data(),
        doppler.sea_doppler().level_hz(at), doppler.sea_doppler().up_hz()},
       sea_hz.data()});
  for (int number = 0; number < sea_speeds_; ++number)
    add_sea(azimuth, sea, number, mix64((key ^ kSeaDraw) + static_cast<std::uint64_t>(number)), sea_hz,
            all.emplace_back());
}

/// A part of the sea becomes a row of its own, each bin with a speed of its Gaussian law about the sea's mean
/// (SeaMotion). By Box and Muller, of which each part has a stratum of the radius: no few bins make what
/// cancellers leave.
void GroundPulses::add_sea(int azimuth, const std::vector<float>& power, int number, std::uint64_t key,
                           const std::vector<double>& hz, Row& sea) const {
  const std::uint64_t of_row = mix64(mix64(key ^ kSpeedDraw) + static_cast<std::uint64_t>(azimuth));
  sea.hz = hz;
  ask(kBinWork * 3 * static_cast<std::int64_t>(stride_));
  for (std::size_t m = 0; m < stride_; ++m) {
    if (!(power[m] > 0)) continue;
    const std::uint64_t hash = mix64(of_row + m);
    const double radius2 = -2 * log_of_positive((number + uniform_of_hash(hash)) / sea_speeds_);
    sea.hz[m] += sea_hz_ * std::sqrt(radius2) * sincos_turns(turns_of_hash(hash)).cos;
  }
  draw_moving(azimuth, power, key, sea);
}

/// Voltages of a row that moves.
void GroundPulses::draw_moving(int azimuth, const std::vector<float>& power, std::uint64_t key,
                               Row& moving) const {
  std::vector<float> iq(2 * stride_);
  draw_sharp_row(sum_, azimuth, mix64(key ^ kMovingDraw), power.data(), iq.data());
  set_iq(moving, iq.data());
}

/// A part of what moves becomes a row of its own. Billingsley's density of speeds falls as p = exp(-x), x =
/// beta |v|. Cancellers leave what is fast of it: x^2, x^4. So a third of the parts has speeds of p, one of
/// p x^2 and one of p x^4, and each its weight against all three: sums have p's mean, and no few bins make
/// them.
void GroundPulses::add_moving(int azimuth, std::vector<float> power, int number, std::uint64_t key,
                              const std::vector<double>& hz, Row& moving) const {
  const std::uint64_t of_row = mix64(mix64(key ^ kSpeedDraw) + static_cast<std::uint64_t>(azimuth));
  const int exponentials = 1 + 2 * (number % kSpeedLaws);
  moving.hz = hz;
  ask(kBinWork * (3 + exponentials) * static_cast<std::int64_t>(stride_));
  for (std::size_t m = 0; m < stride_; ++m) {
    if (!(power[m] > 0)) continue;
    std::uint64_t hash = of_row + m;
    double x = 0;
    for (int k = 0; k < exponentials; ++k) {
      hash = mix64(hash);
      x -= log_of_positive(uniform_of_hash(hash));
    }
    const bool opens = (mix64(hash) & 1) != 0;
    moving.hz[m] += (opens ? -moving_hz_ : moving_hz_) * x;
    const double x2 = x * x;
    power[m] *= static_cast<float>(kSpeedLaws / (1 + x2 / 2 + x2 * x2 / 24));
  }
  draw_moving(azimuth, power, key, moving);
}

void GroundPulses::sum_rows(const EchoRows::Ready& rows, std::size_t first_row, const PulseTrip& trip,
                            const std::vector<Row>& all, int parts) {
  std::vector<const double*> hz;
  std::vector<const float*> re, im;
  for (const Row& row : all) {
    hz.push_back(row.hz.data());
    re.push_back(row.re.data());
    im.push_back(row.im.data());
  }
  const bool turns = boresight_.rate_rad_s != 0;
  std::vector<const float*> of_rows(all.size());
  std::vector<const float*> of_pulses(all.size());
  for (std::size_t tile = 0; tile < sum_.steepest.size(); ++tile) {
    for (std::size_t at = 0; at < all.size() / static_cast<std::size_t>(parts); ++at) {
      const std::size_t k = first_row + at;
      const int azimuth = sum_.sharp_azimuth(window_.first_azimuth + static_cast<int>(k));
      const int step = std::min(rows.rows[k]->kernels_of(azimuth)[tile], sum_.steepest[tile]);
      const float* const of_row = gains(k, step);
      for (int part = 0; part < parts; ++part)
        of_rows[at * static_cast<std::size_t>(parts) + static_cast<std::size_t>(part)] = of_row;
    }
    for (const int like : trip.pulses) {
      const int first = turns ? first_of_like_[static_cast<std::size_t>(like)] : 0;
      std::ranges::transform(of_rows, of_pulses.begin(), [&](const float* of_row) { return of_row + first; });
      const int n = times_.n_like(like);
      active_kernels().pulse_sum({hz.data(), re.data(), im.data(), of_pulses.data(), turns,
                                  static_cast<int>(all.size()), static_cast<int>(tile) * EchoPlan::kTile,
                                  times_.at_s(like), times_.pattern_s(), n, pulse_row(re_, like) + pad_,
                                  pulse_row(im_, like) + pad_,
                                  static_cast<std::size_t>(times_.pattern()) * row_floats_});
      ask(static_cast<std::int64_t>(all.size()) * n * EchoPlan::kTile / kProducts);
    }
  }
}

/// What makes the squares of the gains in the middle of the train add up to 1, over the width of a row, as a
/// map's weights do.
double GroundPulses::level(int step) {
  double& level = levels_[static_cast<std::size_t>(step)];
  if (level > 0) return level;
  const double cosine = cosine_steps::cosine(step);
  double squares = 0;
  for (int k = 0; k < window_.n_taps; ++k) {
    const double gain =
        beam_.gain(sum_.row_middle_rad(window_.first_azimuth + k) - boresight_.middle_rad, cosine);
    squares += gain * gain;
  }
  ask(std::int64_t{kGainWork} * window_.n_taps);
  level = squares > 0 ? 1 / std::sqrt(squares * sum_.row_rad()) : 0;
  return level;
}

const float* GroundPulses::gains(std::size_t row, int step) {
  std::vector<float>& gains = gains_[row * cosine_steps::kCount + static_cast<std::size_t>(step)];
  if (!gains.empty()) return gains.data();
  const double scale = level(step) * std::sqrt(sum_.power_scale);
  const double cosine = cosine_steps::cosine(step);
  const double row_rad = sum_.row_middle_rad(window_.first_azimuth + static_cast<int>(row));
  const auto gain_at = [&](double t_s) {
    return static_cast<float>(beam_.gain(row_rad - boresight_.at_rad(t_s), cosine) * scale);
  };
  if (boresight_.rate_rad_s == 0) {
    gains.push_back(gain_at(0));
  } else {
    for (int like = 0; like < times_.pattern(); ++like)
      for (int pulse = like; pulse < times_.n(); pulse += times_.pattern())
        gains.push_back(gain_at(times_.at_s(pulse)));
  }
  ask(kGainWork * static_cast<std::int64_t>(gains.size()));
  return gains.data();
}

void GroundPulses::turn_pulses(const PulseTrip& trip) {
  for (const int like : trip.pulses)
    for (int pulse = like; pulse < times_.n(); pulse += times_.pattern()) {
      const double t_s = times_.at_s(pulse);
      active_kernels().turn_row({static_cast<int>(stride_), turns_a_s2_.data(), t_s * t_s,
                                 pulse_row(re_, pulse) + pad_, pulse_row(im_, pulse) + pad_});
      ask(kBinWork * static_cast<std::int64_t>(stride_));
    }
}

/// The pulse's response, into the gates.
void GroundPulses::sum_ranges(int pulse, PulseTrain& train) {
  const std::vector<float>& taps = sum_.gate_voltage;
  const std::ptrdiff_t from = static_cast<std::ptrdiff_t>(pad_) + sum_.first_range + sum_.first_gate_tap;
  const int n = (sum_.n_range - 1) * sum_.range_parts + 1;
  const auto filter = [&](std::vector<float>& of, std::vector<float>& to) {
    active_kernels().range_sum(
        {1, static_cast<int>(taps.size()), taps.data(), pulse_row(of, pulse) + from, n, to.data()});
  };
  filter(re_, range_re_);
  filter(im_, range_im_);
  ask(2 * static_cast<std::int64_t>(taps.size()) * n / kProducts);
  std::complex<float>* const gates =
      train.iq.data() + static_cast<std::size_t>(pulse) * static_cast<std::size_t>(train.n_range);
  for (int m = 0; m < sum_.n_range; ++m) {
    const auto sharp = static_cast<std::size_t>(m) * static_cast<std::size_t>(sum_.range_parts);
    gates[m] += std::complex<float>(range_re_[sharp], range_im_[sharp]);
  }
}

}  // namespace obliq
