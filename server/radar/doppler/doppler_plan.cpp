#include "server/radar/doppler/doppler_plan.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/radar/doppler/canceller.h"
#include "terrain/base/asking.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

/// By so much the sea's spectrum widens from one response to the next: its power stays the same.
constexpr double kSeaStep = 1.05, kSeaStepCells = 0.03;

double span_middle_m(const SharpRanges& ranges, int span) {
  return ranges.middle_m(span * CellSpan::kBins + CellSpan::kBins / 2);
}

}  // namespace

int most_sea_responses(const SharpRanges& ranges) {
  const int spans = ranges.n / CellSpan::kBins;
  const double ratio = span_middle_m(ranges, spans - 1) / span_middle_m(ranges, 0);
  return std::min(spans, 2 + static_cast<int>(std::log(ratio) / std::log(kSeaStep)));
}

DopplerPlan::DopplerPlan(const RadarSettings& settings, const SectorVelocity& velocity,
                         const SharpRanges& ranges, double turn_rad, double above_ground_m,
                         std::vector<int> windy, MovingSea sea, bool all_windy)
    : mode_(settings.mode),
      delays_(settings.doppler.canceller),
      over_noise_root_(1 / std::sqrt(canceller_noise_gain(delays_))),
      has_lock_(settings.mode == RadarMode::mti && settings.doppler.clutter_lock && !velocity.is_zero()),
      turn_rad_(settings.mode == RadarMode::mti ? turn_rad : 0),
      above_ground_m_(above_ground_m),
      pulse_s_(1 / settings.pulse.prf_hz),
      train_s_(settings.doppler.pulses / settings.pulse.prf_hz),
      velocity_(velocity),
      windy_(std::move(windy)),
      all_windy_(all_windy),
      sea_(std::move(sea)),
      ground_(velocity, wavelength_at(settings.frequency_ghz)),
      response_(settings) {
  if (!windy_.empty()) {
    moving_share_ = WindSpectrum(settings.atmosphere.wind_m_s, settings.frequency_ghz).moving;
    residue_ = moving_residue(settings);
  }
  if (has_sea()) {
    sea_doppler_ = {sea_.velocity, wavelength_at(settings.frequency_ghz)};
    sea_residue_ = obliq::sea_residue(settings);
  }
  // psi is that of the sector's centre.
  if (mode_ == RadarMode::sar) sar_s_a_m_ = aperture_s_a_m(settings, velocity.across_m_s(0));
  ask(4 * ranges.n);
  for (int bin = 0; bin < ranges.n; ++bin) {
    turns_a_hz_.push_back(turns_a_hz(ranges.middle_m(bin)));
    level_sine_.push_back(static_cast<float>(level_sine(ranges.middle_m(bin))));
  }
  if (mode_ == RadarMode::dbs || mode_ == RadarMode::sar) {
    place_level_ground();
    if (has_sea()) spread_sea(settings, ranges);
  }
}

void DopplerPlan::spread_sea(const RadarSettings& settings, const SharpRanges& ranges) {
  const double deviation_hz = SeaMotion(settings).deviation_hz(wavelength_at(settings.frequency_ghz));
  const int spans = ranges.n / CellSpan::kBins;
  if (mode_ == RadarMode::dbs) {
    const double across_m_s = velocity_.most_across_m_s(settings.sector_deg * kDegree_rad);
    sea_responses_.emplace_back(settings.doppler, deviation_hz * train_s_,
                                cells_in_beam(settings, sea_.beam_rad, across_m_s));
    sea_response_of_.assign(static_cast<std::size_t>(spans), 0);
    return;
  }
  // In cells an image's grows with range. What its rows show of the spectrum is narrower on steep ground and
  // where the antenna flies less across.
  const double across_m_s = velocity_.across_m_s(0);  // 0: refused by image_fault
  const double least_m_s = velocity_.least_across_m_s(settings.sector_deg * kDegree_rad);
  const double shown = across_m_s > 0 ? least_m_s / across_m_s : 1;
  double last_cells = 0;
  for (int span = 0; span < spans; ++span) {
    const double range_m = span_middle_m(ranges, span);
    const double cells = deviation_hz * turns_a_hz(range_m);
    if (sea_responses_.empty() || cells > last_cells * kSeaStep + kSeaStepCells) {
      const double sine = level_sine(range_m);
      const double reach_cells = sea_.smear.spread_rad * range_m / settings.doppler.resolution_m * shown *
                                 std::sqrt(1 - sine * sine);
      sea_responses_.push_back(SpreadResponse::of_aperture(
          settings.doppler, cells, static_cast<int>(std::ceil(DopplerResponse::kSarCells + reach_cells))));
      last_cells = cells;
    }
    sea_response_of_.push_back(sea_responses_.size() - 1);
  }
}

void DopplerPlan::place_level_ground() {
  for (std::size_t bin = 0; bin < level_sine_.size(); ++bin) {
    const double sine = static_cast<double>(level_sine_[bin]);
    level_cells_a_hz_.push_back(static_cast<float>(turns_a_hz_[bin] * std::sqrt(1 - sine * sine)));
  }
  for (auto from = level_cells_a_hz_.begin(); from != level_cells_a_hz_.end(); from += CellSpan::kBins) {
    const auto [low, high] = std::minmax_element(from, from + CellSpan::kBins);
    level_spans_.push_back({0.5F * (*low + *high), 0.5F * (*high - *low)});
  }
}

double DopplerPlan::turns_a_hz(double range_m) const {
  switch (mode_) {
    case RadarMode::mti:
      return pulse_s_;
    case RadarMode::dbs:
      return train_s_;
    case RadarMode::pulses:
      return 1;
    default:
      return sar_s_a_m_ * range_m;
  }
}

double DopplerPlan::level_sine(double range_m) const {
  return -std::clamp(above_ground_m_ / std::max(range_m, 1.0), -1.0, 1.0);
}

std::complex<double> DopplerPlan::weight(double hz, double range_m, const SinCos& output,
                                         const std::vector<double>& gains) const {
  const bool follows = !is_canceller() || has_lock_;
  const double middle_hz = follows ? ground_.hz(output, level_sine(range_m)) : 0;
  const double turns = (hz - middle_hz) * turns_a_hz(range_m);
  if (!is_canceller()) return gains.front() * response_.at(turns);
  // As at the middle of the pulses.
  if (turn_rad_ == 0)
    return gains.front() * std::pow(2 * sincos_turns(turns / 2).sin, delays_) * over_noise_root_;
  return cancelled(gains, turns);
}

}  // namespace obliq
