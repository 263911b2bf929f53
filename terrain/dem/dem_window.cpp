#include "terrain/dem/dem_window.h"

#include <fmt/core.h>
#include <gdal_priv.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "terrain/base/stage_clock.h"
#include "terrain/dem/height_unit.h"
#include "terrain/dem/raster.h"
#include "terrain/dem/raster_values.h"

namespace obliq {
namespace {

constexpr double kVoid = std::numeric_limits<double>::quiet_NaN();
constexpr double kLowestGround_m = -9000;    // -32768 and its like without a nodata tag
constexpr double kHighestGround_m = 100000;  // 999999 and its like, also when read as feet

/// Turns one stored value into metres or a void.
class Decoder {
 public:
  Decoder(const Raster& raster, double metres_per_unit) : coding_(raster), metres_(metres_per_unit) {}

  double height_m(double stored) const {
    const double height_m = coding_.value(stored) * metres_;
    return height_m >= kLowestGround_m && height_m <= kHighestGround_m ? height_m : kVoid;
  }

 private:
  ValueCoding coding_;
  double metres_;
};

/// Blocks of step x step pixels that become one post each, counted from the rectangle's corner.
struct Averaging {
  int step = 1;
  PixelRect rect;

  PixelRect pixels(int c0, int r0, int c1, int r1) const {
    return {rect.column0 + c0 * step, rect.row0 + r0 * step, rect.column0 + c1 * step, rect.row0 + r1 * step};
  }

  /// Posts across and down that are read at once: as far down as the file's blocks reach, so that each block
  /// is decoded once, and no wider than memory should hold.
  std::pair<int, int> piece_posts(GDALRasterBand& band, int columns) const {
    constexpr int kUsualRows = 256;
    constexpr int kMostRows = 4096;
    constexpr double kMostValues = 0x1p24;
    int block_columns = 0, block_rows = 0;
    band.GetBlockSize(&block_columns, &block_rows);
    const int narrow = static_cast<int>(kMostValues / columns / step);
    const int rows = std::max(std::min(kUsualRows, narrow), std::min(block_rows, kMostRows));
    const int down = std::max(1, rows / step);
    const double across = kMostValues / down / step / step;
    return {static_cast<int>(std::clamp(across, 1.0, static_cast<double>(columns))), down};
  }

  /// Mean of the block's known heights; a void where fewer than half are known.
  float mean(const std::vector<double>& stored, const PixelRect& piece, int c, int r,
             const Decoder& decoder) const {
    double sum = 0;
    int known = 0;
    for (int k = 0; k < step; ++k) {
      const double* at = stored.data() +
                         static_cast<std::size_t>(r * step + k) * static_cast<std::size_t>(piece.columns()) +
                         static_cast<std::size_t>(c) * static_cast<std::size_t>(step);
      for (int m = 0; m < step; ++m) {
        const double height_m = decoder.height_m(at[m]);
        if (std::isnan(height_m)) continue;
        sum += height_m;
        ++known;
      }
    }
    return static_cast<float>(2 * known >= step * step ? sum / known : kVoid);
  }
};

}  // namespace

double DemWindow::height_at_m(double column, double row, bool between_posts_only) const {
  if (!(column >= -0.5 && row >= -0.5 && column <= raster_columns - 0.5 && row <= raster_rows - 0.5))
    return kVoid;
  const double u = std::clamp((column - column0) / step, 0.0, static_cast<double>(nx - 1));
  const double v = std::clamp((row - row0) / step, 0.0, static_cast<double>(nz - 1));
  if (between_posts_only && (u != (column - column0) / step || v != (row - row0) / step)) return kVoid;
  const int c = std::min(static_cast<int>(u), std::max(0, nx - 2));
  const int r = std::min(static_cast<int>(v), std::max(0, nz - 2));
  const double s = u - c;
  const double t = v - r;
  const float* post = height_m.data() + static_cast<std::size_t>(r) * static_cast<std::size_t>(nx) + c;
  const std::size_t right = nx > 1 ? 1 : 0;
  const std::size_t below = nz > 1 ? static_cast<std::size_t>(nx) : 0;
  // A void post must not spoil a place that lies exactly on a line of known ones: 0 x NaN is NaN.
  const auto mix = [](double a, double b, double share) {
    return share == 0 ? a : share == 1 ? b : a + share * (b - a);
  };
  return mix(mix(static_cast<double>(post[0]), static_cast<double>(post[right]), s),
             mix(static_cast<double>(post[below]), static_cast<double>(post[below + right]), s), t);
}

bool DemWindow::at_raster_edge(int c, int r) const {
  const auto outermost = [this](double at, int n) {
    return at - (step - 1) / 2.0 < 0.5 || at + (step - 1) / 2.0 > n - step - 0.5;
  };
  return outermost(column0 + c * step, raster_columns) || outermost(row0 + r * step, raster_rows);
}

DemWindow::Share DemWindow::share_at(double column, double row) const {
  // Places half-way between the posts of two files must belong to one of them whatever the rounding.
  constexpr double kOwned = 0.501;
  Share share;
  const double u = (column - column0) / step;
  const double v = (row - row0) / step;
  if (!(u > -1 && v > -1 && u < nx && v < nz)) return share;
  const int c0 = static_cast<int>(std::floor(u));
  const int r0 = static_cast<int>(std::floor(v));
  double sum = 0;
  for (int r = std::max(0, r0); r <= std::min(nz - 1, r0 + 1); ++r) {
    for (int c = std::max(0, c0); c <= std::min(nx - 1, c0 + 1); ++c) {
      const double post_m = static_cast<double>(
          height_m[static_cast<std::size_t>(r) * static_cast<std::size_t>(nx) + static_cast<std::size_t>(c)]);
      if (std::isnan(post_m)) continue;
      const double du = std::abs(u - c);
      const double dv = std::abs(v - r);
      share.weight += (1 - du) * (1 - dv);
      sum += (1 - du) * (1 - dv) * post_m;
      share.owned = share.owned || (du <= kOwned && dv <= kOwned);
    }
  }
  if (share.weight > 0) share.height_m = sum / share.weight;
  return share;
}

DemWindow read_window(const Raster& raster, const PixelRect& rect, int step,
                      const std::optional<VerticalUnit>& unit, const Progress& progress, PostSample* sample) {
  const StageProbe probe(Stage::load);
  const Decoder decoder(raster, height_unit(raster, unit).metres);
  require_whole_file(raster, rect.row1);
  const int whole_step = std::max(1, std::min({step, rect.columns(), rect.rows()}));
  const RasterLevel level = level_to_read(raster, rect, whole_step);
  if (level.factor > 1) sample = nullptr;  // an overview's pixels are none of the raster's own posts
  const Averaging averaging{std::max(1, whole_step / level.factor), level.rect};
  DemWindow window;
  window.step = averaging.step * level.factor;
  window.nx = averaging.rect.columns() / averaging.step;
  window.nz = averaging.rect.rows() / averaging.step;
  window.column0 = averaging.rect.column0 * level.factor + (window.step - 1) / 2.0;
  window.row0 = averaging.rect.row0 * level.factor + (window.step - 1) / 2.0;
  window.raster_columns = raster.columns();
  window.raster_rows = raster.rows();
  window.height_m.resize(static_cast<std::size_t>(window.nx) * static_cast<std::size_t>(window.nz));

  PixelReader reader(raster, *level.band);
  std::vector<double> stored;
  const bool real = GDALDataTypeIsFloating(level.band->GetRasterDataType());
  std::size_t values = 0, fractions = 0;
  const auto [across, down] = averaging.piece_posts(*level.band, window.nx);
  for (int r0 = 0; r0 < window.nz; r0 += down) {
    const int r1 = std::min(window.nz, r0 + down);
    for (int c0 = 0; c0 < window.nx; c0 += across) {
      const int c1 = std::min(window.nx, c0 + across);
      const PixelRect piece = averaging.pixels(c0, r0, c1, r1);
      reader.read(piece, stored);
      if (real) {
        values += stored.size();
        fractions += static_cast<std::size_t>(
            std::ranges::count_if(stored, [](double value) { return value != std::floor(value); }));
      }
      if (sample) {
        sample->take(piece, [&](int row, int column) {
          return decoder.height_m(
              stored[static_cast<std::size_t>(row) * static_cast<std::size_t>(piece.columns()) +
                     static_cast<std::size_t>(column)]);
        });
      }
      for (int r = r0; r < r1; ++r) {
        float* to =
            window.height_m.data() + static_cast<std::size_t>(r) * static_cast<std::size_t>(window.nx);
        for (int c = c0; c < c1; ++c) to[c] = averaging.mean(stored, piece, c - c0, r - r0, decoder);
      }
      if (progress) progress("elevation", (r0 + static_cast<double>(r1 - r0) * c1 / window.nx) / window.nz);
    }
  }
  // A file of floats may have been made of whole numbers, but for a few filled posts.
  window.has_fractions = static_cast<double>(fractions) > 0.01 * static_cast<double>(values);
  return window;
}

}  // namespace obliq
