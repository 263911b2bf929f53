// How long 22.5 million posts, 64 x 35 km at 10 m, take from a GeoTIFF to a scene that is ready, against what
// GDAL alone takes to read and warp the same posts; and how long the second start takes, with the cache.
// Ratios are of one run on one machine, each time the least of a few.
//
//   load_bench [DEM LONGITUDE LATITUDE]     without: made-up ground in a file like those of 3DEP at 1/3"
#include <cpl_conv.h>
#include <gdal_priv.h>
#include <gdal_utils.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <functional>
#include <numbers>
#include <string>
#include <thread>
#include <vector>

#include "server/scene/embree_tracer.h"
#include "server/scene/scene.h"
#include "terrain/base/hash.h"

namespace obliq {
namespace {

constexpr double kWide_m = 64000;
constexpr double kHigh_m = 35150;  // 3,516 rows: 22.5 million posts
constexpr double kCell_m = 10;
constexpr int kRepeats = 3;

struct Place {
  std::string dem;
  LonLat centre;
};

double least_seconds(const std::function<void()>& work) {
  double least = HUGE_VAL;
  for (int k = 0; k < kRepeats; ++k) {
    const auto start = std::chrono::steady_clock::now();
    work();
    least = std::min(least, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return least;
}

/// Float32 at 1/3", tiled, LZW: as USGS ships its own.
void write_dem(const std::string& path, const LonLat& centre) {
  constexpr double kPost_deg = 1.0 / 10800;
  const int columns = 8192;
  const int rows = 4608;
  char** options = nullptr;
  for (const char* option : {"TILED=YES", "BLOCKXSIZE=256", "BLOCKYSIZE=256", "COMPRESS=LZW", "PREDICTOR=3"})
    options = CSLAddString(options, option);
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GTiff");
  const std::unique_ptr<GDALDataset> file(
      driver->Create(path.c_str(), columns, rows, 1, GDT_Float32, options));
  CSLDestroy(options);
  OGRSpatialReference nad83;
  nad83.importFromEPSG(4269);
  double transform[6] = {centre.longitude_deg - columns / 2 * kPost_deg, kPost_deg, 0,
                         centre.latitude_deg + rows / 2 * kPost_deg,     0,         -kPost_deg};
  if (!file || file->SetSpatialRef(&nad83) != CE_None || file->SetGeoTransform(transform) != CE_None)
    throw std::runtime_error("cannot write " + path);
  std::vector<float> row(static_cast<std::size_t>(columns));
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c)
      row[static_cast<std::size_t>(c)] =
          static_cast<float>(900 + 400 * std::sin(c * 0.004) * std::cos(r * 0.005) +
                             60 * std::sin(c * 0.05 + r * 0.037) + unit_from_hash(hash_cell(1, c, r)));
    if (file->GetRasterBand(1)->RasterIO(GF_Write, 0, r, columns, 1, row.data(), columns, 1, GDT_Float32, 0,
                                         0, nullptr) != CE_None)
      throw std::runtime_error("cannot write " + path);
  }
}

WorldSpec spec_of(const Place& place, const std::string& cache) {
  WorldSpec spec;
  spec.terrain.dem = {place.dem};
  spec.terrain.cell_m = kCell_m;
  spec.terrain.cache_folder = cache;
  spec.origin = place.centre;
  const WorldFrame frame(place.centre.latitude_deg * std::numbers::pi / 180,
                         place.centre.longitude_deg * std::numbers::pi / 180, spec.radius_factor);
  for (const auto& [x, z] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
    const double x_m = x * kWide_m / 2;
    const double z_m = z * kHigh_m / 2;
    const Geodetic corner =
        frame.geodetic_from_world(WorldPoint{glm::dvec3(x_m, frame.datum_y_m(x_m, z_m), z_m)});
    spec.terrain.area.push_back(
        {corner.longitude_rad * 180 / std::numbers::pi, corner.latitude_rad * 180 / std::numbers::pi});
  }
  return spec;
}

/// The same posts in the same plane, which for GDAL is an orthographic projection.
void warp(const Place& place, const HeightGrid& grid) {
  const std::string threads = "NUM_THREADS=" + std::to_string(std::thread::hardware_concurrency());
  const std::string system = "+proj=ortho +ellps=GRS80 +lat_0=" + std::to_string(place.centre.latitude_deg) +
                             " +lon_0=" + std::to_string(place.centre.longitude_deg);
  const double half = grid.cell_m / 2;
  const std::vector<std::string> words = {"-of",
                                          "MEM",
                                          "-ot",
                                          "Float32",
                                          "-r",
                                          "bilinear",
                                          "-multi",
                                          "-wo",
                                          threads,
                                          "-wm",
                                          "1000",
                                          "-t_srs",
                                          system,
                                          "-te",
                                          std::to_string(grid.x0_m - half),
                                          std::to_string(grid.z0_m - half),
                                          std::to_string(grid.x1_m() + half),
                                          std::to_string(grid.z1_m() + half),
                                          "-ts",
                                          std::to_string(grid.nx),
                                          std::to_string(grid.nz)};
  char** arguments = nullptr;
  for (const std::string& word : words) arguments = CSLAddString(arguments, word.c_str());
  GDALWarpAppOptions* options = GDALWarpAppOptionsNew(arguments, nullptr);
  CSLDestroy(arguments);
  GDALDatasetH source = GDALOpen(place.dem.c_str(), GA_ReadOnly);
  int misused = 0;
  GDALDatasetH made = GDALWarp("", nullptr, 1, &source, options, &misused);
  if (made == nullptr) throw std::runtime_error("GDAL cannot warp " + place.dem);
  GDALClose(made);
  GDALClose(source);
  GDALWarpAppOptionsFree(options);
}

void run(const Place& place, const std::filesystem::path& folder) {
  const std::string cache = folder / "cache";
  std::shared_ptr<const World> world;
  const auto start = [&](const std::string& cache_folder, bool rays) {
    world.reset();
    world = std::make_shared<const World>(load_world(spec_of(place, cache_folder)));
    const Scene scene(world, {Material{}}, 0);
    if (rays) scene.tracer();
  };
  const double first_s = least_seconds([&] { start("", false); });
  const std::vector<float> heights = world->grid.y_m;
  const HeightGrid& grid = world->grid;
  std::printf("%d x %d posts of %.4g m, %llu of them without ground; %u threads\n", grid.nx, grid.nz,
              grid.cell_m, static_cast<unsigned long long>(world->report.posts_absent),
              std::thread::hardware_concurrency());
  const double gdal_s = least_seconds([&] { warp(place, world->grid); });
  const double keeping_s = least_seconds([&] {
    std::filesystem::remove_all(cache);
    start(cache, false);
  });
  const double second_s = least_seconds([&] { start(cache, false); });
  const bool same = std::memcmp(heights.data(), world->grid.y_m.data(), heights.size() * sizeof(float)) == 0;
  const double rays_s = least_seconds([&] { start(cache, true); });
  std::printf("GDAL reads and warps          %8.3f s\n", gdal_s);
  std::printf("first start, without cache    %8.3f s   %.2f of GDAL's\n", first_s, first_s / gdal_s);
  std::printf("first start, which is kept    %8.3f s   %.2f of GDAL's\n", keeping_s, keeping_s / gdal_s);
  std::printf("second start                  %8.3f s   %.1f times faster, %s\n", second_s,
              keeping_s / second_s, same ? "the same bits" : "OTHER BITS");
  std::printf("second start, and for rays    %8.3f s\n", rays_s);
}

}  // namespace
}  // namespace obliq

int main(int count, char** words) {
  using namespace obliq;
  GDALAllRegister();
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("obliq_load_bench_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  int code = 0;
  try {
    Place place{folder / "dem.tif", {-112.0, 36.2}};
    if (count == 4) {
      place = {words[1], {std::atof(words[2]), std::atof(words[3])}};
    } else {
      write_dem(place.dem, place.centre);
    }
    run(place, folder);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "load_bench: %s\n", error.what());
    code = 1;
  }
  std::filesystem::remove_all(folder);
  return code;
}
