#pragma once
#include <memory>
#include <vector>

#include "server/radar/frame_plan.h"
#include "server/radar/rays/plates/plate.h"
#include "server/radar/rays/ray_batch.h"
#include "server/scene/exact_hit.h"

namespace obliq {

/// Turns the rays of one wedge and their hits into samples, a plate for each pixel whose ray hit something:
/// the samples of one pixel share its solid angle. Rays come in the order of the ray source.
class PlateSpreader {
 public:
  virtual ~PlateSpreader() = default;
  /// Ray k of the batch; hit may be null. Samples are appended to `samples`, some of them only when later
  /// rays have been taken.
  virtual void take(const RayBatch& rays, std::size_t k, const ExactHit* hit,
                    std::vector<Sample>& samples) = 0;
  /// After the last ray.
  virtual void finish(std::vector<Sample>& samples) = 0;
};

}  // namespace obliq
