#include "tests/unit/terrain_files.h"

#include <gdal_priv.h>
#include <ogr_spatialref.h>
#include <unistd.h>

#include <atomic>
#include <fstream>
#include <memory>
#include <numbers>
#include <stdexcept>

#include "terrain/base/errors.h"
#include "terrain/dem/gdal_messages.h"

namespace obliq::test {

Folder::Folder() {
  static std::atomic<int> count{0};
  path_ = std::filesystem::temp_directory_path() /
          ("obliq_terrain_" + std::to_string(getpid()) + "_" + std::to_string(count++));
  std::filesystem::create_directories(path_);
}

Folder::~Folder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::string Folder::text(const std::string& name, const std::string& content) const {
  std::ofstream(file(name), std::ios::binary) << content;
  return file(name);
}

RasterPlan around(double longitude_deg, double latitude_deg, std::function<double(double, double)> value) {
  RasterPlan plan;
  const double pixel = 1.0 / 1200;
  plan.geotransform = {longitude_deg - 30.5 * pixel, pixel, 0, latitude_deg + 30.5 * pixel, 0, -pixel};
  plan.value = std::move(value);
  return plan;
}

std::string write_raster(const Folder& folder, const std::string& name, const RasterPlan& plan) {
  const GdalMessages quiet;  // GDAL looks into a file that it is to replace
  char** options = nullptr;
  for (const std::string& option : plan.options) options = CSLAddString(options, option.c_str());
  // Built in memory and copied, since some drivers cannot be filled pixel by pixel.
  GDALDriver* memory = GetGDALDriverManager()->GetDriverByName("MEM");
  std::unique_ptr<GDALDataset> data(
      memory->Create("", plan.columns, plan.rows, 1, GDALGetDataTypeByName(plan.type.c_str()), nullptr));
  std::array<double, 6> g = plan.geotransform;
  data->SetGeoTransform(g.data());
  if (!plan.crs.empty()) {
    OGRSpatialReference crs;
    crs.SetFromUserInput(plan.crs.c_str());
    crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    data->SetSpatialRef(&crs);
  }
  GDALRasterBand* band = data->GetRasterBand(1);
  std::vector<double> line(static_cast<std::size_t>(plan.columns));
  for (int r = 0; r < plan.rows; ++r) {
    for (int c = 0; c < plan.columns; ++c) {
      const double x = g[0] + (c + 0.5) * g[1] + (r + 0.5) * g[2];
      const double y = g[3] + (c + 0.5) * g[4] + (r + 0.5) * g[5];
      line[static_cast<std::size_t>(c)] = plan.value(x, y);
    }
    if (band->RasterIO(GF_Write, 0, r, plan.columns, 1, line.data(), plan.columns, 1, GDT_Float64, 0, 0,
                       nullptr) != CE_None) {
      throw std::runtime_error("cannot fill a test raster");
    }
  }
  if (plan.nodata) band->SetNoDataValue(*plan.nodata);
  if (!plan.unit.empty()) band->SetUnitType(plan.unit.c_str());
  if (plan.scale != 1) band->SetScale(plan.scale);
  if (plan.offset != 0) band->SetOffset(plan.offset);
  if (plan.point) data->SetMetadataItem("AREA_OR_POINT", "Point");
  if (plan.masked) {
    data->CreateMaskBand(GMF_PER_DATASET);
    std::vector<unsigned char> mask;
    for (int r = 0; r < plan.rows; ++r) {
      for (int c = 0; c < plan.columns; ++c) mask.push_back(plan.masked(c, r) ? 0 : 255);
    }
    if (band->GetMaskBand()->RasterIO(GF_Write, 0, 0, plan.columns, plan.rows, mask.data(), plan.columns,
                                      plan.rows, GDT_Byte, 0, 0, nullptr) != CE_None) {
      throw std::runtime_error("cannot fill a test mask");
    }
  }
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName(plan.driver.c_str());
  std::unique_ptr<GDALDataset> copy(
      driver->CreateCopy(folder.file(name).c_str(), data.get(), 0, options, nullptr, nullptr));
  CSLDestroy(options);
  if (!copy) throw std::runtime_error("cannot write a test raster");
  return folder.file(name);
}

WorldSpec scene(double longitude_deg, double latitude_deg, double reach_m, std::vector<std::string> dem) {
  WorldSpec spec;
  spec.terrain.dem = std::move(dem);
  spec.radius_factor = std::numeric_limits<double>::infinity();
  spec.origin = {longitude_deg, latitude_deg};
  spec.reaches = {{spec.origin, reach_m}};
  return spec;
}

std::string error_of(const WorldSpec& spec) {
  try {
    load_world(spec);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

namespace {

/// The same heights, as deploy/fetch-demo-terrain.sh keeps them, with its argument.
struct Fetched {
  const char* name;
  const char* tile;
  const char* command;
};
constexpr Fetched kFetched[] = {
    {"nm_ned13_10m/USGS_NED_13_n37w108_Clipped.tif", "new_mexico_ned13.tif", "deploy/fetch-demo-terrain.sh"},
    {"la_nasadem_30m/NASADEM_HGT_n34w119.tif", "san_gabriel_nasadem.tif",
     "deploy/fetch-demo-terrain.sh mountains"}};

std::filesystem::path fetched_folder() {
  if (const char* given = std::getenv("OBLIQ_CACHE")) return given;
  if (const char* given = std::getenv("XDG_CACHE_HOME")) return std::filesystem::path(given) / "obliq";
  const char* home = std::getenv("HOME");
  return std::filesystem::path(home ? home : "/var/tmp") / ".cache" / "obliq";
}

}  // namespace

std::string shared_file(const std::string& name) {
  const char* given = std::getenv("OBLIQ_SHARED");
  const std::filesystem::path root = given ? given : OBLIQ_SOURCE_DIR "/../shared";
  std::filesystem::path path = root / "data" / name;
  for (const Fetched& fetched : kFetched)
    if (name == fetched.name && !std::filesystem::exists(path)) path = fetched_folder() / fetched.tile;
  return std::filesystem::exists(path) ? path.string() : std::string();
}

std::string no_shared_file(const std::string& name) {
  for (const Fetched& fetched : kFetched)
    if (name == fetched.name)
      return std::string("no ") + fetched.tile + ": " + fetched.command + " fetches it";
  return "no shared data: set OBLIQ_SHARED to the folder that holds data/" + name.substr(0, name.find('/'));
}

double ground_at(const World& world, double longitude_deg, double latitude_deg, double height_m) {
  constexpr double kDegree = std::numbers::pi / 180;
  const WorldPoint p =
      world.frame.world_from_geodetic({latitude_deg * kDegree, longitude_deg * kDegree, height_m});
  return world.grid.height_at_m(p.m.x, p.m.z);
}

}  // namespace obliq::test
