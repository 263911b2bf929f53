#pragma once
// Rows of sharp bins as a radar that looks at Doppler adds them up.
#include <cstdint>
#include <vector>

#include "server/radar/beam/sea_part.h"
#include "server/radar/beam/sharp_wedge.h"
#include "server/radar/simd/receiver/row_doppler.h"

namespace obliq {

/// Of a row's power, what moves in the wind (DopplerPlan::windy, not empty).
void moving_power(const DopplerPlan& doppler, const SharpWedge& wedge, int azimuth,
                  std::vector<float>& moving);

/// Makes of rows what the sums need of them beside their power: where their echoes stand in Doppler, I&Q
/// drawn from their power, a canceller's output where that is a matter of the row alone. Keeps the rows that
/// neighbouring output wedges share. Holds its buffers; one thread at a time.
class DopplerRows {
 public:
  explicit DopplerRows(const EchoPlan& plan);

  enum class Voltages {
    none,
    own,   ///< the wedges' I&Q
    look,  ///< their look
    drawn  ///< a draw about the power
  };
  /// Rows from a first one on (RowWindow::first_row), rows[k] each in its wedge.
  void take(const std::vector<const SharpWedge*>& rows, int first_row, Voltages voltages, std::uint64_t key);

  // Of row k of those taken; behind its own canceller where plan.doppler->is_of_rows().
  const float* power(std::size_t k) const { return rows_[k]->power; }
  const float* iq(std::size_t k) const { return rows_[k]->iq; }
  /// Else, of all taken, apart.
  const float* const* re() const { return re_.data(); }
  const float* const* im() const { return im_.data(); }
  /// Of all taken, and of dark rows behind them (RowPlaces); [row][output] Doppler on the level less that of
  /// an output placed.
  struct Places {
    std::vector<const float*> firsts, seconds;
    std::vector<const CellSpan*> spans;
    std::vector<float> away_hz;
  };
  const Places& places() const { return places_; }
  /// Of their power, what moves in the wind; null: nothing does.
  const float* const* moving() const { return moving_.empty() ? nullptr : moving_.data(); }
  /// Of the power that a label has in row k (LabelShare::kind), what moves in the wind; null: nothing. Until
  /// the next call for k.
  const float* moving_of(std::size_t k, int kind, const float* power);
  /// That power, in what is the sea's and what is not; null: nothing is. Until the next call for k.
  struct LabelPowers {
    const float* rest;
    const float* sea;
  };
  LabelPowers powers_of(std::size_t k, int kind, const float* power);
  /// Both together behind the row's own canceller (is_of_rows()); until the next call for k. moving: of the
  /// rest.
  const float* filtered(std::size_t k, const LabelPowers& of, const float* moving);
  /// The sea in all taken, where plan.doppler->has_sea() and rows are not filtered by themselves: power,
  /// re and im are of the rest.
  struct Sea {
    std::vector<const float*> power, re, im;
    Places places;
  };
  const Sea& sea() const { return sea_; }
  const MovingEchoes& sea_echoes() const { return sea_echoes_; }

  /// The same of output azimuths over level ground, kWedgeAzimuthBins from the first on; after take().
  void place_outputs(int first_azimuth);
  const MovingEchoes& moving_echoes() const { return moving_echoes_; }
  const float* output_first(int output) const {
    return outputs_[static_cast<std::size_t>(output)].first.data();
  }
  const float* output_second(int output) const {
    return outputs_[static_cast<std::size_t>(output)].second.data();
  }

 private:
  struct Row {
    int azimuth = -1;
    Voltages voltages = Voltages::none;
    std::uint64_t key = 0;
    const float* power = nullptr;
    const float* iq = nullptr;
    RowPlaces places;
    std::vector<float> own_power, own_iq, re, im, other_power, moving, other_moving, rest_power, sea_power;
    const float* whole = nullptr;  // its power before the canceller
    SeaPart sea;
  };
  std::size_t place_of(int row) const;
  double level_hz(double azimuth_rad) const;
  void add_places(const RowPlaces& of_row, Places& all) const;
  void make(Row& row, const SharpWedge& wedge, Voltages voltages, std::uint64_t key);
  /// Echoes of a row, of which `moving` has the power of what moves by itself, as `echoes` says
  /// (CancelledRow).
  struct Echoes {
    const float *sin, *power, *moving;
    const MovingEchoes& echoes;
    const float* iq;
  };
  void cancel(const Echoes& of, float* out_power, float* out_iq) const;

  const EchoPlan& plan_;
  const std::size_t stride_;
  const MovingEchoes moving_echoes_, sea_echoes_;
  std::vector<Row> kept_;   // by their number, on and on
  std::vector<Row*> rows_;  // those taken
  std::vector<const float*> moving_, re_, im_;
  Places places_;
  Sea sea_;
  std::vector<RowPlaces> outputs_;
  std::vector<float> zeros_;    // a row without ground
  std::vector<CellSpan> dark_;  // it too
};

}  // namespace obliq
