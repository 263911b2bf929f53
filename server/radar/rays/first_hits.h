#pragma once
#include <array>
#include <optional>

#include "server/radar/rays/ground_first_hits.h"
#include "server/radar/rays/polar_trace.h"
#include "server/radar/rays/ray_batch.h"
#include "server/radar/samples.h"

namespace obliq {

/// What the rays of one wedge meet first, found as the scene's RayMethod says. With a march, the columns of
/// the polar frustum are marched as the vertical planes that they are, rays of the others walk the ground one
/// by one, and Embree traces those that come near buildings.
class RayTrace {
 public:
  /// beyond_swath: for textures, which show what no bin holds (of the polar frustum still without buildings).
  RayTrace(const FramePlan& plan, AzimuthRange range, bool beyond_swath = false);

  /// As EmbreeTracer::trace, of rays that the plan's RaySource made for the wedge.
  void trace(const RayBatch& rays, RoughHit* hits);

  /// Whether Embree traced ray k of the last batch: it may have leaked through the mesh. A march lets no ray
  /// through; beyond the swath, where nothing is binned, it leaves buildings out.
  bool by_embree(std::size_t k) const { return by_embree_[k]; }

 private:
  const FramePlan& plan_;
  std::optional<PolarTrace> polar_;
  std::optional<GroundTrace> ground_;
  std::array<bool, kBatch> by_embree_{};
};

}  // namespace obliq
