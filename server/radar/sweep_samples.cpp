#include "server/radar/sweep_samples.h"

#include <algorithm>

namespace obliq {

int sweep_columns_per_bin(const RadarSettings& settings) {
  return (settings.pixel_columns + settings.azimuth_bins - 1) / settings.azimuth_bins;
}

SweepSamples::SweepSamples(const FramePlan& plan, AzimuthRange range)
    : plan_(plan),
      range_(range),
      columns_per_bin_(sweep_columns_per_bin(plan.settings())),
      columns_(plan.extent().any ? range.count * columns_per_bin_ : 0),
      sampler_(plan) {}

void SweepSamples::begin_column() {
  const int within = column_ % columns_per_bin_;
  const int bin = range_.first + column_ / columns_per_bin_;
  if (within == 0) {
    silhouettes_.clear();
    for (const std::uint32_t b : plan_.buildings_in(bin))
      silhouettes_.push_back(silhouette_of(plan_.scene().world().buildings, plan_.sector(), b));
  }
  const BinGrid& bins = plan_.bins();
  const double width_rad = bins.azimuth_width_rad / columns_per_bin_;
  current_ = std::make_unique<SweepColumn>(
      plan_, bin, bins.azimuth_edge_rad(bin + static_cast<double>(within) / columns_per_bin_), width_rad);
  current_->start(silhouettes_, sampler_);
}

bool SweepSamples::next(SampleBatch& samples, FrameStats& stats) {
  sampler_.begin(samples);
  const std::uint64_t before = sampler_.samples();
  while (!sampler_.full()) {
    if (!current_) {
      if (column_ == columns_) break;
      begin_column();
    } else if (!current_->continue_base(sampler_)) {
      stats.rays += static_cast<std::uint64_t>(current_->planes());
      current_.reset();
      ++column_;
    }
  }
  stats.hits += sampler_.samples() - before;
  return samples.n > 0;
}

}  // namespace obliq
