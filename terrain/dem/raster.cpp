#include "terrain/dem/raster.h"

#include <fmt/core.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <GeographicLib/Geodesic.hpp>
#include <algorithm>
#include <cmath>

#include "terrain/base/errors.h"
#include "terrain/base/files.h"
#include "terrain/dem/gdal_messages.h"

namespace obliq {

namespace {

constexpr int kEdgePoints = 64;  ///< along each side: a curved side is followed to 1/4096 of its sagitta

std::unique_ptr<GDALDataset> opened(const std::string& path, unsigned kind) {
  return std::unique_ptr<GDALDataset>(
      GDALDataset::Open(path.c_str(), kind | GDAL_OF_READONLY | GDAL_OF_VERBOSE_ERROR));
}

/// A coordinate system is what its text says, not what is in a file or at an address of that name.
constexpr const char* const kTextOnly[] = {"ALLOW_NETWORK_ACCESS=NO", "ALLOW_FILE_ACCESS=NO", nullptr};

/// GDAL names the sources of a virtual raster, but not what these are made of in turn.
void append_files(GDALDataset& dataset, int depth, std::vector<std::string>& found) {
  constexpr int kDeepest = 8;
  char** names = dataset.GetFileList();
  for (char** name = names; name != nullptr && *name != nullptr; ++name) {
    if (std::ranges::find(found, *name) != found.end()) continue;
    found.emplace_back(*name);
    if (depth == kDeepest || !EQUAL(CPLGetExtension(*name), "vrt") || EQUAL(*name, dataset.GetDescription()))
      continue;
    if (const auto inner = opened(*name, GDAL_OF_RASTER)) append_files(*inner, depth + 1, found);
  }
  CSLDestroy(names);
}

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

void Raster::Close::operator()(GDALDataset* dataset) const {
  const GdalMessages quiet;
  GDALClose(dataset);
}

Raster::~Raster() = default;
Raster::Raster(Raster&&) noexcept = default;
Raster& Raster::operator=(Raster&&) noexcept = default;

Raster::Raster(const std::string& path, const std::string& field, const std::optional<std::string>& crs)
    : path_(path), field_(field) {
  open();
  place(crs);
  measure();
}

void Raster::refuse(const std::string& what, const std::string& allowed) const {
  throw InputError(fmt::format("{}: found {}: {}; allowed: {}", field_,
                               path_.empty() ? "an empty name" : path_, what, allowed));
}

std::vector<std::string> Raster::files() const {
  const GdalMessages quiet;
  std::vector<std::string> found;
  append_files(*dataset_, 0, found);
  return found;
}

GDALRasterBand& Raster::band() const { return *dataset_->GetRasterBand(1); }

void Raster::open() {
  refuse_endless_file(field_ + ": " + path_, path_);
  GdalMessages messages;
  dataset_.reset(opened(path_, GDAL_OF_RASTER).release());
  if (!dataset_) {
    const std::string reason = messages.reason_without(path_, "it cannot be opened");
    if (opened(path_, GDAL_OF_VECTOR)) refuse("it holds vectors only", "a raster");
    refuse(reason, "a raster that GDAL can open");
  }
  if (dataset_->GetRasterCount() == 0) {
    CSLConstList parts = dataset_->GetMetadata("SUBDATASETS");
    const char* first = parts ? CSLFetchNameValue(parts, "SUBDATASET_1_NAME") : nullptr;
    refuse("it has no raster band", first ? std::string("one of its parts, such as ") + first
                                          : std::string("a raster of at least one band"));
  }
  if (GDALDataTypeIsComplex(band().GetRasterDataType()))
    refuse("its first band holds complex numbers", "a band of real numbers");
  doubt_ = messages.failure();
  columns_ = dataset_->GetRasterXSize();
  rows_ = dataset_->GetRasterYSize();
}

void Raster::place(const std::optional<std::string>& crs) {
  GdalMessages messages;
  if (dataset_->GetGeoTransform(world_from_pixel_.data()) != CE_None ||
      !GDALInvGeoTransform(world_from_pixel_.data(), pixel_from_world_.data()))
    refuse("it does not say where its pixels are (" + (doubt_.empty() ? "no geotransform" : doubt_) + ")",
           "a georeferenced raster");
  for (double v : pixel_from_world_) {
    if (!std::isfinite(v)) refuse("its geotransform is not finite", "a georeferenced raster");
  }
  OGRSpatialReference system;
  if (const OGRSpatialReference* own = dataset_->GetSpatialRef(); own && !own->IsEmpty()) {
    system = *own;
  } else if (!crs) {
    refuse("it carries no coordinate system", field_.starts_with("[terrain]")
                                                  ? "a raster with one, or name it in [terrain] crs"
                                                  : "a raster with one (gdal_edit.py -a_srs EPSG:CODE)");
  } else if (system.SetFromUserInput(crs->c_str(), kTextOnly) != OGRERR_NONE) {
    throw InputError(
        fmt::format("[terrain] crs: found \"{}\" ({}); allowed: any coordinate system that GDAL knows, such "
                    "as \"EPSG:26911\"",
                    *crs, messages.reason("not understood")));
  }
  projection_.emplace(system, field_, path_);
}

void Raster::measure() {
  std::vector<double> x, y;
  for (int k = 0; k < kEdgePoints; ++k) {
    const double t = static_cast<double>(k) / kEdgePoints;
    // The outer edge, half a pixel outside the posts, once around.
    for (const auto& [u, v] : {std::pair{t, 0.0}, {1.0, t}, {1 - t, 1.0}, {0.0, 1 - t}}) {
      x.push_back(u * columns_ - 0.5);
      y.push_back(v * rows_ - 0.5);
    }
  }
  const double c = (columns_ - 1) / 2.0;
  const double r = (rows_ - 1) / 2.0;
  x.insert(x.end(), {c - 0.5, c + 0.5, c, c});
  y.insert(y.end(), {r, r, r - 0.5, r + 0.5});
  lonlat_from_posts(x, y);
  const std::size_t m = x.size() - 4;
  const GeographicLib::Geodesic& earth = GeographicLib::Geodesic::WGS84();
  double across_m = 0, down_m = 0;
  for (std::size_t i = m; i < x.size(); ++i) {
    if (!std::isfinite(x[i]) || !(std::abs(y[i]) <= 90))
      refuse("its centre is not a place on the earth",
             "a raster whose coordinates fit its coordinate system");
  }
  earth.Inverse(y[m], x[m], y[m + 1], x[m + 1], across_m);
  earth.Inverse(y[m + 2], x[m + 2], y[m + 3], x[m + 3], down_m);
  posting_m_ = std::sqrt(across_m * down_m);
  if (!(posting_m_ > 0)) refuse("its pixels have no size", "a georeferenced raster");
  for (std::size_t i = 0; i < m; ++i) {
    if (std::isfinite(x[i]) && std::abs(y[i]) <= 90) edge_.push_back({x[i], y[i]});
  }
}

void Raster::posts_from_lonlat(std::vector<double>& lon_column, std::vector<double>& lat_row) const {
  projection_->forward(lon_column, lat_row);
  const auto& g = pixel_from_world_;
  for (std::size_t i = 0; i < lon_column.size(); ++i) {
    const double x = lon_column[i];
    const double y = lat_row[i];
    if (!std::isfinite(x) || !std::isfinite(y)) continue;
    lon_column[i] = g[0] + g[1] * x + g[2] * y - 0.5;
    lat_row[i] = g[3] + g[4] * x + g[5] * y - 0.5;
  }
}

void Raster::lonlat_from_posts(std::vector<double>& column_lon, std::vector<double>& row_lat) const {
  const auto& g = world_from_pixel_;
  for (std::size_t i = 0; i < column_lon.size(); ++i) {
    const double c = column_lon[i] + 0.5;
    const double r = row_lat[i] + 0.5;
    column_lon[i] = g[0] + g[1] * c + g[2] * r;
    row_lat[i] = g[3] + g[4] * c + g[5] * r;
  }
  projection_->inverse(column_lon, row_lat);
}

double Raster::turn_columns() const {
  if (pixel_from_world_[2] != 0 || pixel_from_world_[4] != 0) return 0;
  return projection_->turn() * pixel_from_world_[1];
}

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
