#pragma once
#include <array>
#include <memory>
#include <vector>

#include "server/radar/plate_spreader.h"
#include "server/radar/ray_source.h"
#include "server/radar/sample_source.h"

namespace obliq {

/// The three frusta: rays through pixels, traced by Embree, re-intersected in double. With nearest plates one
/// sample a hit, with spread plates one for every range bin and surface that the hit's pixel covers.
class RaySamples : public SampleSource {
 public:
  RaySamples(const FramePlan& plan, AzimuthRange range, SampleTap* tap, WedgeProfile* profile);
  ~RaySamples() override;
  bool next(SampleBatch& samples, FrameStats& stats) override;

 private:
  bool trace(FrameStats& stats);
  void take_nearest(SampleBatch& samples, FrameStats& stats);
  void take_spread(FrameStats& stats);
  bool unload(SampleBatch& samples);
  std::optional<ExactHit> exact_hit(std::size_t k, FrameStats& stats);

  const FramePlan& plan_;
  SampleTap* tap_;
  std::unique_ptr<RaySource> source_;
  std::unique_ptr<WedgeProfile> own_profile_;  // null when one was handed in, or none is needed
  std::unique_ptr<PlateSpreader> spreader_;    // null: nearest plates
  RayBatch rays_;
  std::array<RoughHit, kBatch> rough_;
  std::vector<Sample> spread_;  // made, not yet handed out from unloaded_ on
  std::size_t unloaded_ = 0;
  bool finished_ = false;
};

}  // namespace obliq
