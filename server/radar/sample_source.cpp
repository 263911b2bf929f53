#include "server/radar/sample_source.h"

#include "server/radar/ray_samples.h"
#include "server/radar/sweep_samples.h"

namespace obliq {

bool needs_tracer(const Scene& scene, FrustumKind frustum) {
  if (frustum == FrustumKind::sweep) return false;
  if (scene.rays() == RayMethod::embree) return true;
  return frustum != FrustumKind::polar && !scene.world().buildings.list.empty();
}

std::unique_ptr<SampleSource> make_sample_source(const FramePlan& plan, AzimuthRange range, SampleTap* tap,
                                                 WedgeProfile* profile) {
  if (plan.settings().frustum == FrustumKind::sweep) return std::make_unique<SweepSamples>(plan, range);
  return std::make_unique<RaySamples>(plan, range, tap, profile);
}

}  // namespace obliq
