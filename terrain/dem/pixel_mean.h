#pragma once
#include <array>
#include <glm/vec2.hpp>
#include <vector>

#include "terrain/dem/raster.h"

namespace obliq {

/// A rectangle of a raster's pixels as float32 values, NaN where there is none.
struct PixelValues {
  PixelRect rect;
  std::vector<float> value;  ///< [rows][columns]
};

/// What lies under a quadrilateral.
struct PixelMean {
  double mean = 0;   ///< of the values, by area; 0 where there is none
  double share = 0;  ///< of the quadrilateral's area that has a value, 0 to 1
};

/// The mean of the pixels that a simple quadrilateral covers, each by the area of it that is covered: exact,
/// whether pixels are finer or coarser, and however it is turned. Corners in order, in post coordinates
/// (Raster): pixel (c, r) reaches half a post from there to every side. Pixels outside the rectangle count as
/// voids.
PixelMean mean_under(const std::array<glm::dvec2, 4>& corners, const PixelValues& pixels);

}  // namespace obliq
