#include "server/radar/echo/bin_sums.h"

#include "terrain/base/asking.h"

namespace obliq {

BinSums::BinSums(const ScenePlan& plan, const SpeckleField& speckle, bool voltages, LabelParts labels)
    : plan_(plan),
      speckle_(speckle),
      voltages_(voltages),
      sines_(plan.antenna_gain().keeps_elevation()),
      labels_(labels) {}

void BinSums::restart(int first_azimuth) {
  edges_ = plan_.wedge_edges(first_azimuth);
  const std::size_t n = index(0, plan_.bins().n_range);
  fill(cells_, n, {0, 0, 0, 0});
  if (sines_) fill(sines_w_, n, 0);
  labels_.restart(n);
}

void BinSums::add_scatterers(int n, const std::uint32_t* at, const std::uint64_t* place,
                             const std::uint64_t* kind, const double* power_w) {
  double re[kBlock];
  double im[kBlock];
  ask(kAScatterer * n);
  speckle_.respond({n, place, kind, power_w, re, im, at, &edges_});
  for (int k = 0; k < n; ++k) add_voltage(at[k], re[k], im[k]);
}

void BinSums::write(BinBlock& block) const {
  if (sines_) fill(block.sin_elevation, block.power_w.size(), 0);
  std::size_t bin = 0;
  for (int a = 0; a < block.n_azimuth; ++a) {
    ask(2 * block.n_range);
    for (int r = 0; r < block.n_range; ++r, ++bin) {
      const Cell& cell = cells_[index(a, r)];
      if (voltages_) block.iq[bin] = std::complex<float>(std::complex<double>(cell.re, cell.im));
      block.power_w[bin] = cell.power_w;
      if (sines_ && cell.power_w > 0)
        block.sin_elevation[bin] = static_cast<float>(sines_w_[index(a, r)] / cell.power_w);
      block.count[bin] = static_cast<std::uint32_t>(cell.count);
      if (cell.count > 0) block.state[bin] = static_cast<std::uint8_t>(BinState::sampled);
    }
  }
  labels_.write(block, index);
}

}  // namespace obliq
