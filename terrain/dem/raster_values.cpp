#include "terrain/dem/raster_values.h"

#include <fmt/core.h>
#include <gdal_priv.h>

#include <memory>
#include <string>

#include "terrain/dem/gdal_messages.h"

namespace obliq {
namespace {

bool read_band(GDALRasterBand& band, const PixelRect& r, void* to, GDALDataType type) {
  return band.RasterIO(GF_Read, r.column0, r.row0, r.columns(), r.rows(), to, r.columns(), r.rows(), type, 0,
                       0, nullptr) == CE_None;
}

/// Drivers that find a row behind the one before it.
constexpr const char* const kTextGrids[] = {"AAIGrid", "GRASSASCIIGrid", "ISG", nullptr};

/// The rows stay in GDAL's cache, where their values are read next.
void read_in_order(const Raster& raster, GDALDataset& dataset, int rows) {
  const GdalMessages messages;
  GDALRasterBand& band = *dataset.GetRasterBand(1);
  for (int row = 0; row < rows; ++row) {
    GDALRasterBlock* const block = band.GetLockedBlockRef(0, row);
    if (block != nullptr) block->DropLock();
    if (block == nullptr || !messages.failure().empty())
      raster.refuse(fmt::format("row {} cannot be read: {}", row,
                                messages.reason_without(raster.path(), "the file is cut short")),
                    "a whole, readable raster");
  }
}

void require_all_bytes(const Raster& raster, GDALDataset& dataset) {
  const GDALDataType type = raster.band().GetRasterDataType();
  if (EQUAL(CPLGetExtension(raster.path().c_str()), "flt") && type != GDT_Float32)
    raster.refuse("it is truncated: a GridFloat file holds 4 bytes a post", "a whole file");
  VSIStatBufL status;
  if (VSIStatL(raster.path().c_str(), &status) != 0) return;
  const double needed = static_cast<double>(raster.columns()) * raster.rows() * dataset.GetRasterCount() *
                        GDALGetDataTypeSizeBits(type) / 8;
  if (static_cast<double>(status.st_size) < needed)
    raster.refuse(
        fmt::format("it is truncated: {} of {} bytes", status.st_size, static_cast<long long>(needed)),
        "a whole file");
}

}  // namespace

ValueCoding::ValueCoding(const Raster& raster) {
  GDALRasterBand& band = raster.band();
  int has = 0;
  const double nodata = band.GetNoDataValue(&has);
  if (has) nodata_ = nodata;
  single_ = band.GetRasterDataType() == GDT_Float32;
  const double scale = band.GetScale(&has);
  if (has) scale_ = scale;
  const double offset = band.GetOffset(&has);
  if (has) offset_ = offset;
  if (!std::isfinite(scale_) || scale_ == 0 || !std::isfinite(offset_))
    raster.refuse(fmt::format("its band has a scale of {} and an offset of {}", scale_, offset_),
                  "finite numbers and a scale other than 0");
}

void require_whole_file(const Raster& raster, int rows) {
  GDALDataset& dataset = *raster.band().GetDataset();
  const std::string driver = dataset.GetDriverName();
  if (CSLFindString(kTextGrids, driver.c_str()) >= 0) {
    read_in_order(raster, dataset, rows);
  } else if (driver == "VRT") {
    for (const std::string& name : raster.files()) {
      const GdalMessages quiet;
      const std::unique_ptr<GDALDataset> part(GDALDataset::Open(name.c_str(), GDAL_OF_RASTER, kTextGrids));
      if (part) read_in_order(raster, *part, part->GetRasterYSize());
    }
  } else if (driver == "EHdr" || driver == "ENVI") {
    require_all_bytes(raster, dataset);
  }
}

PixelReader::PixelReader(const Raster& raster, GDALRasterBand& band) : raster_(raster), band_(band) {
  const int flags = band.GetMaskFlags();
  if ((flags & (GMF_ALL_VALID | GMF_NODATA)) == 0) mask_ = band.GetMaskBand();
}

void PixelReader::read(const PixelRect& rect, std::vector<double>& stored) {
  GdalMessages messages;
  const std::size_t n = static_cast<std::size_t>(rect.columns()) * static_cast<std::size_t>(rect.rows());
  stored.resize(n);
  bool ok = read_band(band_, rect, stored.data(), GDT_Float64);
  if (ok && mask_) {
    valid_.resize(n);
    ok = read_band(*mask_, rect, valid_.data(), GDT_Byte);
    for (std::size_t i = 0; ok && i < n; ++i)
      if (valid_[i] == 0) stored[i] = std::numeric_limits<double>::quiet_NaN();
  }
  if (!ok || !messages.failure().empty())
    raster_.refuse(fmt::format("rows {} to {} cannot be read: {}", rect.row0, rect.row1 - 1,
                               messages.reason_without(raster_.path(), "the file is damaged or cut short")),
                   "a whole, readable raster");
}

}  // namespace obliq
