#include "tests/support/scene_mesh.h"

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <vector>

#include "terrain/base/errors.h"
#include "terrain/buildings/building_mesh.h"

namespace obliq::test {
namespace {

class PlyWriter {
 public:
  explicit PlyWriter(const std::string& path) : path_(path), file_(path, std::ios::binary) { check(); }

  void header(std::uint64_t vertices, std::uint64_t faces) {
    file_
        << "ply\nformat binary_little_endian 1.0\ncomment obliq world frame: x east, y up, z north, metres\n"
        << "element vertex " << vertices << "\nproperty float x\nproperty float y\nproperty float z\n"
        << "element face " << faces
        << "\nproperty list uchar uint vertex_indices\nproperty uint face\nend_header\n";
  }
  void vertex(float x, float y, float z) {
    const float values[3] = {x, y, z};
    file_.write(reinterpret_cast<const char*>(values), sizeof values);
  }
  /// face: building face index, 4294967295 for ground.
  void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t face) {
    const std::uint32_t values[4] = {a, b, c, face};
    file_.put(3);
    file_.write(reinterpret_cast<const char*>(values), sizeof values);
  }
  void close() {
    file_.close();
    check();
  }

 private:
  void check() {
    if (!file_) throw InputError(path_ + ": cannot be written (" + std::strerror(errno) + ")");
  }
  std::string path_;
  std::ofstream file_;
};

}  // namespace

void write_scene_mesh(const World& world, const std::string& path) {
  const HeightGrid& grid = world.grid;
  std::vector<std::uint32_t> number(grid.y_m.size(), 0);  // of the known nodes, in grid order
  std::uint32_t n_nodes = 0;
  for (std::size_t k = 0; k < grid.y_m.size(); ++k)
    if (grid.y_m[k] == grid.y_m[k]) number[k] = n_nodes++;
  std::uint64_t cells = 0;
  for (int j = 0; j + 1 < grid.nz; ++j)
    for (int i = 0; i + 1 < grid.nx; ++i) cells += grid.cell_known(i, j) ? 1U : 0U;

  const BuildingMesh buildings = mesh_of(world.buildings);
  PlyWriter ply(path);
  ply.header(n_nodes + buildings.vertices_m.size(), 2 * cells + buildings.triangles.size());
  for (int j = 0; j < grid.nz; ++j)
    for (int i = 0; i < grid.nx; ++i)
      if (grid.node_known(i, j))
        ply.vertex(static_cast<float>(grid.node_x_m(i)), grid.y_m[grid.index(i, j)],
                   static_cast<float>(grid.node_z_m(j)));
  for (const glm::vec3& v : buildings.vertices_m) ply.vertex(v.x, v.y, v.z);
  for (int j = 0; j + 1 < grid.nz; ++j) {
    for (int i = 0; i + 1 < grid.nx; ++i) {
      if (!grid.cell_known(i, j)) continue;
      const std::uint32_t v00 = number[grid.index(i, j)];
      const std::uint32_t v10 = number[grid.index(i + 1, j)];
      const std::uint32_t v01 = number[grid.index(i, j + 1)];
      const std::uint32_t v11 = number[grid.index(i + 1, j + 1)];
      ply.triangle(v00, v01, v10, 0xffffffffu);
      ply.triangle(v11, v10, v01, 0xffffffffu);
    }
  }
  for (std::size_t t = 0; t < buildings.triangles.size(); ++t) {
    const glm::uvec3 corner = buildings.triangles[t];
    ply.triangle(n_nodes + corner.x, n_nodes + corner.y, n_nodes + corner.z, buildings.triangle_face[t]);
  }
  ply.close();
}

}  // namespace obliq::test
