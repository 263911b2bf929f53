#pragma once
// Which of a raster's resolutions is read, and how much of it may be.
#include "terrain/dem/raster.h"

namespace obliq {

/// A raster's own pixels, or those of one of its overviews.
struct RasterLevel {
  GDALRasterBand* band = nullptr;
  int factor = 1;  ///< pixels of the raster per pixel of the level, along a side
  PixelRect rect;  ///< what is wanted, in the level's own pixels
};

/// So many pixels of one file take about a minute.
constexpr double kMostPixels = 0x1p31;

/// What a compressed block takes in memory at once.
constexpr double kMostBlock_bytes = 0x1p31;

/// The finest level of which `rect`, a rectangle of the raster's pixels, has at most kMostPixels: the raster
/// itself nearly always. No coarser one than `step`, the side in pixels of what becomes one post. Throws
/// InputError when there is none, or when blocks are larger than kMostBlock_bytes.
RasterLevel level_to_read(const Raster& raster, const PixelRect& rect, int step);

}  // namespace obliq
