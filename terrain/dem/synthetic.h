#pragma once
#include "terrain/dem/source_error.h"
#include "terrain/frames.h"
#include "terrain/height_grid.h"
#include "terrain/world_spec.h"

namespace obliq {

/// Gives every node its height: shape plus what the effective earth leaves of the curvature. The shape stands
/// on the earth around its anchor, wherever the frame's origin is. Throws InputError when a number of the
/// shape is not usable.
void fill_synthetic(HeightGrid& grid, SyntheticKind kind, const SyntheticSpec& shape,
                    const WorldFrame& frame);

/// How far the grid's triangles lie from the shape itself.
SourceError synthetic_error(const HeightGrid& grid, SyntheticKind kind, const SyntheticSpec& shape,
                            const WorldFrame& frame);

}  // namespace obliq
