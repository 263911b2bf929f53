#include "terrain/dem/dem_accuracy.h"

#include <gdal_priv.h>

#include <algorithm>
#include <cctype>

#include "terrain/dem/load_report.h"

namespace obliq {
namespace {

// A linear error at 90 % is 1.6449 times the root mean square of a normal distribution.
constexpr double kLidar_m = 0.10;  // USGS Lidar Base Specification, quality level 2: RMSEz at most 0.10 m
constexpr double k3dep13_m =
    0.82;  // J. Stoker, B. Miller, Remote Sensing 14(4), 940, 2022: 3DEP, 1/3 arc-second
constexpr double kNed_m = 1.55;      // D. Gesch, M. Oimoen, G. Evans, USGS Open-File Report 2014-1008: NED
constexpr double kUsgs75_m = 7;      // USGS Standards for Digital Elevation Models, 1998: 7.5-minute, level 1
constexpr double kSrtm_m = 5.5;      // E. Rodriguez et al., PE&RS 72(3), 2006: LE90 of 9.0 m in North America
constexpr double kNasadem_m = 3.66;  // M. A. Aziz et al., Int. J. of Geoinformatics: 7757 GNSS points
constexpr double kAster_m = 8.52;    // ASTER GDEM version 3 validation, USGS 2020
constexpr double kCopernicus_m = 1.56;  // Copernicus DEM Product Handbook, Airbus 2022: LE90 of 2.57 m

struct Named {
  const char* part;  ///< of the file's name, in lower case
  const char* product;
  double rmse_m;
};
constexpr Named kNamed[] = {
    {"nasadem", "NASADEM", kNasadem_m},
    {"srtm", "SRTM", kSrtm_m},
    {"astgtm", "ASTER GDEM", kAster_m},
    {"gdem", "ASTER GDEM", kAster_m},
    {"copernicus", "Copernicus DEM", kCopernicus_m},
    {"cop-dem", "Copernicus DEM", kCopernicus_m},
    {"glo-30", "Copernicus DEM", kCopernicus_m},
    {"glo-90", "Copernicus DEM", kCopernicus_m},
    {"usgs_1m", "3DEP, 1 m", kLidar_m},
    {"usgs_13_", "3DEP, 1/3 arc-second", k3dep13_m},
    {"3dep", "3DEP", k3dep13_m},
    {"usgs_1_", "3DEP, 1 arc-second", kNed_m},
    {"usgs_ned", "NED", kNed_m},
};

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

}  // namespace

DemAccuracy dem_accuracy(const Raster& raster) {
  const std::string name = lower(file_name(raster.path()));
  for (const Named& named : kNamed) {
    if (name.find(named.part) != std::string::npos) return {named.product, named.rmse_m};
  }
  const std::string driver = raster.band().GetDataset()->GetDriverName();
  if (driver == "SRTMHGT") return {"SRTM", kSrtm_m};
  if (driver == "USGSDEM") return {"USGS 7.5-minute DEM", kUsgs75_m};
  // Names that say nothing: what is usual at this posting, of two the better one.
  const double posting_m = raster.posting_m();
  const bool whole = !GDALDataTypeIsFloating(raster.band().GetRasterDataType());
  if (posting_m <= 3) return {"lidar, by its posting", kLidar_m};
  if (posting_m <= 12) return {"3DEP at 1/3 arc-second, by its posting", k3dep13_m};
  if (posting_m <= 120) {
    if (whole) return {"SRTM, by its posting and whole numbers", kSrtm_m};
    return {"NED, by its posting", kNed_m};
  }
  return {"a model of unknown accuracy", 0};
}

}  // namespace obliq
