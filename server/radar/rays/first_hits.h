#pragma once
#include <array>
#include <optional>

#include "server/radar/rays/ground_first_hits.h"
#include "server/radar/rays/ray_batch.h"
#include "server/radar/scene_plan.h"

namespace obliq {

/// First hits of the rays of one wedge, found as the scene's RayMethod says: all by Embree, or by marching.
/// Then rays walk the ground one by one, and Embree traces those that come near buildings.
class FirstHits {
 public:
  /// beyond_swath: finds hits there too, for textures.
  FirstHits(const ScenePlan& plan, AzimuthRange range, bool beyond_swath = false);

  /// As EmbreeTracer::trace, of rays that PerspectiveRays made for the wedge.
  void trace(const RayBatch& rays, RoughHit* hits);

  /// Whether Embree traced ray k of the last batch: such a ray may have leaked through the mesh. A marched
  /// ray never leaks; beyond the swath, where nothing is binned, a march ignores buildings.
  bool by_embree(std::size_t k) const { return by_embree_[k]; }

 private:
  const ScenePlan& plan_;
  std::optional<GroundFirstHits> ground_;
  std::array<bool, kBatch> by_embree_{};
};

}  // namespace obliq
