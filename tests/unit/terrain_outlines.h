#pragma once
// Building outlines for tests, drawn in metres around a place and written as GeoJSON.
#include <glm/vec2.hpp>
#include <string>
#include <vector>

#include "tests/unit/terrain_files.h"

namespace obliq::test {

using MetreRing = std::vector<glm::dvec2>;  ///< east, north of the scene origin; open

/// "[[[lon,lat],...]]": a GeoJSON polygon's coordinates, closed.
std::string coordinates(const WorldFrame& frame, const std::vector<MetreRing>& rings);

/// A GeoJSON feature of the given type and coordinates.
std::string feature(const std::string& type, const std::string& coordinates,
                    const std::string& properties = "");
std::string polygon_feature(const WorldFrame& frame, const std::vector<MetreRing>& rings,
                            const std::string& properties = "");
std::string collection(const std::vector<std::string>& features, const std::string& crs = "");

/// 2 km of flat ground at height 0 around 99.5 W 33 N, nodes 25 m apart.
WorldSpec flat_town();
WorldFrame town_frame();

/// Loads flat_town with these features as buildings.
World town(const Folder& folder, const std::vector<std::string>& features, WorldSpec spec = flat_town());

MetreRing square(double east, double north, double side);

/// Volume that a building's triangles enclose together with a bottom at the base: positive when the component
/// cross product of every triangle points outwards (divergence theorem).
double enclosed_volume_m3(const Buildings& buildings, std::size_t index);
/// Area of the roof triangles.
double roof_area_m2(const Buildings& buildings, std::size_t index);

}  // namespace obliq::test
