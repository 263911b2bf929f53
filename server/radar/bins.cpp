#include "server/radar/bins.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "terrain/base/asking.h"

namespace obliq {

int wedge_count(int azimuth_bins) { return (azimuth_bins + kWedgeAzimuthBins - 1) / kWedgeAzimuthBins; }

void copy_azimuths(const BinBlock& from, BinBlock& to) {
  const int first = std::max(from.first_azimuth, to.first_azimuth);
  const int end = std::min(from.first_azimuth + from.n_azimuth, to.first_azimuth + to.n_azimuth);
  if (first >= end || from.n_range != to.n_range) return;
  const auto row = static_cast<std::ptrdiff_t>(from.n_range);
  const std::ptrdiff_t source = (first - from.first_azimuth) * row;
  const std::ptrdiff_t target = (first - to.first_azimuth) * row;
  const std::ptrdiff_t n = (end - first) * row;
  std::copy_n(from.iq.begin() + source, n, to.iq.begin() + target);
  std::copy_n(from.power_w.begin() + source, n, to.power_w.begin() + target);
  std::copy_n(from.count.begin() + source, n, to.count.begin() + target);
  std::copy_n(from.state.begin() + source, n, to.state.begin() + target);
  const auto copy_wanted = [&](const auto& some, auto& others) {
    if (some.empty()) return;
    others.resize(to.state.size());
    std::copy_n(some.begin() + source, n, others.begin() + target);
  };
  copy_wanted(from.video8, to.video8);
  copy_wanted(from.video16, to.video16);
  copy_wanted(from.labels.material, to.labels.material);
  copy_wanted(from.labels.building, to.labels.building);
  copy_wanted(from.labels.height_m, to.labels.height_m);
  copy_wanted(from.labels.returns, to.labels.returns);
  copy_wanted(from.target, to.target);
}

std::vector<float>& label_share(BinBlock& bins, int kind) {
  const auto at = std::ranges::lower_bound(bins.label_shares, kind, {}, &LabelShare::kind);
  if (at != bins.label_shares.end() && at->kind == kind) return at->share;
  return bins.label_shares.insert(at, {kind, std::vector<float>(bins.power_w.size())})->share;
}

void decide_labels(BinBlock& bins) {
  const std::size_t n = bins.power_w.size();
  ask(4 * static_cast<std::int64_t>(n));
  Labels& labels = bins.labels;
  labels.building = std::move(label_share(bins, LabelShare::kBuildings));
  labels.height_m = std::move(label_share(bins, LabelShare::kHeights));
  labels.material.assign(n, 0);
  std::vector<const LabelShare*> materials;
  for (const LabelShare& share : bins.label_shares)
    if (share.kind < LabelShare::kBuildings) materials.push_back(&share);
  ask(static_cast<std::int64_t>(materials.size() * n));
  for (std::size_t bin = 0; bin < n; ++bin) {
    if (!(bins.power_w[bin] > 0)) {
      labels.material[bin] = Labels::kNoMaterial;
      labels.height_m[bin] = std::numeric_limits<float>::quiet_NaN();
      continue;
    }
    float rest = 1, greatest = 0;  // of material 0, and of the others
    int kind = 0;
    for (const LabelShare* material : materials) {
      const float share = material->share[bin];
      rest -= share;
      if (!(share > greatest)) continue;
      greatest = share;
      kind = material->kind;
    }
    labels.material[bin] = static_cast<std::uint8_t>(rest >= greatest ? 0 : kind);
  }
  bins.label_shares = {};
}

}  // namespace obliq
