#pragma once
#include <complex>
#include <cstdint>
#include <vector>

#include "server/radar/bins.h"
#include "server/radar/echo/scatterer_sums.h"
#include "server/radar/echo/scattering.h"
#include "server/radar/echo/speckle.h"
#include "server/radar/samples.h"
#include "server/radar/scene_plan.h"

namespace obliq {

/// One wedge's accumulators, in double. Owned by one task; sums run in the order samples arrive, so the bits
/// follow from the wedge alone.
class EchoBins {
 public:
  EchoBins(const ScenePlan& plan, const ScatteringTable& scattering, const SpeckleField& speckle,
           AzimuthRange range, Surfaces surfaces = Surfaces::all);

  /// Empties the bins for another wedge and keeps their memory.
  void restart(AzimuthRange range);

  /// Scatters and bins samples; returns how many fell into the range swath.
  std::uint64_t add(const SampleBatch& samples);

  /// Writes I&Q, power and count of all bins and the state of the sampled ones. Add nothing after it before a
  /// restart.
  void write(BinBlock& block);

 private:
  void add_speckle();

  const ScenePlan& plan_;
  const ScatteringTable& scattering_;
  const SpeckleField& speckle_;
  AzimuthRange range_;
  Surfaces surfaces_;
  double range_constant_;  // K = P_t G^2 lambda^2 / (4 pi)^3 without the gain
  std::vector<double> power_w_;
  std::vector<double> sines_w_;  // sines of elevation by power; empty: not wanted
  std::vector<std::uint32_t> count_;
  std::vector<std::complex<double>> voltage_;
  ScattererSums::Scratch scratch_;
  std::vector<ScattererSums> sums_;  // [range.count], ground speckle only
  SwathCells cells_;
  EchoFactors factors_;
  BinnedSamples placed_;
};

}  // namespace obliq
