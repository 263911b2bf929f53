#include "server/radar/beam/doppler_rows.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "server/radar/simd/kernels.h"
#include "terrain/base/asking.h"

namespace obliq {
namespace {

static_assert(EchoPlan::kTile % CellSpan::kBins == 0);

// In units of ask(), a bin of a canceller.
constexpr std::int64_t kCancelWork = 2;

MovingEchoes echoes_of(const ByLag& residue) {
  MovingEchoes echoes{static_cast<float>(std::accumulate(residue.begin(), residue.end(), 0.0)), {}};
  for (std::size_t k = 1; k < residue.size(); ++k) echoes.turned[k - 1] = static_cast<float>(residue[k]);
  return echoes;
}

}  // namespace

void moving_power(const DopplerPlan& doppler, const SharpWedge& wedge, int azimuth,
                  std::vector<float>& moving) {
  const auto share = static_cast<float>(doppler.moving_share());
  if (!doppler.all_windy()) return power_of_materials(wedge, azimuth, doppler.windy(), share, moving);
  const float* const power = wedge.power_row(azimuth);
  moving.resize(wedge.stride);
  for (std::size_t m = 0; m < moving.size(); ++m) moving[m] = share * power[m];
  ask(static_cast<std::int64_t>(moving.size()));
}

DopplerRows::DopplerRows(const EchoPlan& plan)
    : plan_(plan),
      stride_(sharp_stride(plan)),
      moving_echoes_(echoes_of(plan.doppler->residue())),
      sea_echoes_(echoes_of(plan.doppler->sea_residue())),
      kept_(static_cast<std::size_t>(
          std::min(plan.rows_of(kWedgeAzimuthBins) + kWedgeAzimuthBins, plan.n_rows))),
      outputs_(kWedgeAzimuthBins),
      zeros_(stride_),
      dark_(stride_ / CellSpan::kBins, CellSpan{0, -1}) {}

void DopplerRows::take(const std::vector<const SharpWedge*>& rows, int first_row, Voltages voltages,
                       std::uint64_t key) {
  rows_.clear();
  for (Places* const places : {&places_, &sea_.places}) {
    places->firsts.clear();
    places->seconds.clear();
    places->spans.clear();
  }
  for (auto* const rows_of : {&sea_.power, &sea_.re, &sea_.im}) rows_of->clear();
  moving_.clear();
  re_.clear();
  im_.clear();
  const bool has_sea = plan_.doppler->has_sea();
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const int azimuth = plan_.sharp_azimuth(first_row + static_cast<int>(k));
    Row& row = kept_[place_of(first_row + static_cast<int>(k))];
    if (row.azimuth != azimuth) {
      row.azimuth = azimuth;
      row.voltages = Voltages::none;
      row.power = nullptr;
      row.places.level_hz = level_hz(plan_.row_middle_rad(azimuth));
      row.places.place(*plan_.doppler, stride_, rows[k]->sine_row(azimuth), rows[k]->power_row(azimuth),
                       plan_.doppler->ground().up_hz());
      if (!plan_.doppler->windy().empty()) moving_power(*plan_.doppler, *rows[k], azimuth, row.moving);
      if (has_sea) row.sea.place(plan_, *rows[k], azimuth);
    }
    row.whole = rows[k]->power_row(azimuth);
    if (row.power == nullptr || row.voltages != voltages || row.key != key)
      make(row, *rows[k], voltages, key);
    rows_.push_back(&row);
    add_places(row.places, places_);
    if (!row.moving.empty()) moving_.push_back(row.moving.data());
    re_.push_back(row.re.data());
    im_.push_back(row.im.data());
    if (!has_sea) continue;
    sea_.power.push_back(row.sea.power.data());
    sea_.re.push_back(row.sea.re.data());
    sea_.im.push_back(row.sea.im.data());
    add_places(row.sea.places, sea_.places);
  }
  const auto all = static_cast<std::size_t>(plan_.rows_of(kWedgeAzimuthBins));
  for (auto* const rows_of : {&re_, &im_}) rows_of->resize(all, zeros_.data());
  if (!moving_.empty()) moving_.resize(all, zeros_.data());
  for (auto* const rows_of : {&sea_.power, &sea_.re, &sea_.im})
    if (has_sea) rows_of->resize(all, zeros_.data());
  for (Places* const places : {&places_, &sea_.places}) {
    places->firsts.resize(all, zeros_.data());
    places->seconds.resize(all, zeros_.data());
    places->spans.resize(all, dark_.data());
  }
}

void DopplerRows::add_places(const RowPlaces& of_row, Places& all) const {
  all.firsts.push_back(of_row.first.data());
  all.seconds.push_back(of_row.second.data());
  all.spans.push_back(of_row.spans.data());
}

std::size_t DopplerRows::place_of(int row) const {
  const auto n = static_cast<int>(kept_.size());
  return static_cast<std::size_t>((row % n + n) % n);
}

void DopplerRows::place_outputs(int first_azimuth) {
  const DopplerPlan& doppler = *plan_.doppler;
  for (int o = 0; o < kWedgeAzimuthBins; ++o) {
    RowPlaces& output = outputs_[static_cast<std::size_t>(o)];
    output.level_hz = level_hz(plan_.output_middle_rad(first_azimuth + o));
    if (doppler.has_lock())
      output.place(doppler, stride_, doppler.level_sine().data(), nullptr, doppler.ground().up_hz());
  }
  const auto all = static_cast<std::size_t>(plan_.rows_of(kWedgeAzimuthBins)) * kWedgeAzimuthBins;
  for (Places* const places : {&places_, &sea_.places}) places->away_hz.assign(all, 0);
  std::size_t at = 0;
  for (const Row* row : rows_)
    for (const RowPlaces& output : outputs_) {
      places_.away_hz[at] = static_cast<float>(row->places.level_hz - output.level_hz);
      sea_.places.away_hz[at++] = static_cast<float>(row->sea.places.level_hz - output.level_hz);
    }
}

double DopplerRows::level_hz(double azimuth_rad) const {
  return plan_.doppler->ground().level_hz(sincos_turns(azimuth_rad / (2 * std::numbers::pi)));
}

void DopplerRows::make(Row& row, const SharpWedge& wedge, Voltages voltages, std::uint64_t key) {
  row.voltages = voltages;
  row.key = key;
  row.power = wedge.power_row(row.azimuth);
  row.iq = nullptr;
  if (voltages == Voltages::own) row.iq = wedge.iq_row(row.azimuth);
  if (voltages == Voltages::look) row.iq = wedge.look_row(row.azimuth);
  if (voltages == Voltages::drawn) {
    row.own_iq.resize(2 * stride_);
    draw_sharp_row(plan_, row.azimuth, key, row.power, row.own_iq.data());
    row.iq = row.own_iq.data();
  }
  if (plan_.doppler->is_of_beam()) return;
  const bool has_sea = plan_.doppler->has_sea();
  if (has_sea && row.iq != nullptr) {
    row.sea.split(plan_, row.azimuth, voltages == Voltages::drawn ? key : 0, row.iq, row.power);
    row.iq = row.sea.rest_iq.data();
  }
  if (has_sea) row.power = row.sea.rest_power.data();
  if (!plan_.doppler->is_of_rows()) {
    if (row.iq == nullptr) return;
    row.re.resize(stride_);
    row.im.resize(stride_);
    for (std::size_t m = 0; m < stride_; ++m) {
      row.re[m] = row.iq[2 * m];
      row.im[m] = row.iq[2 * m + 1];
    }
    return;
  }
  row.own_power.resize(stride_);
  if (row.iq != nullptr) row.own_iq.resize(2 * stride_);
  cancel({row.places.first.data(), row.power, row.moving.empty() ? nullptr : row.moving.data(),
          moving_echoes_, row.iq},
         row.own_power.data(), row.own_iq.data());
  if (has_sea) {
    // All of it moves. What is left of it is added.
    std::vector<float> power(stride_), iq(row.own_iq.size());
    cancel({row.sea.places.first.data(), row.sea.power.data(), row.sea.power.data(), sea_echoes_,
            row.iq == nullptr ? nullptr : row.sea.iq.data()},
           power.data(), iq.data());
    ask(kCancelWork * static_cast<std::int64_t>(stride_));
    for (std::size_t m = 0; m < power.size(); ++m) row.own_power[m] += power[m];
    for (std::size_t m = 0; row.iq != nullptr && m < iq.size(); ++m) row.own_iq[m] += iq[m];
  }
  row.power = row.own_power.data();
  if (row.iq != nullptr) row.iq = row.own_iq.data();
}

const float* DopplerRows::moving_of(std::size_t k, int kind, const float* power) {
  Row& row = *rows_[k];
  if (row.moving.empty()) return nullptr;
  const DopplerPlan& doppler = *plan_.doppler;
  row.other_moving.resize(stride_);
  if (kind == LabelShare::kHeights) {
    // Heights by power: all that is in a bin moves alike.
    for (std::size_t m = 0; m < stride_; ++m)
      row.other_moving[m] = row.whole[m] > 0 ? power[m] * (row.moving[m] / row.whole[m]) : 0;
  } else {
    if (kind >= LabelShare::kBuildings || !std::ranges::binary_search(doppler.windy(), kind)) return nullptr;
    const auto share = static_cast<float>(doppler.moving_share());
    for (std::size_t m = 0; m < stride_; ++m) row.other_moving[m] = share * power[m];
  }
  ask(static_cast<std::int64_t>(stride_));
  return row.other_moving.data();
}

DopplerRows::LabelPowers DopplerRows::powers_of(std::size_t k, int kind, const float* power) {
  const DopplerPlan& doppler = *plan_.doppler;
  if (!doppler.has_sea()) return {power, nullptr};
  if (std::ranges::binary_search(doppler.sea().materials, kind)) return {nullptr, power};
  if (kind != LabelShare::kHeights) return {power, nullptr};
  // Heights by power.
  Row& row = *rows_[k];
  row.rest_power.resize(stride_);
  row.sea_power.resize(stride_);
  for (std::size_t m = 0; m < stride_; ++m) {
    row.sea_power[m] = row.whole[m] > 0 ? power[m] * (row.sea.power[m] / row.whole[m]) : 0;
    row.rest_power[m] = power[m] - row.sea_power[m];
  }
  ask(static_cast<std::int64_t>(stride_));
  return {row.rest_power.data(), row.sea_power.data()};
}

const float* DopplerRows::filtered(std::size_t k, const LabelPowers& of, const float* moving) {
  Row& row = *rows_[k];
  row.other_power.assign(stride_, 0);
  if (of.rest != nullptr)
    cancel({row.places.first.data(), of.rest, moving, moving_echoes_, nullptr}, row.other_power.data(),
           nullptr);
  if (of.sea == nullptr) return row.other_power.data();
  std::vector<float> sea(stride_);
  cancel({row.sea.places.first.data(), of.sea, of.sea, sea_echoes_, nullptr}, sea.data(), nullptr);
  for (std::size_t m = 0; m < stride_; ++m) row.other_power[m] += sea[m];
  return row.other_power.data();
}

void DopplerRows::cancel(const Echoes& of, float* out_power, float* out_iq) const {
  ask(kCancelWork * static_cast<std::int64_t>(stride_));
  const DopplerPlan& doppler = *plan_.doppler;
  active_kernels().cancel_row({static_cast<int>(stride_), doppler.delays(),
                               static_cast<float>(doppler.over_noise_root()), of.sin, of.power, of.moving,
                               of.echoes, of.iq, out_power, out_iq});
}

}  // namespace obliq
