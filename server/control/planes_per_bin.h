#pragma once
// frustum.planes_per_bin: planes that follow the azimuth bins.
#include <optional>

#include "server/radar/settings.h"
#include "terrain/base/errors.h"

namespace obliq {

/// Most pixels on a side, and most planes of a sweep.
constexpr int kMostPlanes = 16384;

/// After a change of settings. columns_named: the change named pixel_columns, which then decide and set
/// planes_per_bin to 0. Else a sweep's pixel_columns become planes_per_bin for each azimuth bin, if that is
/// above 0; up to kMostPlanes, which round up to as many planes in each bin.
void settle_planes(RadarSettings& settings, bool columns_named);

/// More planes in all than there may be.
std::optional<FieldError> planes_fault(const RadarSettings& settings);

}  // namespace obliq
