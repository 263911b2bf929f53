#pragma once
// The sea's texture: K-distributed clutter is speckle whose mean power has a Gamma distribution (K. D. Ward,
// R. J. A. Tough, S. Watts, Sea Clutter, 2nd ed., IET 2013). Here tau follows it at every point of the sea,
// and what a bin has is its mean over the bin: the shape of a cell follows from the cell's size.
#include <memory>

#include "server/radar/scene_plan.h"
#include "server/radar/sea_state.h"
#include "server/radar/simd/ground/sea_texture.h"

namespace obliq {

/// Side of the texture's lattice. Assumed: the length of wind waves of states 3 to 5.
constexpr double kTextureSide_m = 30;

/// tau by a normal number (SeaTexture::tau) for a Gamma distribution of this shape and mean 1.
void fill_texture(double shape, float* tau);

/// Of a frame, at its pose's sim time; null where it has no sea, or its texture is off.
std::shared_ptr<const SeaTexture> sea_texture(const ScenePlan& plan);

/// Shape of the texture's mean over pieces of that size: 1 over its variance, as measured on many of them.
double shape_of_cell(double shape, double along_m, double across_m);

}  // namespace obliq
