#include <cpl_conv.h>
#include <cpl_error.h>
#include <fmt/core.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <memory>
#include <mutex>
#include <vector>

#include "proto/obliq.pb.h"
#include "server/output/ground_map.h"
#include "terrain/base/errors.h"

namespace obliq {
namespace {

/// Keeps GDAL's messages off the terminal; they come back in our own error.
struct QuietErrors {
  QuietErrors() { CPLPushErrorHandler(CPLQuietErrorHandler); }
  ~QuietErrors() { CPLPopErrorHandler(); }
  QuietErrors(const QuietErrors&) = delete;
  QuietErrors& operator=(const QuietErrors&) = delete;
};

constexpr std::uint8_t kOutside = 255;

struct Closer {
  void operator()(GDALDataset* dataset) const { GDALClose(dataset); }
};

}  // namespace

void write_ground_map_tif(const std::filesystem::path& path, const GroundMap& map, const BinBlock& bins,
                          const BinLevels& levels, const wire::FrameDescriptor& descriptor,
                          const std::string& placed) {
  static std::once_flag registered;
  std::call_once(registered, GDALAllRegister);
  const auto fail = [&] {
    const std::string reason = CPLGetLastErrorMsg();
    throw InputError(path.string() + ": cannot be written (" +
                     (reason.empty() ? "GDAL gave no reason" : reason) + ")");
  };
  CPLErrorReset();
  const QuietErrors quiet;
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GTiff");
  if (!driver) throw InputError("GDAL on this machine has no GeoTIFF driver");
  char compress[] = "COMPRESS=DEFLATE";
  char tiled[] = "TILED=YES";
  char* options[] = {compress, tiled, nullptr};
  std::unique_ptr<GDALDataset, Closer> file(
      driver->Create(path.c_str(), map.width, map.height, 2, GDT_Float32, options));
  if (!file) fail();
  const std::string definition =
      fmt::format("+proj=aeqd +lat_0={:.12f} +lon_0={:.12f} +datum=WGS84 +units=m +no_defs",
                  descriptor.pose().latitude_deg(), descriptor.pose().longitude_deg());
  OGRSpatialReference crs;
  if (crs.importFromProj4(definition.c_str()) != OGRERR_NONE) fail();
  double transform[6] = {map.left_m, map.pixel_m, 0, map.top_m, 0, -map.pixel_m};
  if (file->SetSpatialRef(&crs) != CE_None || file->SetGeoTransform(transform) != CE_None) fail();
  file->SetMetadataItem("TIFFTAG_IMAGEDESCRIPTION", placed.c_str());
  file->GetRasterBand(1)->SetDescription(
      ((levels.of_power ? "power, dB re " : "magnitude, dB re ") + levels.unit).c_str());
  file->GetRasterBand(2)->SetDescription(
      "state: 0 not sampled, 1 sampled, 2 shadow, 3 no known surface, 4 no ground at this range, 254 not "
      "known, 255 outside");
  if (file->GetRasterBand(1)->SetNoDataValue(static_cast<double>(BinLevels::kNoValue)) != CE_None) fail();
  std::vector<float> magnitude(map.bin.size(), BinLevels::kNoValue);
  std::vector<std::uint8_t> state(map.bin.size(), kOutside);
  for (std::size_t pixel = 0; pixel < map.bin.size(); ++pixel) {
    if (map.is_bin(pixel)) {
      magnitude[pixel] = levels.db[map.bin[pixel]];
      state[pixel] = state_of(bins, levels, map.bin[pixel]);
    } else if (map.bin[pixel] == GroundMap::kNoGround) {
      state[pixel] = static_cast<std::uint8_t>(BinState::no_surface);
    }
  }
  if (file->GetRasterBand(1)->RasterIO(GF_Write, 0, 0, map.width, map.height, magnitude.data(), map.width,
                                       map.height, GDT_Float32, 0, 0) != CE_None ||
      file->GetRasterBand(2)->RasterIO(GF_Write, 0, 0, map.width, map.height, state.data(), map.width,
                                       map.height, GDT_Byte, 0, 0) != CE_None)
    fail();
  file->FlushCache();
  file.reset();
  if (CPLGetLastErrorType() >= CE_Failure) fail();
}

}  // namespace obliq
