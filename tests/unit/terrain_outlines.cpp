#include "tests/unit/terrain_outlines.h"

#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>

#include "terrain/buildings/building_mesh.h"

namespace obliq::test {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

}  // namespace

WorldFrame town_frame() {
  return WorldFrame(33 * kDegree, -99.5 * kDegree, std::numeric_limits<double>::infinity());
}

std::string coordinates(const WorldFrame& frame, const std::vector<MetreRing>& rings) {
  std::string text = "[";
  for (const MetreRing& ring : rings) {
    if (&ring != &rings[0]) text += ",";
    text += "[";
    for (std::size_t k = 0; k <= ring.size(); ++k) {
      const glm::dvec2 p = ring[k % ring.size()];
      const double y = frame.ellipsoid_y_m(p.x, p.y) - frame.lift_m(p.x, p.y);
      const Geodetic g = frame.geodetic_from_world(WorldPoint{glm::dvec3(p.x, y, p.y)});
      char point[80];
      std::snprintf(point, sizeof point, "%s[%.12f,%.12f]", k ? "," : "", g.longitude_rad / kDegree,
                    g.latitude_rad / kDegree);
      text += point;
    }
    text += "]";
  }
  return text + "]";
}

std::string feature(const std::string& type, const std::string& coordinates, const std::string& properties) {
  return R"({"type":"Feature","properties":{)" + properties + R"(},"geometry":{"type":")" + type +
         R"(","coordinates":)" + coordinates + "}}";
}

std::string polygon_feature(const WorldFrame& frame, const std::vector<MetreRing>& rings,
                            const std::string& properties) {
  return feature("Polygon", coordinates(frame, rings), properties);
}

std::string collection(const std::vector<std::string>& features, const std::string& crs) {
  std::string text = R"({"type":"FeatureCollection",)";
  if (!crs.empty()) text += R"("crs":{"type":"name","properties":{"name":")" + crs + R"("}},)";
  text += R"("features":[)";
  for (std::size_t k = 0; k < features.size(); ++k) text += (k ? ",\n" : "\n") + features[k];
  return text + "\n]}\n";
}

WorldSpec flat_town() {
  WorldSpec spec = scene(-99.5, 33, 1000, {});
  spec.terrain.synthetic = SyntheticKind::flat;
  spec.terrain.cell_m = 25;
  return spec;
}

World town(const Folder& folder, const std::vector<std::string>& features, WorldSpec spec) {
  if (spec.buildings.empty()) spec.buildings.emplace_back();
  spec.buildings[0].source = folder.text("town.geojson", collection(features));
  return load_world(spec);
}

MetreRing square(double east, double north, double side) {
  return {{east, north}, {east + side, north}, {east + side, north + side}, {east, north + side}};
}

double enclosed_volume_m3(const Buildings& b, std::size_t index) {
  const Building& building = b.list[index];
  // Relative to a corner of the building, so that large coordinates do not cancel.
  const glm::dvec3 origin(over(b.ring_xz_m[b.ring_start[building.first_ring]], building.roof_y_m));
  double six = 0;
  for_each_triangle(b, building, [&](std::uint32_t face, const Triangle& triangle) {
    glm::dvec3 p[3];
    for (std::size_t c = 0; c < 3; ++c) p[c] = glm::dvec3(triangle[c]) - origin;
    six += glm::dot(p[0], glm::cross(p[1], p[2]));
    if (!b.face(face).wall) {
      // The bottom: the roof's triangle at the base, turned over.
      for (glm::dvec3& corner : p) corner.y = static_cast<double>(building.base_y_m) - origin.y;
      six += glm::dot(p[0], glm::cross(p[2], p[1]));
    }
  });
  return six / 6;
}

double roof_area_m2(const Buildings& b, std::size_t index) {
  double area = 0;
  for_each_triangle(b, b.list[index], [&](std::uint32_t face, const Triangle& triangle) {
    if (b.face(face).wall) return;
    const glm::dvec3 a(triangle[0]);
    area += glm::length(glm::cross(glm::dvec3(triangle[1]) - a, glm::dvec3(triangle[2]) - a)) / 2;
  });
  return area;
}

}  // namespace obliq::test
