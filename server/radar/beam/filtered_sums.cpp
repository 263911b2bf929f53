// Sums over rows behind a filter of Doppler: each bin of each row has a weight of its own.
#include <algorithm>

#include "server/radar/beam/echo_sums.h"
#include "server/radar/simd/kernels.h"
#include "terrain/base/asking.h"

namespace obliq {
namespace {

/// What several sums leave in a tile of the outputs.
class TileSums {
 public:
  void add(const WeighedRows& rows) {
    for (int o = 0; o < WeighedRows::kOutputs; ++o) {
      for (int m = 0; m < rows.n; ++m) power_[o][m] += rows.out_power[o][rows.first + m];
      for (int m = 0; rows.re != nullptr && m < 2 * rows.n; ++m)
        iq_[o][m] += rows.out_iq[o][2 * rows.first + m];
    }
  }
  /// Voltages a quarter turn ahead.
  void add_ahead(const WeighedRows& rows) {
    for (int o = 0; o < WeighedRows::kOutputs; ++o) {
      for (int m = 0; m < rows.n; ++m) power_[o][m] += rows.out_power[o][rows.first + m];
      for (int m = 0; rows.re != nullptr && m < rows.n; ++m) {
        const float* const iq = rows.out_iq[o] + 2 * (rows.first + m);
        iq_[o][2 * m] -= iq[1];
        iq_[o][2 * m + 1] += iq[0];
      }
    }
  }
  void give(const WeighedRows& rows) const {
    for (int o = 0; o < WeighedRows::kOutputs; ++o) {
      std::copy_n(power_[o], rows.n, rows.out_power[o] + rows.first);
      if (rows.re != nullptr) std::copy_n(iq_[o], 2 * rows.n, rows.out_iq[o] + 2 * rows.first);
    }
  }

 private:
  float power_[WeighedRows::kOutputs][EchoPlan::kTile]{};
  float iq_[WeighedRows::kOutputs][2 * EchoPlan::kTile]{};
};

}  // namespace

void EchoSums::sum_doppler(std::initializer_list<Kind> kinds, std::size_t tile) {
  static_assert(WeighedRows::kOutputs == kWedgeAzimuthBins);
  constexpr int kWeights = 16;  // work of one, in products
  const RowSpan span = weighing(tile, 0, kWedgeAzimuthBins);
  const auto first = static_cast<std::size_t>(span.first);
  WeighedRows rows{zero_rows_.data(),
                   nullptr,
                   nullptr,
                   span.n,
                   plan_.azimuth_parts,
                   taps_at_.data() + first,
                   span.begin,
                   static_cast<int>(tile) * EchoPlan::kTile,
                   EchoPlan::kTile,
                   {},
                   {}};
  for (int o = 0; o < WeighedRows::kOutputs; ++o) {
    rows.out_power[o] = out_row(kPower, o);
    rows.out_iq[o] = out_row(kIq, o);
  }
  for (const auto& [kind, of_kind] : kinds) {
    if (kind == kPower) rows.power = of_kind->data() + first;
    if (kind == kIq) rows.re = doppler_->re() + first;
    if (kind == kIq) rows.im = doppler_->im() + first;
  }
  const std::int64_t work =
      std::int64_t{span.n} * WeighedRows::kOutputs * EchoPlan::kTile * kWeights / kProducts;  // of a sum
  const DopplerPlan& doppler = *plan_.doppler;
  const float* const* const moving = moving_rows_ == nullptr ? nullptr : moving_rows_ + first;
  const AzimuthKernels& kernels = plan_.kernels;
  const DopplerRows::Places& places = doppler_->places();
  const auto sharpen = [&](const DopplerRows::Places& of, const DopplerResponse& response) {
    ask(work);
    SharpenedSum sum{rows,
                     kernels.voltage.data(),
                     of.firsts.data() + first,
                     of.spans.data() + first,
                     of.away_hz.data() + WeighedRows::kOutputs * first,
                     doppler.level_cells_a_hz().data(),
                     doppler.level_spans().data(),
                     response.table()};
    active_kernels().sharpened_sum(sum);
  };
  const auto cancel = [&](const DopplerRows::Places& of, const float* const* parts,
                          const MovingEchoes& echoes) {
    ask(work);
    cancel_rows(rows, {of.firsts.data() + first, of.seconds.data() + first, parts, echoes});
  };
  if (doppler.is_canceller())
    cancel(places, moving, doppler_->moving_echoes());
  else
    sharpen(places, doppler.response());
  if (sea_rows_ == nullptr) return;
  // The sea's sums beside those of the rest.
  TileSums sums;
  sums.add(rows);
  const DopplerRows::Sea& sea = doppler_->sea();
  rows.power = sea_rows_->data() + first;
  if (rows.re != nullptr) rows.re = sea.re.data() + first;
  if (rows.im != nullptr) rows.im = sea.im.data() + first;
  if (doppler.is_canceller()) {
    cancel(sea.places, rows.power, doppler_->sea_echoes());
    sums.add(rows);
  } else {
    sharpen(sea.places, doppler.sea_response(tile).in_phase());
    sums.add(rows);
    sharpen(sea.places, doppler.sea_response(tile).ahead());
    sums.add_ahead(rows);
  }
  sums.give(rows);
}

/// Rows behind a canceller whose weights are not a matter of the row alone.
void EchoSums::cancel_rows(const WeighedRows& rows, const CancelledRows& of) {
  const DopplerPlan& doppler = *plan_.doppler;
  const AzimuthKernels& kernels = plan_.kernels;
  const auto lock = [&](auto& sum) {
    for (int o = 0; doppler.has_lock() && o < WeighedRows::kOutputs; ++o) {
      sum.output_sin[o] = doppler_->output_first(o);
      sum.output_cos[o] = doppler_->output_second(o);
    }
  };
  if (kernels.cancelled.empty()) {
    LockedSum sum{rows,
                  kernels.voltage.data(),
                  of.sin,
                  of.cos,
                  {},
                  {},
                  doppler.delays(),
                  static_cast<float>(doppler.over_noise_root()),
                  of.moving,
                  kernels.power.data(),
                  of.echoes};
    lock(sum);
    active_kernels().locked_sum(sum);
  } else {
    CancelledSum sum{rows,      kernels.cancelled.data(), of.sin,   of.cos, {}, {}, doppler.delays(),
                     of.moving, kernels.power.data(),     of.echoes};
    lock(sum);
    active_kernels().cancelled_sum(sum);
  }
}

}  // namespace obliq
