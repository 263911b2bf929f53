#pragma once
#include <cstdint>
#include <memory>
#include <string>

#include "server/control/sections/radar.h"
#include "server/loading/terminal_progress.h"
#include "server/scene/scene.h"

namespace obliq {

/// What bounds the search.
struct PixelLimits {
  std::int64_t most_pixels;  ///< of one frame (server.max_pixels)
  int threads;               ///< 0: all cores
};

/// For frustum.quality = "oblique": gives the radar about the fewest pixel columns and rows that leave no
/// more than kMostUnsampled of its lit bins without a sample, as counted in frames of the scene. `say` hears
/// what was found. Does nothing for other radars. Throws InputError, with the best that there is, where no
/// pixels do.
void find_pixels(const std::shared_ptr<const Scene>& scene, RadarConfig& radar, const PixelLimits& limits,
                 const Say& say, const Progress& progress);

}  // namespace obliq
