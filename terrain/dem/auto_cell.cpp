#include "terrain/dem/auto_cell.h"

#include <fmt/core.h>

#include <algorithm>

#include "terrain/grid_area.h"

namespace obliq {
namespace {

constexpr double kLeastAllowed_m = 0.5;

/// Time of marching over ground with one cell a footprint, by a frame's other time. Of the sweep, measured
/// over mountains (30 m posts, 60 degrees, 3 to 22 km, 512 x 1024 bins) with cells of 60, 30, 15 and 7.5 m:
/// 184, 268, 472 and 862 ms, which is 100 ms and 47 m of cell. Frusta with pixels pay a ninth of this.
constexpr double kMarchShare = 5;

}  // namespace

double allowed_error_m(const DemAccuracy& accuracy) { return std::max(kLeastAllowed_m, accuracy.rmse_m / 2); }

double halving_time(double cell_m, double footprint_m) {
  const double march = kMarchShare * footprint_m / cell_m;
  return (1 + 2 * march) / (1 + march);
}

double finer_cell_m(const AutoCellLimits& limits, double cell_m, double posts, const SourceError& error,
                    std::string& left) {
  left.clear();
  if (!(limits.most_posts > 0) || error.posts == 0 || error.p95_m <= allowed_error_m(limits.accuracy))
    return 0;
  const double finer_m = round_to_quantum_m(cell_m / 2);
  if (4 * posts > limits.most_posts) {
    left = fmt::format("{:.3g} million posts, of {:.3g} million (a quarter of flight.max_megaposts)",
                       4e-6 * posts, 1e-6 * limits.most_posts);
  } else if (const double time = halving_time(cell_m, limits.footprint_m); time > kMostHalvingTime) {
    left = fmt::format("{:.3g} times the frame time, of {:.3g}", time, kMostHalvingTime);
  } else if (finer_m < cell_m) {
    return finer_m;
  }
  return 0;
}

}  // namespace obliq
