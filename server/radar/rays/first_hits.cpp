#include "server/radar/rays/first_hits.h"

#include <span>

namespace obliq {

FirstHits::FirstHits(const ScenePlan& plan, AzimuthRange range, bool beyond_swath) : plan_(plan) {
  if (plan.scene().rays() == RayMethod::march && plan.extent().any)
    ground_.emplace(plan, range, beyond_swath);
}

void FirstHits::trace(const RayBatch& rays, RoughHit* hits) {
  by_embree_.fill(false);
  std::span<const std::uint16_t> left(rays.packet_order.data(), static_cast<std::size_t>(rays.n));
  if (ground_) left = ground_->trace(rays, hits);
  if (left.empty()) return;
  for (const std::uint16_t k : left) by_embree_[k] = true;
  plan_.scene().tracer().trace(plan_.sector().antenna_m, rays.dir_x.data(), rays.dir_y.data(),
                               rays.dir_z.data(), static_cast<int>(left.size()), hits, left.data());
}

}  // namespace obliq
