#pragma once
#include <vector>

#include "server/radar/batches.h"
#include "server/radar/frame_plan.h"
#include "server/radar/swept_rays.h"

namespace obliq {

/// What the polar frustum's rays of one wedge meet first. Its columns are vertical planes, so that a march of
/// each answers all its rays, ten times sooner than a ray tracer does one by one.
class PolarTrace {
 public:
  PolarTrace(const FramePlan& plan, AzimuthRange range);

  /// As EmbreeTracer::trace, of rays that PolarRays made for the wedge. The first call marches.
  void trace(const RayBatch& rays, RoughHit* hits);

 private:
  void march();
  RoughHit walk(const RayBatch& rays, std::size_t k) const;
  std::uint32_t triangle_of(std::uint32_t face) const;

  const FramePlan& plan_;
  AzimuthRange range_;
  const SweptRays& rays_;
  int first_column_ = 0;
  bool marched_ = false;
  std::vector<double> slant_range_m_;   // [columns][rows]
  std::vector<std::uint32_t> surface_;  // [columns][rows]
};

}  // namespace obliq
