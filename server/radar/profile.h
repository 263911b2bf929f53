#pragma once
// The vertical profile of the scene along one azimuth: which slant ranges hold visible, hidden or no known
// surface. It decides what a bin without samples means, whatever rays were cast.
#include <vector>

#include "server/radar/bins.h"
#include "server/radar/footprint_index.h"
#include "server/radar/frame_plan.h"

namespace obliq {

/// Marks per range bin, and how much of the azimuth's ground is known.
struct ProfileResult {
  std::vector<std::uint8_t> visible;  ///< [n_range] 1 where a visible piece of surface lies in the bin
  std::vector<std::uint8_t>
      present;                 ///< [n_range] 1 where any known surface, seen or hidden, lies in the bin
  double sector_area_m2 = 0;   ///< of this azimuth bin between r_min and r_max
  double covered_area_m2 = 0;  ///< of that, over known ground
};

/// Marches the vertical plane of an azimuth bin's centre from the nadir through every triangle edge, keeping
/// the highest elevation met so far. `result` is reused between calls.
void march_profile(const FramePlan& plan, int azimuth_bin, std::vector<FootprintSpan>& spans,
                   ProfileResult& result);

}  // namespace obliq
