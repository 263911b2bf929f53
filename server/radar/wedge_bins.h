#pragma once
#include <complex>
#include <cstdint>
#include <vector>

#include "server/radar/batches.h"
#include "server/radar/bins.h"
#include "server/radar/frame_plan.h"
#include "server/radar/scattering.h"
#include "server/radar/speckle.h"

namespace obliq {

/// One wedge's accumulators, in double. Owned by one task; sums run in the order samples arrive, so the bits
/// follow from the wedge alone.
class WedgeBins {
 public:
  WedgeBins(const FramePlan& plan, const ScatteringTable& scattering, const SpeckleField& speckle,
            AzimuthRange range, Surfaces surfaces = Surfaces::all);

  /// Scatters and bins samples; returns how many fell into the range swath.
  std::uint64_t add(const SampleBatch& samples);

  /// Writes I&Q, power and count of all bins and the state of the sampled ones.
  void write(BinBlock& block) const;

 private:
  /// Power that one scatterer gave to one bin: P_bc.
  struct Group {
    Scatterer scatterer;
    std::uint32_t bin;
    double power_w;
  };

  /// Group numbers + 1 by open addressing, 0 empty. One for each azimuth bin: a plane of the sweep stays
  /// within one, which fits the cache.
  struct Table {
    std::vector<std::uint32_t> slots;
    std::size_t used = 0;
  };

  void add_to_group(const Scatterer& scatterer, std::uint32_t bin, double power_w);
  void grow(Table& table);
  std::uint64_t hash(const Scatterer& scatterer, std::uint32_t bin) const {
    return speckle_.hash(scatterer) + bin * 0x9e3779b97f4a7c15ull;
  }

  const FramePlan& plan_;
  const ScatteringTable& scattering_;
  const SpeckleField& speckle_;
  AzimuthRange range_;
  Surfaces surfaces_;
  double range_constant_;  // K = P_t G^2 lambda^2 / (4 pi)^3 without the gain
  std::vector<double> power_w_;
  std::vector<std::uint32_t> count_;
  std::vector<std::complex<double>> voltage_;  // geometric speckle only
  std::vector<Group> groups_;                  // ground speckle only, in order of first appearance
  std::vector<Table> tables_;                  // ground speckle only, [azimuth bins]
};

}  // namespace obliq
