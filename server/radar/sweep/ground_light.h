#pragma once
#include "server/radar/echo/echo_cells.h"
#include "server/radar/simd/buildings/sub_columns.h"

namespace obliq {

/// Writes the share of the light of a plane's ground that buildings leave to kept[bin * 8], for the range
/// bins that they take some from, and marks in `cells` the bins in which they leave none.
/// Light goes by the sines of elevations, where there are some, else by their tangents.
void keep_shares(const NodeProfiles& nodes, int plane, int n_range, int profile, float* kept,
                 EchoCells& cells);

}  // namespace obliq
