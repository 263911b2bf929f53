#include "server/radar/sweep/ground_light.h"

#include <algorithm>
#include <cmath>

namespace obliq {
namespace {

/// A share below this is a sliver beside a building, no gap between two.
constexpr double kLeastLeft = 1.0 / 64;

/// One plane's profile, node by node.
struct Nodes {
  const float* horizon;
  const float* range_bin;
  const float* hidden;
  const float* light;
  int n;

  Nodes(const NodeProfiles& all, int plane) : n(all.n_nodes) {
    const std::size_t first = static_cast<std::size_t>(plane) * static_cast<std::size_t>(all.stride);
    horizon = all.horizon + first;
    light = all.sine == nullptr ? horizon : all.sine + first;
    range_bin = all.range_bin + first;
    hidden = all.hidden + first;
  }

  /// The first node from k on behind which something is hidden; n - 1: none.
  int next_hidden(int k) const {
    while (k + 1 < n && !(hidden[k] > 0)) ++k;
    return std::min(k, n - 1);
  }

  /// Of what is visible of a range bin's ground over terrain, what buildings leave. Light grows evenly
  /// from node to node. k: a node in the bin or behind it.
  double left_of(int bin, int k) const {
    while (k > 0 && range_bin[k] > static_cast<float>(bin)) --k;
    double visible = 0;
    double gone = 0;
    for (; k + 1 < n && range_bin[k] < static_cast<float>(bin + 1); ++k) {
      const double from = static_cast<double>(range_bin[k]);
      const double length = static_cast<double>(range_bin[k + 1]) - from;
      const double rise = static_cast<double>(horizon[k + 1]) - static_cast<double>(horizon[k]);
      if (!(length > 0 && rise > 0)) continue;
      const bool whole = from >= bin && from + length <= bin + 1;
      const double part =
          whole ? 1
                : std::clamp((std::min(from + length, bin + 1.0) - std::max(from, bin + 0.0)) / length, 0.0,
                             1.0);
      const double lit = static_cast<double>(light[k + 1]) - static_cast<double>(light[k]);
      visible += part * lit;
      if (hidden[k] > 0) gone += part * (static_cast<double>(hidden[k]) * (lit / rise));
    }
    return gone > 0 ? 1 - gone / visible : 1;
  }
};

}  // namespace

void keep_shares(const NodeProfiles& all, int plane, int n_range, int profile, float* kept,
                 EchoCells& cells) {
  const Nodes nodes(all, plane);
  int next_bin = 0;
  for (int k = nodes.next_hidden(0); k + 1 < nodes.n && next_bin < n_range; k = nodes.next_hidden(k + 1)) {
    const auto first = static_cast<int>(std::floor(nodes.range_bin[k]));
    const auto last = static_cast<int>(std::floor(nodes.range_bin[k + 1]));
    for (next_bin = std::max(next_bin, first); next_bin <= last && next_bin < n_range; ++next_bin) {
      const double left = nodes.left_of(next_bin, k);
      const bool none = !(left >= kLeastLeft);
      kept[static_cast<std::size_t>(next_bin) * kWedgeAzimuthBins] =
          none ? 0 : static_cast<float>(std::min(1.0, left));
      if (none) cells.mark_building_shadow(profile, next_bin);
    }
  }
}

}  // namespace obliq
