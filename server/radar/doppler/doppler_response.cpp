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
constexpr int kStepsACell = DopplerTable::kStepsACell;

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
  if (settings.mode != RadarMode::dbs) return 1;
  const int n = settings.doppler.pulses;
  return doppler_taper(settings.doppler).sampled_noise_width(n) / n;
}

double aperture_noise_factor(const DopplerSettings& settings, double pulses) {
  return pulses > 1 ? std::min(1.0, doppler_taper(settings).noise_width() / pulses) : 1;
}

DopplerResponse::DopplerResponse(const RadarSettings& settings) {
  if (settings.mode == RadarMode::pulses) return;  // nothing is made of them
  const Taper taper = doppler_taper(settings.doppler);
  const bool is_sar = settings.mode == RadarMode::sar;
  const double end_cells = is_sar ? kSarCells : settings.doppler.pulses;
  period_cells_ = is_sar ? 0 : 2 * settings.doppler.pulses;
  const auto steps = static_cast<int>(std::ceil(end_cells * kStepsACell));
  std::vector<double> values;  // of each step
  for (int k = 0; k <= steps; ++k) {
    if (k % kStepsACell == 0) ask(kFunction * kStepsACell);
    const double u = static_cast<double>(k) / kStepsACell;
    values.push_back(is_sar ? taper.transform(u) : taper.sampled(u, settings.doppler.pulses));
  }
  if (is_sar) values.back() = 0;
  take(values);
}

DopplerResponse::DopplerResponse(const std::vector<double>& values, int period_cells)
    : period_cells_(period_cells) {
  take(values);
}

void DopplerResponse::take(const std::vector<double>& values) {
  steps_.reserve(values.size() + 1);
  steps_.assign(values.begin(), values.end());
  steps_.push_back(steps_.back());
  add_polynomials(values, period_cells_ > 0);
}

/// Each through the five values from two steps of polynomials before it to two behind it. On either side one
/// more, where the response has ended.
void DopplerResponse::add_polynomials(const std::vector<double>& values, bool goes_on) {
  constexpr std::ptrdiff_t kEach = kStepsACell / DopplerTable::kPolynomialsACell;
  const auto last = static_cast<std::ptrdiff_t>(values.size()) - 1;
  const auto value = [&](std::ptrdiff_t k) {
    k = std::abs(k);
    if (k > last) return goes_on ? values[static_cast<std::size_t>(2 * last - k)] : 0.0;
    return values[static_cast<std::size_t>(k)];
  };
  const std::ptrdiff_t n = last / kEach;
  polynomials_.assign(static_cast<std::size_t>(DopplerTable::kTerms * (2 * n + 3)), 0);
  auto to = polynomials_.begin() + DopplerTable::kTerms;
  for (std::ptrdiff_t k = -n * kEach; k <= n * kEach; k += kEach) {
    // Newton's differences about the middle (Stirling's formula), in steps of polynomials.
    const double m2 = value(k - 2 * kEach), m1 = value(k - kEach), at = value(k), p1 = value(k + kEach),
                 p2 = value(k + 2 * kEach);
    const double first = (8 * (p1 - m1) - (p2 - m2)) / 12;
    const double second = (16 * (p1 + m1) - (p2 + m2) - 30 * at) / 24;
    const double third = ((p2 - m2) - 2 * (p1 - m1)) / 12;
    const double fourth = ((p2 + m2) - 4 * (p1 + m1) + 6 * at) / 24;
    double scale = 1;
    for (const double term : {at, first, second, third, fourth}) {
      *to++ = static_cast<float>(term * scale);
      scale *= DopplerTable::kPolynomialsACell;
    }
  }
}

DopplerTable DopplerResponse::table() const {
  const std::size_t on_a_side = polynomials_.size() / DopplerTable::kTerms / 2;
  return {steps_.data(), static_cast<float>(steps_.size() - 2),
          polynomials_.data() + DopplerTable::kTerms * on_a_side, static_cast<int>(on_a_side) - 1,
          static_cast<float>(period_cells_)};
}

double DopplerResponse::at(double cells) const {
  if (period_cells_ > 0) cells -= std::nearbyint(cells / period_cells_) * period_cells_;
  const double steps = std::min(std::abs(cells) * kStepsACell, static_cast<double>(steps_.size() - 2));
  const auto k = static_cast<std::size_t>(steps);
  const double low = static_cast<double>(steps_[k]);
  return low + (steps - static_cast<double>(k)) * (static_cast<double>(steps_[k + 1]) - low);
}

}  // namespace obliq
