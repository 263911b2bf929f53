#pragma once
#include "terrain/dem/source_error.h"
#include "terrain/frames.h"
#include "terrain/height_grid.h"
#include "terrain/world_spec.h"

namespace obliq {

/// Height of synthetic ground above the datum surface at world (x, z), metres. A pure function of position,
/// so the ground is the same whatever part of it is loaded.
///
/// ramp: slope times the distance along the bearing. ridge: a triangular crest line across the bearing.
/// wall: a block across the bearing whose near face stands at distance_m and whose far face width_m beyond.
/// cone: apex at the bearing and distance. hills: between base_m and base_m + height_m everywhere.
double synthetic_height_m(SyntheticKind kind, const SyntheticSpec& shape, double x_m, double z_m);

/// Gives every node its height: shape plus what the effective earth leaves of the curvature. The shape stands
/// on the earth around its anchor, wherever the frame's origin is. Throws InputError when a number of the
/// shape is not usable.
void fill_synthetic(HeightGrid& grid, SyntheticKind kind, const SyntheticSpec& shape,
                    const WorldFrame& frame);

/// How far the grid's triangles lie from the shape itself.
SourceError synthetic_error(const HeightGrid& grid, SyntheticKind kind, const SyntheticSpec& shape,
                            const WorldFrame& frame);

}  // namespace obliq
