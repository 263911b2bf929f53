#include "server/radar/ray_source.h"

#include "server/radar/perspective_rays.h"
#include "server/radar/polar_rays.h"

namespace obliq {
namespace {

class NoRays : public RaySource {
 public:
  bool next(RayBatch& batch) override {
    batch.n = 0;
    return false;
  }
};

}  // namespace

std::unique_ptr<RaySource> make_ray_source(const FramePlan& plan, AzimuthRange range) {
  if (!plan.extent().any) return std::make_unique<NoRays>();
  if (plan.settings().frustum == FrustumKind::polar) return std::make_unique<PolarRays>(plan, range);
  return std::make_unique<PerspectiveRays>(plan, range);
}

}  // namespace obliq
