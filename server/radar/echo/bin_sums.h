#pragma once
#include <cstdint>
#include <vector>

#include "server/radar/bins.h"
#include "server/radar/echo/label_sums.h"
#include "server/radar/echo/speckle.h"
#include "server/radar/scene_plan.h"

namespace obliq {

/// One wedge's sums by bin, in double and in the order of arrival, so that the bits follow from the wedge
/// alone: power, count and voltage, and behind a beam the elevation. Owned by one task.
class BinSums {
 public:
  static constexpr std::size_t kBlock = 512;  ///< scatterers whose voltages are worked out together
  static constexpr int kAScatterer = 8;       ///< in units of ask()

  /// voltages: false: I&Q is not computed.
  BinSums(const ScenePlan& plan, const SpeckleField& speckle, bool voltages, LabelParts labels);

  /// Empties the bins for the wedge of this first azimuth bin and keeps their memory.
  void restart(int first_azimuth);

  /// Of azimuth bin `profile` of the wedge.
  static std::size_t index(int profile, int range_bin) {
    return static_cast<std::size_t>(range_bin) * kWedgeAzimuthBins + static_cast<std::size_t>(profile);
  }
  bool has_voltages() const { return voltages_; }
  /// Of the wedge's azimuth bins.
  const WedgeEdges& edges() const { return edges_; }

  /// An echo, by index(); sine_w: its power times its sine of elevation.
  void add(std::size_t at, double power_w, double sine_w) {
    cells_[at].power_w += power_w;
    cells_[at].count += 1;
    if (sines_) sines_w_[at] += sine_w;
  }
  /// An echo and its voltage.
  void add(std::size_t at, double power_w, double sine_w, double re, double im) {
    Cell& cell = cells_[at];
    cell = {cell.power_w + power_w, cell.re + re, cell.im + im, cell.count + 1};
    if (sines_) sines_w_[at] += sine_w;
  }
  /// What labels need of echoes, beside add().
  LabelSums& labels() { return labels_; }
  const LabelSums& labels() const { return labels_; }
  void add_voltage(std::size_t at, double re, double im) {
    cells_[at].re += re;
    cells_[at].im += im;
  }
  /// Voltages of scatterers (ScattererKey), kBlock of them at most. Arrays are read up to a multiple of 8.
  void add_scatterers(int n, const std::uint32_t* at, const std::uint64_t* place, const std::uint64_t* kind,
                      const double* power_w);

  /// Writes I&Q, power, count, elevation and shares of labels of all bins and the state of the sampled ones.
  void write(BinBlock& block) const;

  static std::int64_t bytes(int n_range) {
    return std::int64_t{n_range} * kWedgeAzimuthBins *
           static_cast<std::int64_t>(sizeof(Cell) + sizeof(double));
  }

 private:
  struct alignas(32) Cell {
    double power_w, re, im, count;
  };

  const ScenePlan& plan_;
  const SpeckleField& speckle_;
  const bool voltages_;
  const bool sines_;
  WedgeEdges edges_;
  std::vector<Cell> cells_;      // [n_range][8]
  std::vector<double> sines_w_;  // [n_range][8] sines of elevation by power; empty: not wanted
  LabelSums labels_;
};

}  // namespace obliq
