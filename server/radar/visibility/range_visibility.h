#pragma once
// The vertical profile of the scene along one azimuth: which slant ranges hold visible, hidden or no known
// surface. It decides what a bin without samples means, whatever rays were cast.
#include <span>
#include <vector>

#include "server/radar/bins.h"
#include "server/radar/frame_plan.h"
#include "server/radar/profile/roofs.h"
#include "server/radar/simd/kernels.h"

namespace obliq {

/// Marks per range bin.
struct ProfileResult {
  std::vector<std::uint8_t> visible;  ///< [n_range] 1 where a visible piece of surface lies in the bin
  std::vector<std::uint8_t>
      present;  ///< [n_range] 1 where any known surface, seen or hidden, lies in the bin
};

/// How many strands (vertical planes) an azimuth bin is divided into, even, 2 to 8: no farther apart at r_max
/// than the grid's nodes. Planes stand at the bin's edges, its centre and evenly between; a bin is hidden
/// when all of them say so, since a ray may pass on either side of any one of them.
int profile_strands(const FramePlan& plan);

/// The range bin from which on a strand counts. With the sweep, which promises that a longer range never
/// changes nearer bins, strands are halved in number where bins are narrower, whatever r_max asks for, and a
/// strand that is a plane of the sweep counts nowhere: what can be seen of it is sampled. 0 with others.
std::size_t first_bin_of_strand(const FramePlan& plan, int strand, int strands);

/// Marches the vertical plane at azimuth position `position` (in bins: azimuth bin a spans [a, a + 1]) from
/// the nadir through every triangle edge, keeping the highest elevation met so far. `result` is reused
/// between calls. Frames march eight planes at a time, below: this is the plain code that tests compare with.
void march_profile(const FramePlan& plan, double position, std::vector<FootprintSpan>& spans,
                   ProfileResult& result);

/// A plane, and the range bins whose marks are wanted of it. Others may be marked or not.
struct ProfileWish {
  double position;
  RangeWindow bins;
};

/// The same for up to kMostProfiles planes side by side, results in their order: to the bit where all bins
/// are wanted. Where farther ones are, the march begins at the first distance at which surface may lie in
/// them, with the horizon of all that is nearer. `kernels`: for tests that compare instruction sets.
constexpr int kMostProfiles = ProfileLanes::kLanes;
void march_profiles(const FramePlan& plan, std::span<const ProfileWish> wishes,
                    std::span<ProfileResult> results, std::vector<FootprintSpan>& spans,
                    const LaneKernels& kernels = lane_kernels());

}  // namespace obliq
