#pragma once
#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "server/radar/rays/first_hits.h"
#include "server/radar/rays/hit_observer.h"
#include "server/radar/rays/plates/plate_source.h"
#include "server/radar/rays/ray_source.h"
#include "server/radar/samples.h"
#include "server/radar/simd/refine_hits.h"

namespace obliq {

/// Rays of azimuth bins [range.first, range.first + range.count), from the plan's frustum.
std::unique_ptr<RaySource> make_ray_source(const FramePlan& plan, AzimuthRange range);

class WedgeVisibility;  // server/radar/visibility/wedge_visibility.h

/// The three frusta: rays through pixels, traced (ray_trace.h) and re-intersected in double. With nearest
/// plates one sample a hit, with spread plates one for every range bin and surface that the hit's pixel
/// covers.
class RaySamples : public SampleSource {
 public:
  RaySamples(const FramePlan& plan, AzimuthRange range, SampleTap* tap, WedgeVisibility* profile);
  ~RaySamples() override;
  bool next(SampleBatch& samples, FrameStats& stats) override;

 private:
  bool trace(FrameStats& stats);
  void take_nearest(SampleBatch& samples, FrameStats& stats);
  bool next_rays(FrameStats& stats);
  void spread_some();
  bool unload(SampleBatch& samples);
  void meet_ground();
  std::optional<ExactHit> exact_hit(std::size_t k, FrameStats& stats);
  bool on_ground(std::size_t k) const;
  ExactHit ground_hit(std::size_t k) const;

  const FramePlan& plan_;
  SampleTap* tap_;
  std::unique_ptr<RaySource> source_;
  std::unique_ptr<WedgeVisibility> own_profile_;  // null when one was handed in, or none is needed
  std::unique_ptr<PlateSpreader> spreader_;       // null: nearest plates
  RayTrace trace_;
  RayBatch rays_;
  std::array<RoughHit, kBatch> rough_;
  std::array<std::optional<ExactHit>, kBatch> exact_;  // of spread plates
  std::array<double, kBatch> rough_ground_m_;          // NaN where no ground was met
  GroundHits ground_;
  std::vector<Sample> spread_;  // made, not yet handed out from unloaded_ on
  std::size_t unloaded_ = 0;
  int spread_rays_ = 0;  // of the batch
  bool finished_ = false;
};

}  // namespace obliq
