#include "server/radar/rays/polar_columns.h"

#include <algorithm>
#include <numbers>

namespace obliq {

std::vector<PolarColumn> polar_columns(const FramePlan& plan, AzimuthRange range) {
  const std::int64_t columns = plan.settings().pixel_columns;
  const BinGrid& bins = plan.bins();
  const double step_rad = bins.azimuth_width_rad * bins.n_azimuth / static_cast<double>(columns);
  std::vector<PolarColumn> found;
  // floor((c + 1/2) n_azimuth / columns), in integers: no column before the bin's share has its centre in it.
  for (std::int64_t c = range.first * columns / bins.n_azimuth; c < columns; ++c) {
    const auto bin = static_cast<int>((2 * c + 1) * bins.n_azimuth / (2 * columns));
    if (bin < range.first) continue;
    if (bin >= range.first + range.count) break;
    const double offset_rad = bins.azimuth_start_rad + (static_cast<double>(c) + 0.5) * step_rad;
    found.push_back({static_cast<int>(c), bin, sincos_turns(offset_rad / (2 * std::numbers::pi))});
  }
  return found;
}

}  // namespace obliq
