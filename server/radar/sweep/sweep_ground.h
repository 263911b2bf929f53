#pragma once
#include <vector>

#include "server/radar/simd/ground/cut_at_bins.h"
#include "server/radar/sweep/segment_sampler.h"

namespace obliq {

/// What a plane over bare ground stands for: width_rad[k] up to ground distance to_m[k], the last one
/// infinite.
struct GroundShare {
  PlaneShare plane;
  std::vector<double> to_m;
  std::vector<double> width_rad;
};

/// Marches up to eight planes over bare ground side by side, from the nadir outwards, and cuts what they see
/// into samples. Samples of one plane come in order of distance; those of different planes are mixed, always
/// in the same way.
class SweepGround {
 public:
  static constexpr int kMost = SightProfiles::kLanes;

  explicit SweepGround(const ScenePlan& plan);

  /// Begins with other planes; `shares` is kept until they have been marched.
  void start(std::vector<GroundShare> shares);

  /// Marches until the sampler is full; false when all planes have come to their ends.
  bool next(SegmentSampler& sampler, SampleBatch& samples);

 private:
  void cut_rare(SegmentSampler& sampler);

  const ScenePlan& plan_;
  SegmentCut bins_;
  std::vector<GroundShare> shares_;
  SightProfiles lanes_;
  VisibleSegments segments_;
  int cut_ = 0;  // rows of segments that are samples already
  bool marching_ = false;
};

}  // namespace obliq
