#pragma once
// What a Doppler filter makes of an echo beside its middle.
#include <vector>

#include "server/radar/beam/taper.h"
#include "server/radar/settings.h"

namespace obliq {

/// The weights of pulses.
Taper doppler_taper(const DopplerSettings& settings);

/// Power of noise behind the filter over that before: sum w^2 / (sum w)^2 of dbs and sar; else 1.
double doppler_noise_factor(const RadarSettings& settings);

/// D(u) = sum of w_n cos(2 pi u (n - (N - 1)/2) / N) over sum of w_n, n from 0 to N - 1: real and even, 1 at
/// u = 0 cells, again after N cells but for its sign where N is even. Without pulses, of synthetic aperture,
/// the transform of the weights itself, as far as kSarCells. A table, linear between its steps.
class DopplerResponse {
 public:
  static constexpr int kStepsACell = 64;
  static constexpr double kSarCells = 24;

  explicit DopplerResponse(const RadarSettings& settings);

  double at(double cells) const;
  /// [n + 2]; from 0 on.
  const std::vector<float>& table() const { return table_; }
  /// Cells after which it begins anew; 0: it ends with the table.
  int period_cells() const { return period_cells_; }

 private:
  int period_cells_ = 0;
  std::vector<float> table_;
};

}  // namespace obliq
