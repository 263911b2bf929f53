#pragma once
// A scene's triangles as a file, for other ray tracers.
#include <string>

#include "terrain/world.h"

namespace obliq::test {

/// Writes exactly the triangles that Embree gets as a binary PLY: those of the ground cell by cell, two a
/// cell, then those of the buildings, each with its face (4294967295: ground). World frame: x east, y up, z
/// north. Throws InputError.
void write_scene_mesh(const World& world, const std::string& path);

}  // namespace obliq::test
