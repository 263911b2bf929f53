#include "server/radar/doppler/doppler_response.h"

#include <algorithm>
#include <cmath>

#include "terrain/base/asking.h"

namespace obliq {
namespace {

/// As [pulse] has them by default: sidelobes 30 dB down, four of them nearly equal.
constexpr double kTaylorSidelobe_db = 30;
constexpr int kTaylorNbar = 4;
constexpr int kFunction = 100;  // in units of ask()

}  // namespace

Taper doppler_taper(const DopplerSettings& settings) {
  switch (settings.window) {
    case DopplerWindow::hamming:
      return Taper::hamming();
    case DopplerWindow::hann:
      return Taper::hann();
    case DopplerWindow::taylor:
      return Taper::taylor(kTaylorNbar, kTaylorSidelobe_db);
    case DopplerWindow::blackman_harris:
      return Taper::blackman_harris();
    default:
      return Taper::uniform();
  }
}

double doppler_noise_factor(const RadarSettings& settings) {
  if (settings.mode != RadarMode::dbs && settings.mode != RadarMode::sar) return 1;
  const int n = settings.doppler.pulses;
  return doppler_taper(settings.doppler).sampled_noise_width(n) / n;
}

DopplerResponse::DopplerResponse(const RadarSettings& settings) {
  const Taper taper = doppler_taper(settings.doppler);
  const bool is_sar = settings.mode == RadarMode::sar;
  const double end_cells = is_sar ? kSarCells : settings.doppler.pulses / 2.0;
  period_cells_ = is_sar ? 0 : settings.doppler.pulses;
  const auto steps = static_cast<int>(std::ceil(end_cells * kStepsACell));
  for (int k = 0; k <= steps; ++k) {
    if (k % kStepsACell == 0) ask(kFunction * kStepsACell);
    const double u = static_cast<double>(k) / kStepsACell;
    table_.push_back(static_cast<float>(is_sar ? taper.transform(u) : taper.sampled(u, period_cells_)));
  }
  // Behind the end: what is looked up between the last two.
  table_.push_back(is_sar ? 0.0F : table_.back());
  if (is_sar) table_[table_.size() - 2] = 0;
}

double DopplerResponse::at(double cells) const {
  double sign = 1;
  if (period_cells_ > 0) {
    const double periods = std::nearbyint(cells / period_cells_);
    cells -= periods * period_cells_;
    if (period_cells_ % 2 == 0 && std::remainder(periods, 2) != 0) sign = -1;
  }
  const double steps = std::min(std::abs(cells) * kStepsACell, static_cast<double>(table_.size() - 2));
  const auto k = static_cast<std::size_t>(steps);
  const double low = static_cast<double>(table_[k]);
  return sign * (low + (steps - static_cast<double>(k)) * (static_cast<double>(table_[k + 1]) - low));
}

}  // namespace obliq
