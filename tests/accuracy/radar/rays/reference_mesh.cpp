#include "tests/accuracy/radar/rays/reference_mesh.h"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

#include <cmath>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <vector>

namespace obliq::test {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;
using Triple = std::array<long double, 3>;

Triple minus(const Kernel::Point_3& a, const Kernel::Point_3& b) {
  return {static_cast<long double>(a.x()) - static_cast<long double>(b.x()),
          static_cast<long double>(a.y()) - static_cast<long double>(b.y()),
          static_cast<long double>(a.z()) - static_cast<long double>(b.z())};
}
Triple cross(const Triple& a, const Triple& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
long double dot(const Triple& a, const Triple& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

template <class T>
T read(std::ifstream& file) {
  T value{};
  file.read(reinterpret_cast<char*>(&value), sizeof value);
  return value;
}

}  // namespace

struct ReferenceMesh::Impl {
  Triangles triangles;
  std::vector<std::uint32_t> faces;
  Tree tree;
};

ReferenceMesh::ReferenceMesh(const std::string& ply) : impl_(std::make_unique<Impl>()) {
  std::ifstream file(ply, std::ios::binary);
  std::size_t n_vertices = 0, n_faces = 0;
  std::string line;
  while (std::getline(file, line) && line != "end_header") {
    std::istringstream words(line);
    std::string word, what;
    words >> word >> what;
    if (word == "element" && what == "vertex") words >> n_vertices;
    if (word == "element" && what == "face") words >> n_faces;
  }
  std::vector<Kernel::Point_3> vertices;
  vertices.reserve(n_vertices);
  for (std::size_t k = 0; k < n_vertices; ++k) {
    const auto x = read<float>(file), y = read<float>(file), z = read<float>(file);
    vertices.emplace_back(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z));
  }
  for (std::size_t k = 0; k < n_faces; ++k) {
    if (read<std::uint8_t>(file) != 3) throw std::runtime_error(ply + ": a face that is no triangle");
    const auto a = read<std::uint32_t>(file), b = read<std::uint32_t>(file), c = read<std::uint32_t>(file);
    impl_->triangles.emplace_back(vertices.at(a), vertices.at(b), vertices.at(c));
    impl_->faces.push_back(read<std::uint32_t>(file));
  }
  if (!file || file.peek() != EOF || n_faces == 0)
    throw std::runtime_error(ply + ": not of the size it says");
  impl_->tree.insert(impl_->triangles.cbegin(), impl_->triangles.cend());
  impl_->tree.build();
}

ReferenceMesh::~ReferenceMesh() = default;

std::optional<ReferenceMesh::Hit> ReferenceMesh::first_hit(const Vector3& o, const Vector3& d) const {
  const Kernel::Point_3 origin(o.x, o.y, o.z);
  const auto found =
      impl_->tree.first_intersected_primitive(Kernel::Ray_3(origin, Kernel::Vector_3(d.x, d.y, d.z)));
  if (!found) return std::nullopt;
  const Kernel::Triangle_3& t = **found;
  const Triple normal = cross(minus(t[1], t[0]), minus(t[2], t[0]));
  const Triple direction{d.x, d.y, d.z};
  const long double distance = dot(normal, minus(t[0], origin)) / dot(normal, direction);
  return Hit{static_cast<std::uint32_t>(*found - impl_->triangles.cbegin()), static_cast<double>(distance)};
}

bool ReferenceMesh::on_triangle(std::uint32_t triangle, const Vector3& p, double slack) const {
  const Kernel::Triangle_3& t = impl_->triangles[triangle];
  const Triple normal = cross(minus(t[1], t[0]), minus(t[2], t[0]));
  const long double area2 = dot(normal, normal);
  const Kernel::Point_3 point(p.x, p.y, p.z);
  for (int k = 0; k < 3; ++k) {
    const Triple side = cross(minus(t[(k + 1) % 3], t[k]), minus(point, t[k]));
    if (dot(side, normal) < -static_cast<long double>(slack) * area2) return false;
  }
  // Off the plane by less than a micrometre.
  return std::abs(dot(normal, minus(point, t[0]))) < 1e-6L * std::sqrt(area2);
}

std::uint32_t ReferenceMesh::face(std::uint32_t triangle) const { return impl_->faces[triangle]; }
std::size_t ReferenceMesh::size() const { return impl_->triangles.size(); }

Vector3 turned(const Vector3& d, double a_rad, double b_rad) {
  // Across: horizontal, and the third axis. A vertical direction takes east.
  const double level = std::hypot(d.x, d.z);
  const Vector3 a = level > 0 ? Vector3{d.z / level, 0, -d.x / level} : Vector3{1, 0, 0};
  const Vector3 b{a.y * d.z - a.z * d.y, a.z * d.x - a.x * d.z, a.x * d.y - a.y * d.x};
  const Vector3 t{d.x + a_rad * a.x + b_rad * b.x, d.y + a_rad * a.y + b_rad * b.y,
                  d.z + a_rad * a.z + b_rad * b.z};
  const double length = std::sqrt(t.x * t.x + t.y * t.y + t.z * t.z);
  return {t.x / length, t.y / length, t.z / length};
}

}  // namespace obliq::test
