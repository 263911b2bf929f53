#include "server/output/ground_map_tif.h"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <cstdio>
#include <memory>
#include <mutex>

#include "terrain/errors.h"

namespace obliq {
namespace {

/// Keeps GDAL's messages off the terminal; they come back in our own error.
struct QuietErrors {
  QuietErrors() { CPLPushErrorHandler(CPLQuietErrorHandler); }
  ~QuietErrors() { CPLPopErrorHandler(); }
  QuietErrors(const QuietErrors&) = delete;
  QuietErrors& operator=(const QuietErrors&) = delete;
};

struct Closer {
  void operator()(GDALDataset* dataset) const { GDALClose(dataset); }
};

}  // namespace

void write_ground_map_tif(const std::filesystem::path& path, const GroundMap& map, double latitude_deg,
                          double longitude_deg) {
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
  char definition[256];
  std::snprintf(definition, sizeof definition,
                "+proj=aeqd +lat_0=%.12f +lon_0=%.12f +datum=WGS84 +units=m +no_defs", latitude_deg,
                longitude_deg);
  OGRSpatialReference crs;
  if (crs.importFromProj4(definition) != OGRERR_NONE) fail();
  double transform[6] = {map.left_m, map.pixel_m, 0, map.top_m, 0, -map.pixel_m};
  if (file->SetSpatialRef(&crs) != CE_None || file->SetGeoTransform(transform) != CE_None) fail();
  file->GetRasterBand(1)->SetDescription(
      ((map.of_power ? "power, dB re " : "magnitude, dB re ") + map.unit).c_str());
  file->GetRasterBand(2)->SetDescription(
      "state: 0 not sampled, 1 sampled, 2 shadow, 3 no known surface, 4 no ground at this range, 254 not "
      "known, 255 outside");
  if (file->GetRasterBand(1)->SetNoDataValue(static_cast<double>(GroundMap::kNoValue)) != CE_None) fail();
  auto* magnitude = const_cast<float*>(map.magnitude_db.data());
  auto* state = const_cast<std::uint8_t*>(map.state.data());
  if (file->GetRasterBand(1)->RasterIO(GF_Write, 0, 0, map.width, map.height, magnitude, map.width,
                                       map.height, GDT_Float32, 0, 0) != CE_None ||
      file->GetRasterBand(2)->RasterIO(GF_Write, 0, 0, map.width, map.height, state, map.width, map.height,
                                       GDT_Byte, 0, 0) != CE_None)
    fail();
  file->FlushCache();
  file.reset();
  if (CPLGetLastErrorType() >= CE_Failure) fail();
}

}  // namespace obliq
