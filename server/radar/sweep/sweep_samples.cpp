#include "server/radar/sweep/sweep_samples.h"

#include <algorithm>

#include "server/radar/sweep/sweep_column.h"
#include "terrain/base/asking.h"
#include "terrain/base/stage_clock.h"

namespace obliq {

SweepSamples::SweepSamples(const ScenePlan& plan, AzimuthRange range)
    : plan_(plan),
      range_(range),
      columns_per_bin_(plan.extent().any ? sweep_columns_per_bin(plan.settings()) : 0),
      first_(range.first),
      sampler_(plan),
      ground_(plan) {
  const StageProbe probe(Stage::buildings);
  for (const std::uint32_t b : plan.buildings_in(range)) {
    ask(kASilhouette);
    silhouettes_.push_back(silhouette_of(plan.scene().world().buildings, plan.sector(), b));
    if (silhouettes_.back().near_m > plan.building_reach_m()) silhouettes_.pop_back();
  }
}

bool SweepSamples::fill(SampleBatch& samples, FrameStats& stats) {
  sampler_.begin(samples);
  if (!sampler_.full() && !done()) step(samples, stats);
  stats.hits += static_cast<std::uint64_t>(samples.n);
  return samples.n > 0 || !done();
}

void SweepSamples::step(SampleBatch& samples, FrameStats& stats) {
  if (marching_) {
    const StageProbe probe(Stage::ground);
    if (ground_.next(sampler_, samples)) return;
    marching_ = false;
    next_columns();
  } else if (const int bin = first_ + static_cast<int>(shares_.size()); bin < end_of_group()) {
    add_column(bin, stats);
  } else {
    const StageProbe probe(Stage::ground);
    ground_.start(std::move(shares_));
    shares_.clear();
    marching_ = true;
  }
}

int SweepSamples::end_of_group() const {
  return std::min(first_ + SweepGround::kMost, range_.first + range_.count);
}

void SweepSamples::next_columns() {
  if (++within_ < columns_per_bin_) return;
  within_ = 0;
  first_ += SweepGround::kMost;
}

void SweepSamples::add_column(int bin, FrameStats& stats) {
  const StageProbe probe(Stage::buildings);
  const BinGrid& bins = plan_.bins();
  SweepColumn column(plan_, bin, bins.azimuth_edge_rad(bin + static_cast<double>(within_) / columns_per_bin_),
                     bins.azimuth_width_rad / columns_per_bin_);
  column.start(silhouettes_, sampler_);
  stats.rays += static_cast<std::uint64_t>(column.planes());
  shares_.push_back(column.base());
}

}  // namespace obliq
