#pragma once
#include <vector>

#include "server/radar/geometry/silhouettes.h"
#include "server/radar/samples.h"
#include "server/radar/sweep/sweep_ground.h"

namespace obliq {

/// The sweep: no rays; vertical planes marched outwards, each visible segment of surface one sample or more.
/// An azimuth bin is divided into columns of equal width, as many as make at least `pixel_columns` in the
/// sector; a column lies in one bin. Columns that stand at the same place in their bins go together: first
/// the buildings of one after the other, then the ground of all of them side by side.
class SweepSamples : public SampleSource {
 public:
  SweepSamples(const ScenePlan& plan, AzimuthRange range);
  bool fill(SampleBatch& samples, FrameStats& stats) override;

 private:
  bool done() const { return columns_per_bin_ == 0 || first_ >= range_.first + range_.count; }
  /// The buildings of one column, or as much ground as a batch holds.
  void step(SampleBatch& samples, FrameStats& stats);
  int end_of_group() const;
  void next_columns();
  void add_column(int bin, FrameStats& stats);

  const ScenePlan& plan_;
  AzimuthRange range_;
  int columns_per_bin_;                  // none where no ground is known
  int first_;                            // bin of those that go together
  int within_ = 0;                       // their columns' place in the bin
  std::vector<Silhouette> silhouettes_;  // of the wedge's buildings, by their numbers
  SegmentSampler sampler_;
  SweepGround ground_;
  std::vector<GroundShare> shares_;  // of the columns whose buildings are done
  bool marching_ = false;
};

}  // namespace obliq
