#include "server/radar/beam/echo_sums.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "server/radar/simd/kernels.h"
#include "server/radar/simd/lanes/exact_math.h"
#include "terrain/base/asking.h"
#include "terrain/base/hash.h"

namespace obliq {
namespace {

constexpr int kOutputs = AzimuthSum::kOutputs;
constexpr int kLanesOut = kWedgeAzimuthBins;  // a whole number of kOutputs
constexpr int kRun = 1024;  // elements between two times that are asked, a multiple of all kernels' lanes

}  // namespace

EchoSums::EchoSums(const EchoPlan& plan) : plan_(plan), stride_(sharp_stride(plan)), zeros_(2 * stride_) {
  // A kernel may reach beyond the sharp swath where the near side had no room.
  pad_ = plan.gate_voltage.size() + kSpare;
  const auto n_rows = static_cast<std::size_t>(plan.rows_of(kLanesOut));
  level_.resize(plan.steepest.size());
  row_kernels_.resize(n_rows);
  taps_at_.resize(n_rows);
  for (const int kind : {kIq, kPower}) {
    const std::size_t floats = kind == kIq ? 2 : 1;
    rows_[kind].assign(kLanesOut, std::vector<float>(floats * (stride_ + 2 * pad_)));
    ranges_[kind].assign(floats * (stride_ + kSpare), 0);
    ask(static_cast<std::int64_t>(kLanesOut * floats * stride_ / 2));
  }
  if (plan.filter() != nullptr) doppler_.emplace(plan);
  zero_rows_.assign(n_rows, zeros_.data());
  const RadarSettings& s = plan.sharp;
  const double sharp_m = s.range_bin_m();
  for (int m = 0; m < plan.n_range && (plan.speckle == SpeckleKind::none || plan.range_normalisation); ++m) {
    const double range_m = s.r_min_m + (plan.first_range + (m + 0.5) * plan.range_parts) * sharp_m;
    const double round_trips = 2 * range_m / plan.wavelength_m;
    const SinCos at = sincos_turns(-(round_trips - std::floor(round_trips)));
    phase_.emplace_back(static_cast<float>(at.cos), static_cast<float>(at.sin));
    if (plan.range_normalisation) range2_m2_.push_back(range_m * range_m);
    if (m % kRun == 0) ask(10 * kRun);
  }
}

void EchoSums::sum(const std::vector<const SharpWedge*>& rows, std::uint64_t draw, bool iq, bool look,
                   BinBlock& bins) {
  const int first_row = plan_.first_row(bins.first_azimuth);
  const bool independent = plan_.speckle == SpeckleKind::independent;
  const bool drawn = (iq || look) && independent;
  // A draw is of the bins, or of the rows that Doppler tells apart.
  const bool coherent = (iq && !plan_.draws()) || (drawn && doppler_);
  if (look) bins.look.resize(bins.iq.size());
  Rows iq_rows(static_cast<std::size_t>(plan_.rows_of(kLanesOut)), zeros_.data());
  Rows power_rows = iq_rows;
  take_kernels(rows, first_row);
  if (doppler_) {
    using Voltages = DopplerRows::Voltages;
    const Voltages own = coherent ? Voltages::own : Voltages::none;
    take_doppler(rows, first_row, drawn ? Voltages::drawn : own, draw);
  }
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const int azimuth = plan_.sharp_azimuth(first_row + static_cast<int>(k));
    power_rows[k] = doppler_ ? doppler_->power(k) : rows[k]->power_row(azimuth);
    if (coherent) iq_rows[k] = doppler_ ? doppler_->iq(k) : rows[k]->iq_row(azimuth);
  }
  moving_rows_ = doppler_ ? doppler_->moving() : nullptr;
  sea_rows_ = doppler_ && plan_.doppler->has_sea() ? &doppler_->sea().power : nullptr;
  if (coherent) {
    sum_azimuths({{kPower, &power_rows}, {kIq, &iq_rows}}, bins);
  } else {
    sum_azimuths({{kPower, &power_rows}}, bins);
  }
  for (int o = 0; o < bins.n_azimuth; ++o) {
    const auto lane = static_cast<std::size_t>(o);
    if (drawn && !doppler_) draw_row(draw, bins.first_azimuth + o, lane);
    sum_ranges(kPower, lane);
    if (coherent || drawn) sum_ranges(kIq, lane);
    const std::size_t row = lane * static_cast<std::size_t>(plan_.n_range);
    write(bins, row, iq);
    if (look && independent) write_voltages(bins.look.data() + row);
  }
  if (look && !independent) sum_looks(rows, bins);
  if (!rows[0]->returns.empty()) bins.labels.returns.resize(bins.state.size());
  write_ground(rows, bins);
}

/// One look of speckle that is drawn in the sharp bins: beam and pulse give it the grain of the I&Q.
void EchoSums::sum_looks(const std::vector<const SharpWedge*>& rows, BinBlock& bins) {
  const int first_row = plan_.first_row(bins.first_azimuth);
  Rows look_rows(static_cast<std::size_t>(plan_.rows_of(kLanesOut)), zeros_.data());
  if (doppler_) take_doppler(rows, first_row, DopplerRows::Voltages::look, 0);
  for (std::size_t k = 0; k < rows.size(); ++k)
    look_rows[k] =
        doppler_ ? doppler_->iq(k) : rows[k]->look_row(plan_.sharp_azimuth(first_row + static_cast<int>(k)));
  sum_azimuths({{kIq, &look_rows}}, bins);
  for (int o = 0; o < bins.n_azimuth; ++o) {
    const auto lane = static_cast<std::size_t>(o);
    sum_ranges(kIq, lane);
    write_voltages(bins.look.data() + lane * static_cast<std::size_t>(plan_.n_range));
  }
}

void EchoSums::sum_labels(const std::vector<const SharpWedge*>& rows, BinBlock& bins) {
  const int first_row = plan_.first_row(bins.first_azimuth);
  std::set<int> kinds;
  for (const SharpWedge* wedge : rows)
    for (const LabelShare& label : wedge->label_powers) kinds.insert(label.kind);
  Rows power_rows(static_cast<std::size_t>(plan_.rows_of(kLanesOut)));
  Rows moving_rows(power_rows.size()), sea_rows(power_rows.size());
  if (moving_rows_ != nullptr) moving_rows_ = moving_rows.data();
  for (const int kind : kinds) {
    std::ranges::fill(power_rows, zeros_.data());
    std::ranges::fill(moving_rows, zeros_.data());
    std::ranges::fill(sea_rows, zeros_.data());
    sea_rows_ = nullptr;
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const float* row = rows[k]->label_row(plan_.sharp_azimuth(first_row + static_cast<int>(k)), kind);
      if (row == nullptr) continue;
      if (!doppler_) {
        power_rows[k] = row;
        continue;
      }
      const float* const moving = doppler_->moving_of(k, kind, row);
      const DopplerRows::LabelPowers of = doppler_->powers_of(k, kind, row);
      if (plan_.doppler->is_of_rows()) {
        power_rows[k] = doppler_->filtered(k, of, moving);
        continue;
      }
      if (of.rest != nullptr) power_rows[k] = of.rest;
      if (moving != nullptr) moving_rows[k] = moving;
      if (of.sea == nullptr) continue;
      sea_rows[k] = of.sea;
      sea_rows_ = &sea_rows;
    }
    sum_azimuths({{kPower, &power_rows}}, bins);
    float* share = label_share(bins, kind).data();
    for (int o = 0; o < bins.n_azimuth; ++o, share += plan_.n_range) {
      sum_ranges(kPower, static_cast<std::size_t>(o));
      write_share(bins, o, share);
    }
  }
  moving_rows_ = nullptr;
  sea_rows_ = nullptr;
  decide_labels(bins);
}

/// Which azimuth weights the rows have, tile by tile; those beyond the last output have no ground.
void EchoSums::take_kernels(const std::vector<const SharpWedge*>& rows, int first_row) {
  std::ranges::fill(row_kernels_, level_.data());
  for (std::size_t k = 0; k < rows.size(); ++k)
    row_kernels_[k] = rows[k]->kernels_of(plan_.sharp_azimuth(first_row + static_cast<int>(k)));
}

void EchoSums::take_doppler(const std::vector<const SharpWedge*>& rows, int first_row,
                            DopplerRows::Voltages voltages, std::uint64_t draw) {
  doppler_->take(rows, first_row, voltages,
                 mix64(draw ^ static_cast<std::uint64_t>(plan_.sharp.speckle_seed)));
}

/// Of neighbouring output bins, into rows_. Tile by tile: what a tile reads of the rows stays in the nearest
/// cache for the next outputs.
void EchoSums::sum_azimuths(std::initializer_list<Kind> kinds, const BinBlock& bins) {
  const auto place_rows = [&](std::size_t tile) {
    for (std::size_t row = 0; row < taps_at_.size(); ++row)
      taps_at_[row] =
          kernel_of(row, tile) * plan_.kernels.length + plan_.kernels.pad + static_cast<std::int32_t>(row);
    ask(static_cast<std::int64_t>(taps_at_.size()));
  };
  const std::size_t tiles = plan_.steepest.size();
  if (!doppler_ || plan_.doppler->shares_weights()) {
    for (std::size_t tile = 0; tile < tiles; ++tile) {
      place_rows(tile);
      sum_shared(kinds, tile, bins.n_azimuth);
    }
    return;
  }
  doppler_->place_outputs(bins.first_azimuth);
  for (std::size_t tile = 0; tile < tiles; ++tile) {
    place_rows(tile);
    sum_doppler(kinds, tile);
  }
}

/// Rows that weigh for any of some outputs: without those on either side that have no weight.
EchoSums::RowSpan EchoSums::weighing(std::size_t tile, int output, int n_outputs) const {
  const auto unused = [&](int row) {
    return plan_.kernels.unused[static_cast<std::size_t>(kernel_of(static_cast<std::size_t>(row), tile))];
  };
  const int begin = output * plan_.azimuth_parts;
  const int end = (output + n_outputs - 1) * plan_.azimuth_parts + plan_.n_taps;
  int first = begin;
  int last = end - 1;
  while (first < last && first - begin < unused(first)) ++first;
  while (first < last && end - 1 - last < unused(last)) --last;
  return {begin, first, last - first + 1};
}

/// All outputs have the same weights of rows, each from its own on.
void EchoSums::sum_shared(std::initializer_list<Kind> kinds, std::size_t tile, int n_azimuth) {
  const AzimuthKernels& kernels = plan_.kernels;
  for (int output = 0; output < n_azimuth; output += kOutputs) {
    const RowSpan span = weighing(tile, output, kOutputs);
    for (const auto& [kind, rows] : kinds) {
      const int floats = kind == kIq ? 2 : 1;
      AzimuthSum sum{rows->data() + span.first,
                     span.n,
                     plan_.azimuth_parts,
                     (kind == kIq ? kernels.voltage : kernels.power).data(),
                     taps_at_.data() + span.first,
                     span.begin,
                     floats * static_cast<int>(tile) * EchoPlan::kTile,
                     floats * EchoPlan::kTile,
                     {}};
      for (int o = 0; o < kOutputs; ++o) sum.out[o] = out_row(kind, output + o);
      active_kernels().azimuth_sum(sum);
      ask(sum.n_rows * kOutputs * sum.n / kProducts);
    }
  }
}

float* EchoSums::out_row(int kind, int output) {
  return rows_[kind][static_cast<std::size_t>(output)].data() + (kind == kIq ? 2 : 1) * pad_;
}

/// Sharp bins of an output azimuth, each a draw of its own about its mean power.
void EchoSums::draw_row(std::uint64_t draw, int azimuth, std::size_t lane) {
  active_kernels().draw_speckle({mix64(draw ^ static_cast<std::uint64_t>(plan_.sharp.speckle_seed)),
                                 static_cast<std::uint64_t>(azimuth) << 32, static_cast<int>(stride_),
                                 rows_[kPower][lane].data() + pad_, rows_[kIq][lane].data() + 2 * pad_});
  ask(2 * static_cast<std::int64_t>(stride_));
}

/// Of one output row, into ranges_.
void EchoSums::sum_ranges(int kind, std::size_t lane) {
  const std::vector<float>& taps = kind == kIq ? plan_.gate_voltage : plan_.gate_power;
  const int floats = kind == kIq ? 2 : 1;
  const std::ptrdiff_t from = static_cast<std::ptrdiff_t>(pad_) + plan_.first_range + plan_.first_gate_tap;
  const int n = floats * ((plan_.n_range - 1) * plan_.range_parts + 1);
  for (int first = 0; first < n; first += kRun) {
    const int count = std::min(kRun, n - first);
    active_kernels().range_sum({floats, static_cast<int>(taps.size()), taps.data(),
                                rows_[kind][lane].data() + floats * from + first, count,
                                ranges_[kind].data() + first});
    ask(static_cast<std::int64_t>(taps.size()) * count / kProducts);
  }
}

/// One row of bins, of the radar's power.
void EchoSums::write(BinBlock& bins, std::size_t row, bool iq) const {
  ask(4 * plan_.n_range);
  const bool from_power = plan_.speckle == SpeckleKind::none;
  for (std::size_t m = 0; m < static_cast<std::size_t>(plan_.n_range); ++m) {
    const std::size_t sharp = m * static_cast<std::size_t>(plan_.range_parts);
    const double r2 = range2_m2_.empty() ? 1 : range2_m2_[m];
    const double power_w = static_cast<double>(ranges_[kPower][sharp]) * plan_.power_scale * (r2 * r2);
    bins.power_w[row + m] = power_w;
    bins.iq[row + m] = iq && from_power ? phase_[m] * static_cast<float>(std::sqrt(power_w)) : 0;
  }
  if (iq && !from_power) write_voltages(bins.iq.data() + row);
}

/// A row of what ranges_ has, over the bins' power.
void EchoSums::write_share(const BinBlock& bins, int output, float* share) const {
  ask(2 * plan_.n_range);
  const double* const power_w =
      bins.power_w.data() + static_cast<std::size_t>(output) * static_cast<std::size_t>(plan_.n_range);
  for (std::size_t m = 0; m < static_cast<std::size_t>(plan_.n_range); ++m) {
    const double r2 = range2_m2_.empty() ? 1 : range2_m2_[m];
    const double sum_w =
        static_cast<double>(ranges_[kPower][m * static_cast<std::size_t>(plan_.range_parts)]) *
        plan_.power_scale * (r2 * r2);
    share[m] = power_w[m] > 0 ? static_cast<float>(sum_w / power_w[m]) : 0;
  }
}

/// What ranges_ has of them, of the radar's power.
void EchoSums::write_voltages(std::complex<float>* row) const {
  ask(2 * plan_.n_range);
  const double voltage_scale = std::sqrt(plan_.power_scale);
  for (std::size_t m = 0; m < static_cast<std::size_t>(plan_.n_range); ++m) {
    const std::size_t sharp = m * static_cast<std::size_t>(plan_.range_parts);
    const double scale = voltage_scale * (range2_m2_.empty() ? 1 : range2_m2_[m]);
    row[m] = {static_cast<float>(static_cast<double>(ranges_[kIq][2 * sharp]) * scale),
              static_cast<float>(static_cast<double>(ranges_[kIq][2 * sharp + 1]) * scale)};
  }
}

/// Count and state of the bins' own ground.
void EchoSums::write_ground(const std::vector<const SharpWedge*>& rows, BinBlock& bins) const {
  const int first_row = plan_.first_row(bins.first_azimuth);
  for (int a = 0; a < bins.n_azimuth; ++a) {
    for (int part = 0; part < plan_.azimuth_parts; ++part) {
      ask(plan_.n_range * plan_.range_parts);
      const int row = a * plan_.azimuth_parts + part - plan_.first_tap;
      const SharpWedge& wedge = *rows[static_cast<std::size_t>(row)];
      const std::size_t from =
          static_cast<std::size_t>(plan_.sharp_azimuth(first_row + row) - wedge.first_azimuth) *
              static_cast<std::size_t>(wedge.n_range) +
          static_cast<std::size_t>(plan_.first_range);
      const std::size_t to = static_cast<std::size_t>(a) * static_cast<std::size_t>(plan_.n_range);
      const auto parts = static_cast<std::size_t>(plan_.range_parts);
      for (std::size_t r = 0; r < static_cast<std::size_t>(plan_.n_range) * parts; ++r) {
        const std::size_t bin = to + r / parts;
        const bool fresh = part == 0 && r % parts == 0;
        bins.count[bin] = (fresh ? 0 : bins.count[bin]) + wedge.count[from + r];
        if (!bins.labels.returns.empty())
          bins.labels.returns[bin] =
              std::max(fresh ? std::uint8_t{0} : bins.labels.returns[bin], wedge.returns[from + r]);
        bins.state[bin] = fresh ? wedge.state[from + r] : joined(bins.state[bin], wedge.state[from + r]);
      }
    }
  }
}

}  // namespace obliq
