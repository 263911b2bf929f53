#include "server/radar/narrow_bins.h"

#include <algorithm>
#include <cmath>

#include "terrain/base/asking.h"

namespace obliq {
namespace {

/// In wider bins one plane does not represent the ground beneath the buildings.
constexpr double kWidest_deg = 0.5;

int parts_of(int whole, int parts) { return (whole + parts - 1) / parts; }

}  // namespace

int narrow_bins(const RadarSettings& s) {
  if (s.frustum != FrustumKind::sweep || s.sub_columns == 0) return 1;
  // A whole number of them is not one more for a last bit.
  const double bins = s.sector_deg / s.azimuth_bins / kWidest_deg * (1 - 1e-9);
  return std::max(1, static_cast<int>(std::ceil(bins)));
}

RadarSettings narrow_frame(RadarSettings s) {
  const int n = narrow_bins(s);
  if (n == 1) return s;
  const int planes = parts_of(parts_of(s.pixel_columns, s.azimuth_bins), n);
  s.azimuth_bins *= n;
  s.pixel_columns = planes * s.azimuth_bins;
  return s;
}

void add_narrow(const BinBlock& narrow, int n, BinBlock& bins) {
  const auto n_range = static_cast<std::size_t>(bins.n_range);
  if (!narrow.sin_elevation.empty()) bins.sin_elevation.resize(bins.power_w.size());
  bins.labels.returns.resize(narrow.labels.returns.empty() ? 0 : bins.power_w.size());
  std::vector<const float*> of_narrow;
  for (const LabelShare& share : narrow.label_shares) label_share(bins, share.kind);
  for (const LabelShare& share : bins.label_shares) {
    const auto same = std::ranges::find(narrow.label_shares, share.kind, &LabelShare::kind);
    of_narrow.push_back(same == narrow.label_shares.end() ? nullptr : same->share.data());
  }
  for (int a = 0; a < narrow.n_azimuth; ++a) {
    ask(bins.n_range);
    const int azimuth = narrow.first_azimuth + a;
    const bool first = azimuth % n == 0;
    std::size_t from = static_cast<std::size_t>(a) * n_range;
    std::size_t to = static_cast<std::size_t>(azimuth / n - bins.first_azimuth) * n_range;
    for (const std::size_t end = from + n_range; from < end; ++from, ++to) {
      bins.iq[to] += narrow.iq[from];
      bins.power_w[to] += narrow.power_w[from];
      bins.count[to] += narrow.count[from];
      bins.state[to] = first ? narrow.state[from] : joined(bins.state[to], narrow.state[from]);
      if (!narrow.labels.returns.empty())
        bins.labels.returns[to] = std::max(bins.labels.returns[to], narrow.labels.returns[from]);
      if (!(narrow.power_w[from] > 0)) continue;
      const auto part = static_cast<float>(narrow.power_w[from] / bins.power_w[to]);
      const auto join = [&](float& mean, float more) { mean += (more - mean) * part; };
      if (!bins.sin_elevation.empty()) join(bins.sin_elevation[to], narrow.sin_elevation[from]);
      for (std::size_t k = 0; k < of_narrow.size(); ++k)
        join(bins.label_shares[k].share[to], of_narrow[k] == nullptr ? 0 : of_narrow[k][from]);
    }
  }
}

}  // namespace obliq
