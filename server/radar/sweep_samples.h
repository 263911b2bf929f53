#pragma once
#include <memory>
#include <vector>

#include "server/radar/sample_source.h"
#include "server/radar/sweep_column.h"

namespace obliq {

/// The sweep: no rays; vertical planes marched outwards, each visible piece of surface one sample or more. An
/// azimuth bin is divided into columns of equal width, as many as make at least `pixel_columns` in the
/// sector; a column lies in one bin.
class SweepSamples : public SampleSource {
 public:
  SweepSamples(const FramePlan& plan, AzimuthRange range);
  bool next(SampleBatch& samples, FrameStats& stats) override;

 private:
  void begin_column();

  const FramePlan& plan_;
  AzimuthRange range_;
  int columns_per_bin_;
  int columns_;     // in the wedge; none where no ground is known
  int column_ = 0;  // within the wedge
  std::vector<Silhouette> silhouettes_;
  PieceSampler sampler_;
  std::unique_ptr<SweepColumn> current_;
};

/// Columns that the sweep cuts an azimuth bin into.
int sweep_columns_per_bin(const RadarSettings& settings);

}  // namespace obliq
