#pragma once
#include <algorithm>
#include <initializer_list>
#include <optional>
#include <vector>

#include "server/radar/beam/doppler_rows.h"
#include "server/radar/beam/sharp_wedge.h"

namespace obliq {

/// Makes a wedge's bins from rows of sharp ones: the beam's sum over azimuths, the draw of speckle where it
/// is independent, the pulse's sum over ranges, the radar's power. Every bin is a fixed sum in a fixed order:
/// the same bits from any thread and with any instruction set. Holds its buffers; one thread at a time.
class EchoSums {
 public:
  static constexpr std::size_t kSpare = 64;  ///< bins that a kernel may read or write beyond a row

  explicit EchoSums(const EchoPlan& plan);

  /// rows: of sharp azimuth plan.first_row(bins.first_azimuth) and the following, as many as
  /// plan.rows_of() says.
  /// draw: names the frame, for independent speckle. iq: whether I&Q is wanted; look: BinBlock's.
  void sum(const std::vector<const SharpWedge*>& rows, std::uint64_t draw, bool iq, bool look,
           BinBlock& bins);
  /// After sum(): labels, by the same sums over each of their powers.
  void sum_labels(const std::vector<const SharpWedge*>& rows, BinBlock& bins);

 private:
  static constexpr int kIq = 0, kPower = 1;
  static constexpr int kProducts = 32;  // that a kernel adds up in a unit of ask()
  using Rows = std::vector<const float*>;
  /// Rows of one kind, I&Q or power.
  struct Kind {
    int kind;
    const Rows* rows;
  };
  void take_kernels(const std::vector<const SharpWedge*>& rows, int first_row);
  void sum_azimuths(std::initializer_list<Kind> kinds, const BinBlock& bins);
  void sum_shared(std::initializer_list<Kind> kinds, std::size_t tile, int n_azimuth);
  void sum_doppler(std::initializer_list<Kind> kinds, std::size_t tile);
  /// Of rows, from the first that weighs on: half turns between two pulses; of their power what moves, null:
  /// nothing, and how.
  struct CancelledRows {
    const float* const* sin;
    const float* const* cos;
    const float* const* moving;
    MovingEchoes echoes;
  };
  void cancel_rows(const WeighedRows& rows, const CancelledRows& of);
  void take_doppler(const std::vector<const SharpWedge*>& rows, int first_row, DopplerRows::Voltages voltages,
                    std::uint64_t draw);
  /// Of the current rows: `begin` is the first output's first, n from `first` on weigh.
  struct RowSpan {
    int begin, first, n;
  };
  RowSpan weighing(std::size_t tile, int output, int n_outputs) const;
  float* out_row(int kind, int output);
  int kernel_of(std::size_t row, std::size_t tile) const {
    return std::min(row_kernels_[row][tile], plan_.steepest[tile]);
  }
  void draw_row(std::uint64_t draw, int azimuth, std::size_t lane);
  void sum_ranges(int kind, std::size_t lane);
  void sum_looks(const std::vector<const SharpWedge*>& rows, BinBlock& bins);
  void write(BinBlock& bins, std::size_t row, bool iq) const;
  void write_share(const BinBlock& bins, int output, float* share) const;
  void write_voltages(std::complex<float>* row) const;
  void write_ground(const std::vector<const SharpWedge*>& rows, BinBlock& bins) const;

  const EchoPlan& plan_;
  std::size_t stride_;
  std::size_t pad_;                               // bins before a row, zeros
  std::vector<float> zeros_;                      // a row without ground
  Rows zero_rows_;                                // of those
  std::vector<std::uint8_t> level_;               // [tiles] its kernels
  std::vector<const std::uint8_t*> row_kernels_;  // of the current rows, [tiles] each
  std::vector<std::int32_t> taps_at_;             // of their weights in one tile
  std::vector<std::vector<float>> rows_[2];       // of iq and of power: [outputs][pad + stride + pad] bins
  std::vector<float> ranges_[2];                  // a row, summed over ranges
  std::vector<std::complex<float>> phase_;        // [n_range] with speckle "none"
  std::vector<double> range2_m2_;                 // [n_range] of range normalisation; else empty
  std::optional<DopplerRows> doppler_;            // of modes other than map
  // Of the power that is summed: what moves in the wind, and what is the sea's; null: nothing.
  const float* const* moving_rows_ = nullptr;
  const Rows* sea_rows_ = nullptr;
};

}  // namespace obliq
