#pragma once
// A georeferenced raster that GDAL can open: where its posts are, without its values.
class GDALDataset;
class GDALRasterBand;
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "terrain/dem/projection.h"
#include "terrain/world_spec.h"

namespace obliq {

/// Rectangle of pixels [column0, column1) x [row0, row1).
struct PixelRect {
  int column0 = 0, row0 = 0, column1 = 0, row1 = 0;

  bool empty() const { return column0 >= column1 || row0 >= row1; }
  int columns() const { return column1 - column0; }
  int rows() const { return row1 - row0; }
};

/// An open raster, its first band and its georeference. Post coordinates count posts: post (c, r) is the
/// centre of pixel (c, r), whether the file calls its pixels areas or points: GDAL moves the origin of
/// point rasters by half a pixel, so its geotransform always speaks of pixel corners. Rotated and south-up
/// geotransforms are ordinary. One thread at a time.
class Raster {
 public:
  /// field is the configuration key for messages; crs is used when the file carries none. Throws InputError.
  Raster(const std::string& path, const std::string& field, const std::optional<std::string>& crs);
  ~Raster();
  Raster(Raster&&) noexcept;
  Raster& operator=(Raster&&) noexcept;

  const std::string& path() const { return path_; }
  const std::string& field() const { return field_; }
  int columns() const { return columns_; }
  int rows() const { return rows_; }
  GDALRasterBand& band() const;
  /// Every file that its heights, its place and its tags come from; empty when GDAL cannot say. Virtual
  /// rasters' sources are among them.
  std::vector<std::string> files() const;
  /// "FIELD: found PATH: what; allowed: allowed".
  [[noreturn]] void refuse(const std::string& what, const std::string& allowed) const;

  /// In place: longitude and latitude in degrees to post coordinates; infinite where there is no image.
  void posts_from_lonlat(std::vector<double>& lon_column, std::vector<double>& lat_row) const;
  /// In place: post coordinates to longitude and latitude in degrees.
  void lonlat_from_posts(std::vector<double>& column_lon, std::vector<double>& row_lat) const;

  /// Columns per turn of the earth when the raster is in longitude and latitude and unrotated, else 0.
  double turn_columns() const;

  /// Points along the raster's outer edge, longitude and latitude in degrees.
  const std::vector<LonLat>& edge() const { return edge_; }
  /// Distance between posts in metres at the raster's centre: the root of one pixel's area.
  double posting_m() const { return posting_m_; }

 private:
  void open();
  void place(const std::optional<std::string>& crs);
  void measure();

  struct Close {
    void operator()(GDALDataset* dataset) const;
  };
  std::string path_;
  std::string field_;
  std::unique_ptr<GDALDataset, Close> dataset_;
  std::optional<Projection> projection_;
  std::array<double, 6> world_from_pixel_{};
  std::array<double, 6> pixel_from_world_{};
  std::string doubt_;  ///< what GDAL complained of while it opened the file all the same
  int columns_ = 0;
  int rows_ = 0;
  double posting_m_ = 0;
  std::vector<LonLat> edge_;
};

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
