#include "server/explain/power_change.h"

#include <algorithm>
#include <cmath>

namespace obliq {
namespace {

constexpr double kOneDecibel = 1.2589254117941673;  // 10^0.1

}  // namespace

double PowerChange::total_db() const { return 10 * std::log10(total_ratio); }

PowerChange larger_of(const PowerChange& a, const PowerChange& b) {
  PowerChange larger;
  larger.lit = std::max(a.lit, b.lit);
  larger.median_db = std::max(a.median_db, b.median_db);
  larger.percentile95_db = std::max(a.percentile95_db, b.percentile95_db);
  larger.over_1_db = std::max(a.over_1_db, b.over_1_db);
  larger.vanished = std::max(a.vanished, b.vanished);
  larger.appeared = std::max(a.appeared, b.appeared);
  larger.total_ratio = std::abs(a.total_db()) > std::abs(b.total_db()) ? a.total_ratio : b.total_ratio;
  return larger;
}

PowerChange power_change(const std::vector<double>& power_w, const std::vector<double>& changed_w,
                         const RangeBins& ranges) {
  const BinErrors there = bin_errors(changed_w, power_w, ranges);
  const BinErrors back = bin_errors(power_w, changed_w, ranges);
  PowerChange change;
  change.lit = there.lit;
  change.median_db = there.median_db;
  change.percentile95_db = there.percentile95_db;
  if (there.truth_energy_w > 0) change.total_ratio = there.energy_w / there.truth_energy_w;
  if (there.lit == 0) return change;
  const auto lit = static_cast<double>(there.lit);
  change.vanished = static_cast<double>(there.gaps) / lit;
  change.appeared = static_cast<double>(back.gaps) / lit;
  std::uint64_t changed = 0;
  for (std::size_t k = 0; k < power_w.size(); ++k) {
    const int bin = static_cast<int>(k % static_cast<std::size_t>(ranges.n_range));
    if (!(ranges.q(bin, power_w[k]) >= 1e-3 * there.median_q && power_w[k] > 0)) continue;
    const double ratio = changed_w[k] / power_w[k];
    if (ratio > kOneDecibel || ratio < 1 / kOneDecibel) ++changed;
  }
  change.over_1_db = static_cast<double>(changed) / lit;
  return change;
}

}  // namespace obliq
