#include "server/output/bin_levels.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "proto/obliq.pb.h"
#include "server/radar/simd/exact_math.h"

namespace obliq {
namespace {

constexpr double kLeast = std::numeric_limits<double>::min();
constexpr double kDb_of_log = 10 / std::numbers::ln10;

}  // namespace

bool can_be_drawn(const BinBlock& bins) { return !bins.iq.empty() || !bins.power_w.empty(); }

BinLevels bin_levels(const wire::FrameDescriptor& descriptor, const BinBlock& bins) {
  BinLevels levels;
  levels.of_power = bins.iq.empty();
  levels.unit = levels.of_power ? descriptor.power_unit() : descriptor.unit();
  levels.db.assign(static_cast<std::size_t>(bins.n_azimuth) * static_cast<std::size_t>(bins.n_range),
                   BinLevels::kNoValue);
  if (!can_be_drawn(bins)) return levels;
  for (std::size_t bin = 0; bin < levels.db.size(); ++bin) {
    if (!bins.count.empty() && bins.count[bin] == 0) continue;
    const double power = levels.of_power ? bins.power_w[bin] : std::norm(std::complex<double>(bins.iq[bin]));
    if (power >= kLeast && std::isfinite(power))
      levels.db[bin] = static_cast<float>(kDb_of_log * log_of_positive(power));
  }
  return levels;
}

std::uint8_t state_of(const BinBlock& bins, const BinLevels& levels, std::size_t bin) {
  if (!bins.state.empty()) return bins.state[bin];
  return levels.db[bin] == BinLevels::kNoValue ? kUnknownState : static_cast<std::uint8_t>(BinState::sampled);
}

}  // namespace obliq
