#pragma once
#include <array>
#include <memory>

#include "server/radar/ray_source.h"
#include "server/radar/sample_source.h"

namespace obliq {

/// The three frusta: rays through pixels, traced by Embree, re-intersected in double, one sample a hit.
class RaySamples : public SampleSource {
 public:
  RaySamples(const FramePlan& plan, AzimuthRange range, SampleTap* tap);
  bool next(SampleBatch& samples, FrameStats& stats) override;

 private:
  void refine(SampleBatch& samples, FrameStats& stats);

  const FramePlan& plan_;
  SampleTap* tap_;
  std::unique_ptr<RaySource> source_;
  RayBatch rays_;
  std::array<RoughHit, kBatch> rough_;
};

}  // namespace obliq
