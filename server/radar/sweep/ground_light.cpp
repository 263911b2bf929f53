#include "server/radar/sweep/ground_light.h"

#include <algorithm>
#include <cmath>

namespace obliq {
namespace {

/// A share below this is a sliver beside a building, no gap between two.
constexpr double kLeastLeft = 1.0 / 64;

/// Behind every swath, in range bins: where no ground is known, nodes lie farther off still.
constexpr float kFarBehind = 1e6F;

/// One plane's profile, node by node, from the antenna outwards.
class Nodes {
 public:
  Nodes(const NodeProfiles& all, int plane) : n_(all.n_nodes) {
    const std::size_t first = static_cast<std::size_t>(plane) * static_cast<std::size_t>(all.stride);
    horizon_ = all.horizon + first;
    light_ = all.sine == nullptr ? horizon_ : all.sine + first;
    range_bin_ = all.range_bin + first;
    hidden_ = all.hidden + first;
  }

  /// Goes on to the next range bin, from `bin` on, in which something is hidden. False: there is none.
  bool go_to_hidden(int& bin) {
    const int from = k_;
    while (k_ + 1 < n_ && !(hidden_[k_] > 0)) ++k_;
    if (at_end()) return false;
    bin = std::max(bin, static_cast<int>(std::floor(std::min(range_bin_[k_], kFarBehind))));
    while (k_ > from && range_bin_[k_] > static_cast<float>(bin)) --k_;
    return true;
  }
  bool at_end() const { return k_ + 1 >= n_; }

  /// What is visible over terrain up to a range bin's near edge, and what buildings hide of it. Light grows
  /// evenly from node to node. Edges come in their order.
  struct Sum {
    double visible, hidden;
  };
  Sum up_to(int edge) {
    const auto at = static_cast<float>(edge);
    for (; k_ + 1 < n_ && range_bin_[k_ + 1] <= at; ++k_) hidden_sum_ += hidden_light(k_);
    const auto light = static_cast<double>(light_[k_]);
    if (at_end() || !(range_bin_[k_] < at)) return {light, hidden_sum_};
    const double part = (static_cast<double>(at) - static_cast<double>(range_bin_[k_])) /
                        (static_cast<double>(range_bin_[k_ + 1]) - static_cast<double>(range_bin_[k_]));
    return {light + part * (static_cast<double>(light_[k_ + 1]) - light),
            hidden_sum_ + part * hidden_light(k_)};
  }

 private:
  double hidden_light(int k) const {
    const auto hidden = static_cast<double>(hidden_[k]);
    if (light_ == horizon_) return hidden;
    const double rise = static_cast<double>(horizon_[k + 1]) - static_cast<double>(horizon_[k]);
    const double lit = static_cast<double>(light_[k + 1]) - static_cast<double>(light_[k]);
    return rise > 0 ? hidden * (lit / rise) : 0;
  }

  const float* horizon_;
  const float* range_bin_;
  const float* hidden_;
  const float* light_;
  int n_;
  int k_ = 0;  // a node before the next edge
  double hidden_sum_ = 0;
};

}  // namespace

void keep_shares(const NodeProfiles& all, int plane, int n_range, int profile, float* kept,
                 EchoCells& cells) {
  Nodes nodes(all, plane);
  for (int bin = 0; bin < n_range && nodes.go_to_hidden(bin);) {
    double hidden = 1;
    for (Nodes::Sum near = nodes.up_to(bin), far; bin < n_range && !nodes.at_end() && hidden > 0; ++bin) {
      far = nodes.up_to(bin + 1);
      hidden = far.hidden - near.hidden;
      const double visible = far.visible - near.visible;
      near = far;
      if (!(hidden > 0 && visible > 0)) continue;
      const double left = 1 - hidden / visible;
      const bool none = !(left >= kLeastLeft);
      kept[static_cast<std::size_t>(bin) * kWedgeAzimuthBins] =
          none ? 0 : static_cast<float>(std::min(1.0, left));
      if (none) cells.mark_building_shadow(profile, bin);
    }
  }
}

}  // namespace obliq
