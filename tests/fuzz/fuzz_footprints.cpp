// Damaged outlines. First byte: how the file calls itself, and whether it is buildings, an area of random
// ones, or a surface.
#include <array>

#include "terrain/base/errors.h"
#include "terrain/buildings/building_mesh.h"
#include "terrain/world.h"
#include "tests/fuzz/gdal_memory.h"
#include "tests/fuzz/input.h"

namespace obliq {
namespace {

constexpr std::array kNames{"fuzz.geojson", "fuzz.gpkg", "fuzz.fgb"};

WorldSpec flat_town() {
  WorldSpec spec;
  spec.terrain.synthetic = SyntheticKind::flat;
  spec.terrain.cell_m = 50;
  spec.origin = {-99.5, 33};
  spec.reaches = {{spec.origin, 500}};
  return spec;
}

void load(WorldSpec spec) {
  const World world = load_world(spec);
  const BuildingMesh mesh = mesh_of(world.buildings);
  for (const auto& triangle : mesh.triangles) {
    for (int corner = 0; corner < 3; ++corner) {
      if (triangle[corner] >= mesh.vertices_m.size()) fuzz::broken("a triangle without corners");
    }
  }
  for (const auto& vertex : mesh.vertices_m) {
    for (int axis = 0; axis < 3; ++axis) {
      if (!(vertex[axis] > -1e7F && vertex[axis] < 1e7F)) fuzz::broken("a building that is nowhere");
    }
  }
}

}  // namespace
}  // namespace obliq

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  obliq::fuzz::keep_drivers({"GeoJSON", "GPKG", "FlatGeobuf"});
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace obliq;
  fuzz::Input input(data, size);
  const unsigned choice = input.u8();
  const fuzz::MemoryFile file(kNames[choice % kNames.size()], input.rest());
  WorldSpec spec = flat_town();
  switch (choice / kNames.size() % 3) {
    case 0:
      spec.buildings.emplace_back().source = file.path();
      break;
    case 1:
      spec.prisms.emplace_back().within = file.path();
      spec.prisms.back().per_km2 = 20;
      break;
    default:
      spec.surfaces.emplace_back().source = file.path();
      break;
  }
  try {
    load(spec);
  } catch (const InputError&) {
    // What an operator gets to read.
  }
  return 0;
}
