#include "server/radar/bins.h"

#include <algorithm>

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
  const auto copy_video = [&](const auto& some, auto& others) {
    if (some.empty()) return;
    others.resize(to.state.size());
    std::copy_n(some.begin() + source, n, others.begin() + target);
  };
  copy_video(from.video8, to.video8);
  copy_video(from.video16, to.video16);
}

}  // namespace obliq
