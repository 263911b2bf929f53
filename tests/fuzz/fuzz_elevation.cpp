// A damaged elevation model. First byte: how the file calls itself.
#include <array>
#include <cmath>

#include "terrain/base/errors.h"
#include "terrain/dem/raster.h"
#include "terrain/world.h"
#include "tests/fuzz/gdal_memory.h"
#include "tests/fuzz/input.h"

namespace obliq {
namespace {

// GDAL knows formats by their content; a few look at the name as well.
constexpr std::array kNames{"fuzz.tif", "fuzz.dem", "fuzz.asc", "fuzz.img", "N33W100.hgt"};
constexpr const char* kField = "[terrain] dem";
// What a file may claim to hold before a fuzzer spends its time on reading nothing.
constexpr double kMostPosts = 1 << 20;
constexpr double kReach_m = 400;
constexpr double kCell_m = 20;

void load(const std::string& path) {
  WorldSpec spec;
  spec.terrain.dem = {path};
  spec.terrain.crs = "EPSG:4326";
  spec.terrain.cell_m = kCell_m;
  {
    const Raster raster(path, kField, spec.terrain.crs);
    if (static_cast<double>(raster.columns()) * raster.rows() > kMostPosts) return;
  }
  spec.origin = dem_centre(spec.terrain);
  spec.reaches = {{spec.origin, kReach_m}};
  const World world = load_world(spec);
  if (world.grid.nx < 2 || world.grid.nz < 2) fuzz::broken("a world without ground");
  for (const float height_m : world.grid.y_m) {
    if (std::isinf(height_m)) fuzz::broken("ground at infinity");
  }
}

}  // namespace
}  // namespace obliq

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  obliq::fuzz::keep_drivers({"GTiff", "USGSDEM", "AAIGrid", "HFA", "SRTMHGT"});
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace obliq;
  fuzz::Input input(data, size);
  const char* name = kNames[input.u8() % kNames.size()];
  const fuzz::MemoryFile file(name, input.rest());
  try {
    load(file.path());
  } catch (const InputError&) {
    // What an operator gets to read.
  }
  return 0;
}
