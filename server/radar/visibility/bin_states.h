#pragma once
#include "server/radar/bins.h"
#include "server/radar/visibility/wedge_visibility.h"

namespace obliq {

/// Gives every bin without samples its state, by the profiles of its azimuth. Profiles are marched
/// where they can still say something: along an azimuth bin's centre from its first undecided bin to its
/// last, and on its other sub-azimuths around those that the centre does not see. `block`: of the profile's
/// wedge, where it has no samples not sampled, or already in the shadow of buildings.
void decide_states(const ScenePlan& plan, WedgeVisibility& profile, BinBlock& block);

}  // namespace obliq
