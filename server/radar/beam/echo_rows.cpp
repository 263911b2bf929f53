#include "server/radar/beam/echo_rows.h"

#include <algorithm>
#include <utility>

#include "terrain/base/asking.h"

namespace obliq {

void SharpStore::fit(const EchoPlan& plan) {
  const std::array<int, 4> layout{plan.first_azimuth, plan.first_range, plan.looks_at().azimuth_bins,
                                  plan.sharp.range_bins};
  {
    const std::lock_guard lock(mutex_);
    if (std::exchange(layout_, layout) == layout) return;
  }
  clear();
}

SharpWedgePtr SharpStore::find(int sharp_wedge, const SharpPlanes& wanted) const {
  const std::lock_guard lock(mutex_);
  const auto kept = kept_.find(sharp_wedge);
  if (kept == kept_.end() || !kept->second.planes.hold(wanted)) return nullptr;
  return kept->second.wedge;
}

void SharpStore::keep(int sharp_wedge, const SharpPlanes& planes, SharpWedgePtr wedge) {
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
  kept_.emplace(sharp_wedge, Kept{std::move(wedge), planes});
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

EchoRows::EchoRows(const RowWindow& window, std::vector<int> outputs)
    : window_(window),
      wedges_(std::move(outputs)),
      n_wedges_(wedge_count(window.n_rows)),
      there_(static_cast<std::size_t>(n_wedges_)),
      users_(there_.size(), 0) {
  for (const int wedge : wedges_) {
    const int rows = window.rows_of(azimuths_of(wedge).count);
    const int first_sharp =
        window.sharp_azimuth(window.first_row(wedge * kWedgeAzimuthBins)) / kWedgeAzimuthBins;
    Output output{first_sharp, 0, 0};
    // The rows of a full circle may come back to the wedge that they begin in.
    for (int row = 0; row < rows && output.count < n_wedges_; ++output.count) {
      const int azimuth = window.sharp_azimuth(window.first_row(wedge * kWedgeAzimuthBins) + row);
      const int next = std::min((azimuth / kWedgeAzimuthBins + 1) * kWedgeAzimuthBins, window.n_rows);
      row += next - azimuth;
      if (users_[static_cast<std::size_t>(azimuth / kWedgeAzimuthBins)]++ == 0)
        order_.push_back(azimuth / kWedgeAzimuthBins);
    }
    output.missing = output.count;
    outputs_.push_back(output);
    ask(8 * std::int64_t{output.count});
  }
}

AzimuthRange EchoRows::azimuths_of(int wedge) const {
  const int first = wedge * kWedgeAzimuthBins;
  return {first, std::min(kWedgeAzimuthBins, window_.n_azimuth - first)};
}

/// Which of an output's sharp wedges a wedge is; not below its count: none.
int EchoRows::place_in(const Output& output, int sharp) const {
  return sharp >= output.first ? sharp - output.first : sharp - output.first + n_wedges_;
}

/// The output wedge that counts a sharp wedge's rays and samples: the one with its ground, or the nearest.
int EchoRows::owner_of(int sharp) const {
  const int middle = sharp * kWedgeAzimuthBins + kWedgeAzimuthBins / 2 - window_.first_azimuth;
  return std::clamp(middle / (kWedgeAzimuthBins * window_.azimuth_parts), 0,
                    wedge_count(window_.n_azimuth) - 1);
}

void EchoRows::take(int sharp, SharpWedgePtr wedge) {
  const std::lock_guard lock(mutex_);
  there_[static_cast<std::size_t>(sharp)] = std::move(wedge);
  for (std::size_t k = 0; k < outputs_.size(); ++k)
    if (place_in(outputs_[k], sharp) < outputs_[k].count && --outputs_[k].missing == 0)
      ready_.push_back(static_cast<int>(k));
}

bool EchoRows::next_ready(Ready& ready) {
  ready = {};
  const Output* output = nullptr;
  {
    const std::lock_guard lock(mutex_);
    if (ready_.empty()) return false;
    const auto place = static_cast<std::size_t>(ready_.front());
    ready.wedge = wedges_[place];
    output = &outputs_[place];
    ready_.pop_front();
    for (int k = 0; k < output->count; ++k) {
      const auto sharp = static_cast<std::size_t>((output->first + k) % n_wedges_);
      ready.owners.push_back(there_[sharp]);
      if (--users_[sharp] == 0) there_[sharp] = nullptr;
    }
  }
  ready.azimuths = azimuths_of(ready.wedge);
  const int first_row = window_.first_row(ready.azimuths.first);
  const int rows = window_.rows_of(ready.azimuths.count);
  ask(2 * std::int64_t{rows});
  for (int k = 0; k < rows; ++k) {
    const int sharp = window_.sharp_azimuth(first_row + k) / kWedgeAzimuthBins;
    ready.rows.push_back(ready.owners[static_cast<std::size_t>(place_in(*output, sharp))].get());
  }
  // Sums of statistics have one order.
  for (int sharp = 0; sharp < n_wedges_; ++sharp) {
    const int place = place_in(*output, sharp);
    if (place < output->count && owner_of(sharp) == ready.wedge)
      ready.stats.add(ready.owners[static_cast<std::size_t>(place)]->stats);
  }
  return true;
}

}  // namespace obliq
