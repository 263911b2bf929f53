#pragma once
// What a Doppler filter makes of an echo beside its middle.
#include <cstdint>
#include <vector>

#include "server/radar/settings.h"
#include "server/radar/simd/receiver/sharpened_sum.h"
#include "server/radar/taper.h"

namespace obliq {

/// The weights of pulses.
Taper doppler_taper(const DopplerSettings& settings);

/// Power of noise behind the filter over that before: sum w^2 / (sum w)^2 of dbs; else 1.
double doppler_noise_factor(const RadarSettings& settings);
/// The same of a synthetic aperture of so many pulses, which need not be whole: the weights' noise width over
/// their number. One pulse or less: 1.
double aperture_noise_factor(const DopplerSettings& settings, double pulses);

/// D(u) = sum of w_n cos(2 pi u (n - (N - 1)/2) / N) over sum of w_n, n from 0 to N - 1: real and even, 1 at
/// u = 0 cells, again after N cells but for its sign where N is even. Without pulses, of synthetic aperture,
/// the transform of the weights itself, as far as kSarCells. A table, linear between its steps, of a whole
/// period.
class DopplerResponse {
 public:
  static constexpr double kSarCells = 24;

  explicit DopplerResponse(const RadarSettings& settings);
  /// Of values each 1 / kStepsACell cells from 0 on to a half of `period_cells`, about which it is even too;
  /// period_cells 0: it ends with the last, which is 0.
  DopplerResponse(const std::vector<double>& values, int period_cells);

  double at(double cells) const;
  // Numbers of a table of so many cells.
  static std::int64_t n_steps(std::int64_t cells) { return cells * DopplerTable::kStepsACell + 2; }
  static std::int64_t n_terms(std::int64_t cells) {
    return DopplerTable::kTerms * (2 * (cells * DopplerTable::kPolynomialsACell + 1) + 1);
  }
  /// Valid as long as this is.
  DopplerTable table() const;

 private:
  void take(const std::vector<double>& values);
  void add_polynomials(const std::vector<double>& values, bool goes_on);

  int period_cells_ =
      0;  ///< after which it begins anew, even about the middle, where the table ends; 0: it ends there
  std::vector<float> steps_;        // and one more
  std::vector<float> polynomials_;  // [..][kTerms], that about 0 cells in the middle
};

}  // namespace obliq
