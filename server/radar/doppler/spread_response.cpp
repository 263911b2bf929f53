#include "server/radar/doppler/spread_response.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "terrain/base/asking.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

constexpr int kStepsACell = DopplerTable::kStepsACell;
constexpr int kFunction = 100;  // in units of ask()
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

constexpr std::size_t kTogether = 8;  // chains of additions that do not wait for each other

/// To sum[k] adds lags[l] cos(l x[k]) for all l, by Clenshaw's recurrence.
void add_cosines(const std::vector<double>& lags, const double* x, double* sum) {
  double twice[kTogether], next[kTogether] = {}, after[kTogether] = {};
  for (std::size_t k = 0; k < kTogether; ++k) twice[k] = 2 * std::cos(x[k]);
  for (std::size_t l = lags.size() - 1; l > 0; --l)
    for (std::size_t k = 0; k < kTogether; ++k) {
      const double at = lags[l] + twice[k] * next[k] - after[k];
      after[k] = next[k];
      next[k] = at;
    }
  for (std::size_t k = 0; k < kTogether; ++k) sum[k] += lags[0] + twice[k] / 2 * next[k] - after[k];
}

/// The power's root at each step from 0 on; it has a period of n cells.
std::vector<double> root_of_power(const std::vector<double>& lags, int n, std::size_t steps) {
  std::vector<double> power((steps + kTogether - 1) / kTogether * kTogether);
  for (std::size_t first = 0; first < steps; first += kTogether) {
    ask(static_cast<std::int64_t>(lags.size()));
    double x[kTogether];
    for (std::size_t k = 0; k < kTogether; ++k)
      x[k] = 2 * kPi * static_cast<double>(first + k) / kStepsACell / n;
    add_cosines(lags, x, power.data() + first);
  }
  power.resize(steps);
  for (double& value : power) value = std::sqrt(std::max(0.0, value));
  return power;
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

/// Voltage gain of a beam, u cells beside its middle; beam_cells: its half power width.
double shown(double u, double beam_cells) {
  const double of_beam = u / std::max(1.0, beam_cells);
  return std::exp(-4 * std::numbers::ln2 * of_beam * of_beam);
}

/// c, which root(u) at a phase of pi c u^2 needs for the spread in time of a train under these weights.
double chirp(const std::vector<double>& root, const std::vector<double>& weights, double beam_cells) {
  double sum = 0, squares = 0, rises = 0, last = root[0];
  for (std::size_t k = 0; k < root.size(); ++k) {
    const double u = static_cast<double>(k) / kStepsACell;
    const double value = root[k] * shown(u, beam_cells);
    sum += value * value;
    squares += u * u * value * value;
    rises += std::pow((value - last) * kStepsACell, 2);
    last = value;
  }
  const double own = rises / sum / (4 * kPi * kPi);
  return std::sqrt(std::max(0.0, spread_of_train2(weights) - own) * sum / squares);
}

}  // namespace

SpreadResponse::SpreadResponse(const DopplerSettings& settings, double deviation_cells, double beam_cells)
    : SpreadResponse(train_parts(settings, deviation_cells, beam_cells), 2 * settings.pulses) {}

void SpreadResponse::Parts::add(double root, double phase) {
  in_phase.push_back(root * std::cos(phase));
  ahead.push_back(root * std::sin(phase));
}

SpreadResponse SpreadResponse::of_aperture(const DopplerSettings& settings, double deviation_cells,
                                           int end_cells) {
  // The response repeats every n cells, well beyond its end.
  const int n = 4 * end_cells;
  const std::vector<double> weights = doppler_taper(settings).sampled_weights(n);
  const std::vector<double> lags = lags_of(weights, deviation_cells);
  std::vector<double> root = root_of_power(lags, n, static_cast<std::size_t>(end_cells) * kStepsACell + 1);
  const double c = chirp(root, weights, HUGE_VAL);
  root.back() = 0;
  ask(kFunction * std::ssize(root) / std::int64_t{kTogether});
  double shown_power = root[0] * root[0] / 2;
  for (std::size_t k = 1; k < root.size(); ++k) shown_power += root[k] * root[k];
  const double up = std::sqrt(lags[0] * n * kStepsACell / (2 * shown_power));
  Parts parts;
  for (std::size_t k = 0; k < root.size(); ++k) {
    const double u = static_cast<double>(k) / kStepsACell;
    parts.add(up * root[k], kPi * c * u * u);
  }
  return {parts, 0};
}

SpreadResponse::Parts SpreadResponse::train_parts(const DopplerSettings& settings, double deviation_cells,
                                                  double beam_cells) {
  const int n = settings.pulses;
  const std::vector<double> weights = doppler_taper(settings).sampled_weights(n);
  const std::vector<double> root =
      root_of_power(lags_of(weights, deviation_cells), n, static_cast<std::size_t>(n * kStepsACell / 2) + 1);
  const double c = chirp(root, weights, beam_cells);
  // The power is even about 0 and about half of its period.
  Parts parts;
  for (int k = 0; k <= n * kStepsACell; ++k) {
    const int within = std::min(k, n * kStepsACell - k);
    const double u = static_cast<double>(within) / kStepsACell;
    parts.add(root[static_cast<std::size_t>(within)], kPi * c * u * u);
  }
  return parts;
}

}  // namespace obliq
