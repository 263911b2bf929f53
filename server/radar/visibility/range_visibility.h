#pragma once
// The vertical profile of the scene along one azimuth: which slant ranges hold visible, hidden or no known
// surface. It decides what a bin without samples means, whatever rays were cast.
#include <span>
#include <vector>

#include "server/radar/bins.h"
#include "server/radar/profile/roofs.h"
#include "server/radar/scene_plan.h"
#include "server/radar/simd/ground/profiles.h"

namespace obliq {

/// Marks per range bin, [n_range] each: of a profile, or of an azimuth bin's together.
struct BinMarks {
  std::vector<std::uint8_t> visible;  ///< 1 where a visible segment of surface lies in the bin
  std::vector<std::uint8_t> present;  ///< 1 where any known surface, seen or hidden, lies in the bin

  BinMarks() = default;
  explicit BinMarks(int n_range)
      : visible(static_cast<std::size_t>(n_range)), present(static_cast<std::size_t>(n_range)) {}
  /// Joins another's marks of some range bins.
  void add(const BinMarks& other, RangeWindow bins);
};

/// How many sub-azimuths (vertical profiles) an azimuth bin is divided into, even, 2 to 8: no farther apart
/// at r_max than the grid's nodes. Profiles stand at the bin's edges, its centre and evenly between; a bin is
/// hidden when all of them say so, since a ray may pass on either side of any one of them.
int sub_azimuths_per_bin(const ScenePlan& plan);

/// The range bin from which on a sub-azimuth counts. With the sweep, which promises that a longer range never
/// changes nearer bins, sub-azimuths are halved in number where bins are narrower, whatever r_max asks for,
/// and a sub-azimuth that is a profile of the sweep counts nowhere: what can be seen of it is sampled. 0 with
/// others.
std::size_t first_bin_of_sub_azimuth(const ScenePlan& plan, int sub_azimuth, int sub_azimuths);

/// The vertical profile at an azimuth position in bins (azimuth bin a spans [a, a + 1]), and the range bins
/// whose marks are wanted of it. Others may be marked or not.
struct VisibilityRequest {
  double position;
  RangeWindow bins;
  bool roofs = true;  ///< false: over bare ground
};

/// Marches up to kMostProfiles vertical profiles side by side from the nadir through every triangle edge,
/// keeping the highest elevation met so far; results in their order. Where farther bins are wanted, the march
/// begins at the first distance at which surface may lie in them, with the horizon of all that is nearer.
constexpr int kMostProfiles = RangeProfiles::kLanes;
void mark_profiles(const ScenePlan& plan, std::span<const VisibilityRequest> requests,
                   std::span<BinMarks> results, std::vector<RoofSpan>& spans);

}  // namespace obliq
