#include "server/radar/beam/sharp_wedge.h"

#include <utility>

namespace obliq {

std::size_t sharp_stride(const EchoPlan& plan) { return plan.tiles.size() * EchoPlan::kTile; }

SharpWedge::SharpWedge(const EchoPlan& plan, BinBlock&& bins, const FrameStats& of_bins, bool with_iq)
    : first_azimuth(bins.first_azimuth),
      n_azimuth(bins.n_azimuth),
      n_range(bins.n_range),
      stride(sharp_stride(plan)),
      count(std::move(bins.count)),
      state(std::move(bins.state)),
      stats(of_bins) {
  power.assign(static_cast<std::size_t>(n_azimuth) * stride, 0);
  if (with_iq) iq.assign(2 * power.size(), 0);
  for (std::size_t a = 0; a < static_cast<std::size_t>(n_azimuth); ++a) {
    for (std::size_t r = 0; r < static_cast<std::size_t>(n_range); ++r) {
      const std::size_t from = a * static_cast<std::size_t>(n_range) + r;
      const std::size_t to = a * stride + r;
      const float amplitude = plan.amplitude.empty() ? 1.0F : plan.amplitude[r];
      power[to] = static_cast<float>(bins.power_w[from]) * (amplitude * amplitude);
      if (!with_iq) continue;
      iq[2 * to] = bins.iq[from].real() * amplitude;
      iq[2 * to + 1] = bins.iq[from].imag() * amplitude;
    }
  }
}

std::size_t SharpWedge::bytes() const {
  return (iq.size() + power.size()) * sizeof(float) + count.size() * sizeof(std::uint32_t) + state.size();
}

}  // namespace obliq
