#include "server/radar/beam/sharp_wedge.h"

#include <algorithm>
#include <utility>

#include "server/radar/simd/kernels.h"
#include "terrain/base/asking.h"

namespace obliq {

std::size_t sharp_stride(const EchoPlan& plan) { return plan.steepest.size() * EchoPlan::kTile; }

SharpWedge::SharpWedge(const EchoPlan& plan, BinBlock&& bins, const FrameStats& of_bins,
                       const SharpPlanes& planes, std::uint64_t look_key)
    : first_azimuth(bins.first_azimuth),
      n_azimuth(bins.n_azimuth),
      n_range(bins.n_range),
      stride(sharp_stride(plan)),
      count(std::move(bins.count)),
      state(std::move(bins.state)),
      stats(of_bins) {
  fill(power, static_cast<std::size_t>(n_azimuth) * stride, 0);
  if (planes.iq) fill(iq, 2 * power.size(), 0);
  for (std::size_t a = 0; a < static_cast<std::size_t>(n_azimuth); ++a) {
    ask(n_range);
    for (std::size_t r = 0; r < static_cast<std::size_t>(n_range); ++r) {
      const std::size_t from = a * static_cast<std::size_t>(n_range) + r;
      const std::size_t to = a * stride + r;
      const float amplitude = plan.amplitude.empty() ? 1.0F : plan.amplitude[r];
      power[to] = static_cast<float>(bins.power_w[from]) * (amplitude * amplitude);
      if (!planes.iq) continue;
      iq[2 * to] = bins.iq[from].real() * amplitude;
      iq[2 * to + 1] = bins.iq[from].imag() * amplitude;
    }
  }
  choose_kernels(bins);
  if (planes.labels) take_labels(bins);
  if (planes.look) draw_look(plan, look_key);
}

void SharpWedge::choose_kernels(const BinBlock& bins) {
  fill(kernels, power.size() / EchoPlan::kTile, 0);
  if (bins.sin_elevation.empty()) return;
  for (std::size_t a = 0; a < static_cast<std::size_t>(n_azimuth); ++a) {
    ask(n_range);
    const std::size_t own = a * static_cast<std::size_t>(n_range);
    for (int first = 0; first < n_range; first += EchoPlan::kTile) {
      double power_w = 0;
      double sines_w = 0;
      for (int r = first; r < std::min(first + EchoPlan::kTile, n_range); ++r) {
        const std::size_t bin = own + static_cast<std::size_t>(r);
        power_w += bins.power_w[bin];
        sines_w += bins.power_w[bin] * static_cast<double>(bins.sin_elevation[bin]);
      }
      if (power_w > 0)
        kernels[(a * stride + static_cast<std::size_t>(first)) / EchoPlan::kTile] =
            static_cast<std::uint8_t>(cosine_steps::nearest(sines_w / power_w));
    }
  }
}

void SharpWedge::take_labels(BinBlock& bins) {
  returns = std::move(bins.labels.returns);
  if (returns.empty()) fill(returns, state.size(), 0);  // of a halo, where nobody asks
  for (const LabelShare& share : bins.label_shares) {
    std::vector<float>& row = label_powers.emplace_back(LabelShare{share.kind, power}).share;
    for (std::size_t a = 0; a < static_cast<std::size_t>(n_azimuth); ++a) {
      ask(n_range);
      const float* const of_bins = share.share.data() + a * static_cast<std::size_t>(n_range);
      for (std::size_t r = 0; r < static_cast<std::size_t>(n_range); ++r) row[a * stride + r] *= of_bins[r];
    }
  }
}

/// A draw belongs to a place in the output frame: how far beyond it the sharp one reaches does not matter.
void SharpWedge::draw_look(const EchoPlan& plan, std::uint64_t key) {
  constexpr std::uint64_t kBeside = std::uint64_t{1} << 30;  // more bins than a halo has
  fill(look, 2 * power.size(), 0);
  for (int a = first_azimuth; a < first_azimuth + n_azimuth; ++a) {
    ask(2 * static_cast<std::int64_t>(stride));
    const std::uint64_t azimuth =
        kBeside + static_cast<std::uint64_t>(a) - static_cast<std::uint64_t>(plan.first_azimuth);
    const std::uint64_t range = kBeside - static_cast<std::uint64_t>(plan.first_range);
    active_kernels().draw_speckle(
        {key, (azimuth << 32) + range, static_cast<int>(stride), power_row(a), look.data() + 2 * row(a)});
  }
}

std::size_t SharpWedge::bytes() const {
  return (iq.size() + look.size() + power.size()) * sizeof(float) + count.size() * sizeof(std::uint32_t) +
         state.size() + kernels.size() + returns.size() + label_powers.size() * power.size() * sizeof(float);
}

}  // namespace obliq
