// Sums over rows behind a filter of Doppler: each bin of each row has a weight of its own.
#include <algorithm>

#include "server/radar/beam/echo_sums.h"
#include "server/radar/simd/kernels.h"
#include "terrain/base/asking.h"

namespace obliq {

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
  ask(std::int64_t{span.n} * WeighedRows::kOutputs * EchoPlan::kTile * kWeights / kProducts);
  const DopplerPlan& doppler = *plan_.doppler;
  const float* const* const moving = moving_rows_ == nullptr ? nullptr : moving_rows_ + first;
  const AzimuthKernels& kernels = plan_.kernels;
  if (!doppler.is_canceller()) {
    SharpenedSum sum{rows,
                     kernels.voltage.data(),
                     doppler_->firsts() + first,
                     doppler_->spans() + first,
                     doppler_->away_hz() + WeighedRows::kOutputs * first,
                     doppler.level_cells_a_hz().data(),
                     doppler.level_spans().data(),
                     doppler.response().table()};
    active_kernels().sharpened_sum(sum);
    return;
  }
  cancel_rows(rows,
              {doppler_->firsts() + first, doppler_->seconds() + first, moving, doppler_->moving_echoes()});
  if (sea_rows_ == nullptr) return;
  // The sea's sums beside those of the rest.
  const auto n = static_cast<std::size_t>(rows.n);
  const bool iq = rows.re != nullptr;
  float rest_power[WeighedRows::kOutputs][EchoPlan::kTile];
  float rest_iq[WeighedRows::kOutputs][2 * EchoPlan::kTile];
  for (int o = 0; o < WeighedRows::kOutputs; ++o) {
    std::copy_n(rows.out_power[o] + rows.first, n, rest_power[o]);
    if (iq) std::copy_n(rows.out_iq[o] + 2 * rows.first, 2 * n, rest_iq[o]);
  }
  const DopplerRows::Sea& sea = doppler_->sea();
  rows.power = sea_rows_->data() + first;
  if (iq) rows.re = sea.re.data() + first;
  if (iq) rows.im = sea.im.data() + first;
  cancel_rows(rows, {sea.sin.data() + first, sea.cos.data() + first, rows.power, doppler_->sea_echoes()});
  for (int o = 0; o < WeighedRows::kOutputs; ++o) {
    for (std::size_t m = 0; m < n; ++m)
      rows.out_power[o][rows.first + static_cast<int>(m)] += rest_power[o][m];
    for (std::size_t m = 0; iq && m < 2 * n; ++m)
      rows.out_iq[o][2 * rows.first + static_cast<int>(m)] += rest_iq[o][m];
  }
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
