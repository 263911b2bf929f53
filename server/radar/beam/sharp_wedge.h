#pragma once
#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include "server/radar/beam/echo_plan.h"
#include "server/radar/bins.h"

namespace obliq {

/// What wedges that are kept hold beside power and count.
struct SharpPlanes {
  bool iq = false;
  bool look = false;  ///< of video of several looks (BinBlock::look)
  bool states = false;
  LabelParts labels = LabelParts::none;
  bool hold(const SharpPlanes& wanted) const {
    return iq >= wanted.iq && look >= wanted.look && states >= wanted.states && labels >= wanted.labels;
  }
};

/// A wedge of the sharp frame as the sums over it read it: rows of floats, of 1 W and 0 dBi, with zeros
/// behind them up to whole tiles. Immutable once made. Of an antenna that is not stabilised there are two
/// kinds: of the ground's azimuths, and, made from those, of scan angles (turned_wedge.h).
struct SharpWedge {
  int first_azimuth = 0;
  int n_azimuth = 0;
  int n_range = 0;
  std::size_t stride = 0;    ///< bins a row, a multiple of EchoPlan::kTile
  std::vector<float> iq;     ///< [n_azimuth][stride][2]; empty: not wanted
  std::vector<float> look;   ///< as iq: drawn bin by bin about the mean power
  std::vector<float> power;  ///< [n_azimuth][stride]
  /// [n_azimuth][tiles] the azimuth weights (AzimuthKernels) of a row in a tile: those of the mean sine of
  /// elevation of what it sees there, weighed by power; 0 without a beam, or where it sees nothing.
  std::vector<std::uint8_t> kernels;
  /// Rows as `power` has them: mean sines of elevation by power, about the antenna's own vertical; empty:
  /// nothing looks at Doppler.
  std::vector<float> mean_sine;
  std::vector<std::uint32_t> count;
  std::vector<std::uint8_t> state;
  std::vector<LabelShare> label_powers;  ///< rows as `power` has them: shares of it. Empty: not wanted
  std::vector<std::uint8_t> returns;     ///< of labels, as count
  /// Rows as `power` has them, of the ground's azimuths alone: the sharp bin of scan angles at whose middle
  /// the antenna sees what is there, a fraction, and the sine of elevation about the antenna's own vertical.
  std::vector<float> seen_at, own_sine;
  FrameStats stats;

  /// look_key: what the look's draws follow from.
  SharpWedge(const EchoPlan& plan, BinBlock&& bins, const FrameStats& of_bins, const SharpPlanes& planes,
             std::uint64_t look_key = 0);
  /// Of scan angles, dark.
  SharpWedge(const EchoPlan& plan, AzimuthRange azimuths, const SharpPlanes& planes);

  const float* power_row(int azimuth) const { return power.data() + row_at(azimuth); }
  const float* iq_row(int azimuth) const { return iq.data() + 2 * row_at(azimuth); }
  const float* sine_row(int azimuth) const { return mean_sine.data() + row_at(azimuth); }
  const std::uint8_t* kernels_of(int azimuth) const {
    return kernels.data() + row_at(azimuth) / EchoPlan::kTile;
  }
  const float* look_row(int azimuth) const { return look.data() + 2 * row_at(azimuth); }
  /// Null: all 0.
  const float* label_row(int azimuth, int kind) const {
    const auto at = std::ranges::find(label_powers, kind, &LabelShare::kind);
    return at == label_powers.end() ? nullptr : at->share.data() + row_at(azimuth);
  }
  /// The same to be written; made where there is none.
  std::vector<float>& label_row_of(int kind);
  /// Of power, a row's first bin.
  std::size_t row_at(int azimuth) const { return static_cast<std::size_t>(azimuth - first_azimuth) * stride; }
  /// Of `power`, so far as that goes.
  void draw_look(const EchoPlan& plan, std::uint64_t key);
  std::size_t bytes() const;

 private:
  void choose_kernels(const BinBlock& bins);
  void take_sines(const BinBlock& bins);
  void take_labels(BinBlock& bins);
  void see(const GroundAzimuths& ground, const BinBlock& bins);
};
using SharpWedgePtr = std::shared_ptr<const SharpWedge>;

/// A number of a row's first bin, of which those behind it count up: the same of a sharp bin in a frame and
/// in its dwells.
std::uint64_t first_of_sharp_row(const EchoPlan& plan, int azimuth);

/// I&Q of a row of sharp bins about its mean power, which belong to its place in the output frame: how far
/// beyond that the sharp one reaches does not matter.
void draw_sharp_row(const EchoPlan& plan, int azimuth, std::uint64_t key, const float* power, float* iq);

/// Bins of a row of sharp ones, with what is behind them.
std::size_t sharp_stride(const EchoPlan& plan);

}  // namespace obliq
