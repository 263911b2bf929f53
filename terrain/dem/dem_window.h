#pragma once
// Heights read from a raster: one window of it, in metres, averaged when the scene is coarser.
#include <optional>
#include <vector>

#include "terrain/base/parallel.h"
#include "terrain/dem/post_sample.h"
#include "terrain/dem/raster.h"
#include "terrain/world_spec.h"

namespace obliq {

/// Posts of one window. Post (c, r) of the window stands at column column0 + c step, row row0 + r step of
/// the raster's post coordinates. NaN where the raster knows no height.
struct DemWindow {
  double column0 = 0;
  double row0 = 0;
  int step = 1;  ///< raster posts per window post
  int nx = 0;
  int nz = 0;
  int raster_columns = 0;
  int raster_rows = 0;
  std::vector<float> height_m;  ///< [nz][nx]
  bool has_fractions = false;   ///< the raster holds more than whole numbers of its unit

  /// Bilinear between the four posts around a place in raster post coordinates. The outer half pixel, which
  /// belongs to the raster but has posts on one side only, takes the nearest post's height, or none when only
  /// places between posts are asked for. NaN when a post that carries weight is void or the place is outside.
  double height_at_m(double column, double row, bool between_posts_only) const;

  /// Whether a post of the window stands for the raster's outermost.
  bool at_raster_edge(int c, int r) const;

  /// What the window's valid posts around a place say of it, up to one posting beyond the window.
  struct Share {
    double height_m = 0;  ///< mean of the valid posts, weighted as bilinear interpolation weights them
    double weight = 0;    ///< sum of those weights: 1 when all four are valid, 0 when none is
    bool owned = false;   ///< a valid post stands within half a posting
  };
  Share share_at(double column, double row) const;
};

/// Reads the window, each block of step x step pixels averaged to one post (void when more than half of its
/// pixels are). Void are nodata, masked, not finite, and what no land on earth can be (below -9 km, above
/// 100 km). Throws InputError when anything cannot be read: never zeros for missing data. Where that is more
/// pixels than raster_level.h allows, an overview's are read. `sample`, when given, keeps some of the
/// raster's own posts, where it is these that are read.
DemWindow read_window(const Raster& raster, const PixelRect& rect, int step,
                      const std::optional<VerticalUnit>& unit, const Progress& progress,
                      PostSample* sample = nullptr);

}  // namespace obliq
