#include "terrain/dem/raster_level.h"

#include <fmt/core.h>
#include <gdal_priv.h>

#include <algorithm>
#include <cmath>

namespace obliq {
namespace {

double pixels(const PixelRect& rect) { return static_cast<double>(rect.columns()) * rect.rows(); }

/// The rectangle in the pixels of a level of which one stands for factor x factor.
PixelRect in_level(const PixelRect& rect, int factor, int columns, int rows) {
  const auto up = [factor](int at) { return at / factor + (at % factor != 0 ? 1 : 0); };
  return {rect.column0 / factor, rect.row0 / factor, std::min(columns, up(rect.column1)),
          std::min(rows, up(rect.row1))};
}

void require_usual_blocks(const Raster& raster, GDALRasterBand& band) {
  int columns = 0, rows = 0;
  band.GetBlockSize(&columns, &rows);
  const double bytes =
      static_cast<double>(columns) * rows * GDALGetDataTypeSizeBytes(band.GetRasterDataType());
  if (bytes <= kMostBlock_bytes) return;
  raster.refuse(fmt::format("its blocks are {} x {} pixels", columns, rows),
                "blocks of at most 2 GB, so write it in tiles (gdal_translate -co TILED=YES)");
}

}  // namespace

RasterLevel level_to_read(const Raster& raster, const PixelRect& rect, int step) {
  RasterLevel level{&raster.band(), 1, rect};
  for (int n = 0; pixels(level.rect) > kMostPixels && n < raster.band().GetOverviewCount(); ++n) {
    GDALRasterBand* overview = raster.band().GetOverview(n);
    if (overview == nullptr || overview->GetXSize() < 1 || overview->GetYSize() < 1) continue;
    const int factor =
        static_cast<int>(std::lround(static_cast<double>(raster.columns()) / overview->GetXSize()));
    if (factor <= 1 || factor > step) continue;
    const PixelRect own = in_level(rect, factor, overview->GetXSize(), overview->GetYSize());
    if (!own.empty() && pixels(own) <= kMostPixels) level = {overview, factor, own};
  }
  if (pixels(level.rect) > kMostPixels) {
    const std::string found =
        fmt::format("the loaded area has {:.3g} of its pixels, {} x {} to a post", pixels(rect), step, step);
    raster.refuse(found,
                  "2.1e+09 of one file; give it overviews (gdaladdo -r average), or choose a smaller "
                  "[terrain] area or a shorter range");
  }
  require_usual_blocks(raster, *level.band);
  return level;
}

}  // namespace obliq
