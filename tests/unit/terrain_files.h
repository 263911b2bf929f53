#pragma once
// Small files that the terrain tests write for themselves, in a folder of their own.
#include <array>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "terrain/world.h"

namespace obliq::test {

/// A folder that goes away with the test.
class Folder {
 public:
  Folder();
  ~Folder();
  std::string file(const std::string& name) const { return (path_ / name).string(); }
  /// Writes text and returns the path.
  std::string text(const std::string& name, const std::string& content) const;

 private:
  std::filesystem::path path_;
};

struct RasterPlan {
  int columns = 61;
  int rows = 61;
  std::string crs = "EPSG:4326";                ///< empty: none
  std::array<double, 6> geotransform{};         ///< GDAL's, of pixel corners
  std::function<double(double, double)> value;  ///< of the pixel centre's x and y in the file's system
  std::string type = "Float32";
  std::optional<double> nodata;
  std::string unit;
  double scale = 1;
  double offset = 0;
  bool point = false;
  std::string driver = "GTiff";
  std::vector<std::string> options;
  std::function<bool(int, int)> masked;  ///< pixels that a mask band hides
};

/// A plan of side x side degree pixels around (longitude, latitude), 1/1200 degree each (about 90 m).
RasterPlan around(double longitude_deg, double latitude_deg, std::function<double(double, double)> value);

std::string write_raster(const Folder& folder, const std::string& name, const RasterPlan& plan);

/// A scene at the origin with one reach and these DEMs, on a flat earth.
WorldSpec scene(double longitude_deg, double latitude_deg, double reach_m, std::vector<std::string> dem);

/// What load_world says of a scene it refuses; "no error" when it loads.
std::string error_of(const WorldSpec& spec);

/// Real data beside the project, or what deploy/fetch-demo-terrain.sh has fetched of it; empty when there is
/// none.
std::string shared_file(const std::string& name);

/// Why a test without that file is skipped, and what would give it.
std::string no_shared_file(const std::string& name);

/// Grid height at a longitude and latitude on flat earths: position taken at the given height.
double ground_at(const World& world, double longitude_deg, double latitude_deg, double height_m);

}  // namespace obliq::test
