#pragma once
#include <cstdint>

#include "server/scene/exact_hit.h"

namespace obliq {

/// Receives every hit with its pixel, for the perspective textures. Called from any thread, for each pixel at
/// most once.
class HitObserver {
 public:
  virtual ~HitObserver() = default;
  virtual void on_hit(std::uint32_t pixel, double azimuth_offset_rad, const ExactHit& hit) = 0;
};

}  // namespace obliq
