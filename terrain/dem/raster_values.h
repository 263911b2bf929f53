#pragma once
// The values of a raster's band: how they are stored, and whole rectangles of them.
class GDALRasterBand;
#include <cmath>
#include <limits>
#include <vector>

#include "terrain/dem/raster.h"

namespace obliq {

/// How a band stores its values: its nodata value, scale and offset. Throws InputError where scale or offset
/// is no usable number.
class ValueCoding {
 public:
  explicit ValueCoding(const Raster& raster);

  bool is_nodata(double stored) const {
    // A nodata tag is text, often with fewer digits than the float it means.
    return stored == nodata_ || (single_ && static_cast<float>(stored) == static_cast<float>(nodata_));
  }

  /// NaN: a void.
  double value(double stored) const {
    constexpr double kVoid = std::numeric_limits<double>::quiet_NaN();
    if (!std::isfinite(stored) || is_nodata(stored)) return kVoid;
    return stored * scale_ + offset_;
  }

 private:
  double nodata_ = std::numeric_limits<double>::quiet_NaN();
  double scale_ = 1;
  double offset_ = 0;
  bool single_ = false;
};

/// Throws InputError where a file is cut short and GDAL would not say so. Its raw drivers read past the end
/// of a short file as zeros, and take a short GridFloat file, whose header names no type, for one of bytes.
/// Its text drivers look for a missing row twice as often for each row behind it, which never ends: so the
/// first `rows` are read in order, and the first that is missing is refused.
void require_whole_file(const Raster& raster, int rows);

/// Reads rectangles of a band, as stored; those that a mask band hides are NaN. Nothing is returned unless
/// GDAL read all of it: else throws InputError.
class PixelReader {
 public:
  PixelReader(const Raster& raster, GDALRasterBand& band);

  /// stored[rows][columns] of the rectangle.
  void read(const PixelRect& rect, std::vector<double>& stored);

 private:
  const Raster& raster_;
  GDALRasterBand& band_;
  GDALRasterBand* mask_ = nullptr;
  std::vector<unsigned char> valid_;
};

}  // namespace obliq
