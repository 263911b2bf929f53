#include "server/radar/beam/echo_rows.h"

#include <algorithm>
#include <utility>

namespace obliq {

SharpWedgePtr SharpStore::find(int sharp_wedge, bool iq, bool states) const {
  const std::lock_guard lock(mutex_);
  const auto kept = kept_.find(sharp_wedge);
  if (kept == kept_.end() || (iq && kept->second.wedge->iq.empty()) || (states && !kept->second.states))
    return nullptr;
  return kept->second.wedge;
}

void SharpStore::keep(int sharp_wedge, bool states, SharpWedgePtr wedge) {
  const std::lock_guard lock(mutex_);
  const auto drop = [&](int index) {
    const auto kept = kept_.find(index);
    bytes_ -= kept->second.wedge->bytes();
    kept_.erase(kept);
    std::erase(order_, index);
  };
  if (kept_.contains(sharp_wedge)) drop(sharp_wedge);
  bytes_ += wedge->bytes();
  order_.push_back(sharp_wedge);
  kept_.emplace(sharp_wedge, Kept{std::move(wedge), states});
  while (bytes_ > kMostBytes && order_.size() > 1) drop(order_.front());
}

void SharpStore::clear() {
  const std::lock_guard lock(mutex_);
  kept_.clear();
  order_.clear();
  bytes_ = 0;
}

std::size_t SharpStore::bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

EchoRows::EchoRows(const EchoPlan& plan, int first, int end) : plan_(plan), first_(first) {
  for (int wedge = first; wedge < end; ++wedge) {
    Output output;
    for (const int row : sharp_rows(wedge)) {
      const int sharp = row / kWedgeAzimuthBins;
      if (std::ranges::find(output.sharp, sharp) == output.sharp.end()) output.sharp.push_back(sharp);
    }
    output.missing = static_cast<int>(output.sharp.size());
    for (const int sharp : output.sharp)
      if (users_[sharp]++ == 0) order_.push_back(sharp);
    outputs_.push_back(std::move(output));
  }
}

/// Sharp azimuths of an output wedge, from the first one's first tap on.
std::vector<int> EchoRows::sharp_rows(int wedge) const {
  const int first = wedge * kWedgeAzimuthBins;
  const int n = std::min(kWedgeAzimuthBins, plan_.n_azimuth - first);
  const int all = plan_.sharp.azimuth_bins;
  std::vector<int> rows;
  for (int k = 0; k < (n - 1) * plan_.azimuth_parts + plan_.n_taps; ++k) {
    const int row = plan_.first_row(first) + k;
    rows.push_back(plan_.wraps ? ((row % all) + all) % all : row);
  }
  return rows;
}

/// The output wedge that counts a sharp wedge's rays and samples: the one with its ground, or the nearest.
int EchoRows::owner_of(int sharp) const {
  const int middle = sharp * kWedgeAzimuthBins + kWedgeAzimuthBins / 2 - plan_.first_azimuth;
  return std::clamp(middle / (kWedgeAzimuthBins * plan_.azimuth_parts), 0, wedge_count(plan_.n_azimuth) - 1);
}

void EchoRows::take(int sharp, SharpWedgePtr wedge) {
  const std::lock_guard lock(mutex_);
  there_[sharp] = std::move(wedge);
  for (std::size_t k = 0; k < outputs_.size(); ++k)
    if (std::ranges::find(outputs_[k].sharp, sharp) != outputs_[k].sharp.end() && --outputs_[k].missing == 0)
      ready_.push_back(static_cast<int>(k));
}

bool EchoRows::next_ready(Ready& ready) {
  const std::lock_guard lock(mutex_);
  if (ready_.empty()) return false;
  const Output& output = outputs_[static_cast<std::size_t>(ready_.front())];
  ready = {};
  ready.wedge = first_ + ready_.front();
  ready_.pop_front();
  const int first = ready.wedge * kWedgeAzimuthBins;
  ready.azimuths = {first, std::min(kWedgeAzimuthBins, plan_.n_azimuth - first)};
  for (const int row : sharp_rows(ready.wedge))
    ready.rows.push_back(there_.at(row / kWedgeAzimuthBins).get());
  std::vector<int> own = output.sharp;
  std::ranges::sort(own);  // sums of statistics have one order
  for (const int sharp : own) {
    const auto there = there_.find(sharp);
    ready.owners.push_back(there->second);
    if (owner_of(sharp) == ready.wedge) ready.stats.add(there->second->stats);
    if (--users_.at(sharp) == 0) there_.erase(there);
  }
  return true;
}

}  // namespace obliq
