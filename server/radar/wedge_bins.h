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

  /// Empties the bins for another wedge and keeps their memory.
  void restart(AzimuthRange range);

  /// Scatters and bins samples; returns how many fell into the range swath.
  std::uint64_t add(const SampleBatch& samples);

  /// Writes I&Q, power and count of all bins and the state of the sampled ones. Nothing is added after it,
  /// but for a restart.
  void write(BinBlock& block);

 private:
  /// Power that one scatterer gave to one bin: P_bc.
  struct Group {
    Scatterer scatterer;
    std::uint32_t bin;
    std::uint32_t previous;  // number + 1 of the bin's group before this one, 0 none
    double power_w;
  };

  void add_to_group(const Scatterer& scatterer, std::uint32_t bin, double power_w);
  std::size_t slot_of(const Scatterer& scatterer, std::uint32_t bin) const;
  void enter(std::uint32_t group);
  void grow_table();

  /// The groups of a bin, linked from the last one back.
  struct Chain {
    std::uint32_t last = 0;  // number + 1, 0 none
    std::uint32_t length = 0;
  };
  static constexpr std::uint32_t kLongChain = 16;

  const FramePlan& plan_;
  const ScatteringTable& scattering_;
  const SpeckleField& speckle_;
  AzimuthRange range_;
  Surfaces surfaces_;
  double range_constant_;  // K = P_t G^2 lambda^2 / (4 pi)^3 without the gain
  std::vector<double> power_w_;
  std::vector<std::uint32_t> count_;
  std::vector<std::complex<double>> voltage_;
  std::vector<Group> groups_;         // ground speckle only, in order of first appearance
  std::vector<Chain> chains_;         // per bin
  std::vector<std::uint32_t> table_;  // open addressing, bins with long chains: group number + 1, 0 empty
  std::size_t entered_ = 0;           // groups in the table
};

}  // namespace obliq
