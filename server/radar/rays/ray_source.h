#pragma once
#include <memory>

#include "server/radar/frame_plan.h"
#include "server/radar/rays/ray_batch.h"

namespace obliq {

/// Generates the rays of one wedge, batch by batch, in a fixed order that keeps packets compact: squares
/// of pixels (pixel_squares.h), back and forth. Every pixel of the frame belongs to exactly one azimuth
/// bin, known before its ray is traced, because a ray stays in its vertical plane.
class RaySource {
 public:
  static constexpr int kMostPixels = kBatch;

  virtual ~RaySource() = default;
  /// Fills the batch, possibly with nothing: it looks at so many pixels at most; false when none was left.
  virtual bool next(RayBatch& batch) = 0;
};

}  // namespace obliq
