#pragma once
#include <string>
#include <vector>

#include "terrain/world_spec.h"

namespace obliq {

/// 32 hexadecimal digits of what a world is made from: the contents of its sources (not their names), and all
/// that the scene says of what they mean: units, layers, fields, filters, materials, how prisms are
/// scattered, the earth's radius. Not what is loaded of it: area, cell and the scene's origin change with a
/// flight's windows while the world stays, and frames have them beside it. dem_files: every file of the
/// elevation models, in their order.
std::string world_sum(const WorldSpec& spec, const std::vector<std::string>& dem_files);

}  // namespace obliq
