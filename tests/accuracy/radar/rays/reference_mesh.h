#pragma once
// An independent ray tracer: CGAL's AABB tree, in double, over the PLY file of a scene (scene_mesh.h). It
// includes nothing of the product and shares no code with it.
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace obliq::test {

struct Vector3 {
  double x, y, z;
};

class ReferenceMesh {
 public:
  /// Throws std::runtime_error when the file is not one that write_scene_mesh has made.
  explicit ReferenceMesh(const std::string& ply);
  ~ReferenceMesh();

  struct Hit {
    std::uint32_t triangle;
    double distance_m;  ///< to the triangle's plane in long double
  };
  /// Nearest triangle along a unit direction, either side.
  std::optional<Hit> first_hit(const Vector3& origin, const Vector3& direction) const;

  /// Whether a point lies on the triangle, to `slack` in barycentric units.
  bool on_triangle(std::uint32_t triangle, const Vector3& point, double slack) const;

  /// Building face; 4294967295 for ground.
  std::uint32_t face(std::uint32_t triangle) const;
  std::size_t size() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A unit vector turned by small angles (radians) in two directions across it.
Vector3 turned(const Vector3& direction, double a_rad, double b_rad);

}  // namespace obliq::test
