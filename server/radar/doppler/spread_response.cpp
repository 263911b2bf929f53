#include "server/radar/doppler/spread_response.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "terrain/base/asking.h"

namespace obliq {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kStepsACell = DopplerTable::kStepsACell;
/// What the Gaussian leaves of a lag counts down to here.
constexpr double kLeastLeft = 1e-12;

/// Of the weights, each lag on both sides, behind the Gaussian.
std::vector<double> lags_of(const std::vector<double>& weights, double deviation_cells) {
  const std::size_t n = weights.size();
  std::vector<double> lags;
  for (std::size_t l = 0; l < n; ++l) {
    const double x = kPi * deviation_cells * static_cast<double>(l) / static_cast<double>(n);
    const double left = std::exp(-2 * x * x);
    if (left < kLeastLeft) break;
    ask(static_cast<std::int64_t>(n - l));
    double sum = 0;
    for (std::size_t k = 0; k + l < n; ++k) sum += weights[k] * weights[k + l];
    lags.push_back((l == 0 ? 1 : 2) * left * sum);
  }
  return lags;
}

/// sum of lags[l] cos(l x), by Clenshaw's recurrence.
double cosine_sum(const std::vector<double>& lags, double x) {
  const double twice = 2 * std::cos(x);
  double next = 0, after = 0;
  for (std::size_t l = lags.size() - 1; l > 0; --l) {
    const double at = lags[l] + twice * next - after;
    after = next;
    next = at;
  }
  return lags[0] + twice / 2 * next - after;
}

/// The mean square of time in a train under these weights, in trains.
double spread_of_train2(const std::vector<double>& weights) {
  const auto n = static_cast<double>(weights.size());
  double sum = 0, squares = 0;
  for (std::size_t k = 0; k < weights.size(); ++k) {
    const double time = (static_cast<double>(k) + 0.5) / n - 0.5;
    sum += weights[k] * weights[k];
    squares += time * time * weights[k] * weights[k];
  }
  return squares / sum;
}

}  // namespace

SpreadResponse::SpreadResponse(const DopplerSettings& settings, double deviation_cells)
    : SpreadResponse(parts_of(settings, deviation_cells), 2 * settings.pulses) {}

SpreadResponse::Parts SpreadResponse::parts_of(const DopplerSettings& settings, double deviation_cells) {
  const int n = settings.pulses;
  const std::vector<double> weights = doppler_taper(settings).sampled_weights(n);
  const std::vector<double> lags = lags_of(weights, deviation_cells);
  // The power is even about 0 and about half of its period of N cells.
  const int half = n * kStepsACell / 2;
  std::vector<double> root;
  double sum = 0, squares = 0, rises = 0;
  for (int k = 0; k <= half; ++k) {
    ask(static_cast<std::int64_t>(lags.size()));
    const double u = static_cast<double>(k) / kStepsACell;
    root.push_back(std::sqrt(std::max(0.0, cosine_sum(lags, 2 * kPi * u / n))));
    sum += root.back() * root.back();
    squares += u * u * root.back() * root.back();
    if (k > 0) rises += std::pow((root.back() - root[root.size() - 2]) * kStepsACell, 2);
  }
  const double own = rises / sum / (4 * kPi * kPi);
  const double chirp = std::sqrt(std::max(0.0, spread_of_train2(weights) - own) * sum / squares);
  Parts parts;
  for (int k = 0; k <= n * kStepsACell; ++k) {
    const int within = std::min(k, n * kStepsACell - k);
    const double u = static_cast<double>(within) / kStepsACell;
    const double phase = kPi * chirp * u * u, value = root[static_cast<std::size_t>(within)];
    parts.in_phase.push_back(value * std::cos(phase));
    parts.ahead.push_back(value * std::sin(phase));
  }
  return parts;
}

}  // namespace obliq
