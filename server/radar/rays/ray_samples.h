#pragma once
#include <array>
#include <memory>
#include <vector>

#include "server/radar/rays/first_hits.h"
#include "server/radar/rays/perspective_rays.h"
#include "server/radar/rays/plates/pixel_plates.h"
#include "server/radar/rays/ray_batch.h"
#include "server/radar/samples.h"

namespace obliq {

/// Rays of azimuth bins [range.first, range.first + range.count), from the plan's frustum; null where the
/// sector holds no known ground.
std::unique_ptr<PerspectiveRays> make_ray_source(const ScenePlan& plan, AzimuthRange range);

/// The symmetric and the oblique frustum, in four stages: generate rays through pixels, trace them to their
/// first hits, refine those in double, and spread each pixel's solid angle: with nearest plates one sample a
/// hit, with spread plates one for every range bin and surface that the pixel's footprint covers.
class RaySamples : public SampleSource {
 public:
  RaySamples(const ScenePlan& plan, AzimuthRange range, HitObserver* observer, WedgeVisibility* profile);
  ~RaySamples() override;
  bool fill(SampleBatch& samples, FrameStats& stats) override;

 private:
  bool next_hits(FrameStats& stats);
  bool generate(FrameStats& stats);
  void trace();
  void refine(FrameStats& stats);
  void refine_ground();
  bool is_settled_ground(std::size_t k) const;
  void refine_one(std::size_t k, FrameStats& stats);
  void take_nearest(SampleBatch& samples) const;
  void spread(SampleBatch& samples, FrameStats& stats);
  void hand_out(SampleBatch& samples);

  const ScenePlan& plan_;
  HitObserver* observer_;
  std::unique_ptr<PerspectiveRays> source_;       // null: no rays
  std::unique_ptr<WedgeVisibility> own_profile_;  // null when one was handed in, or none is needed
  std::unique_ptr<PixelPlates> plates_;           // null: nearest plates
  FirstHits first_hits_;
  RayBatch rays_;
  std::array<RoughHit, kBatch> rough_;  // first hits as they were traced
  HitBatch hits_;                       // the same, refined
  std::vector<Sample> waiting_;         // handed out up to handed_out_
  std::size_t handed_out_ = 0;
  int spread_rays_ = 0;  // of the batch
  bool finished_ = false;
};

}  // namespace obliq
