#pragma once
#include <cstdint>

#include "server/radar/beam/echo_rows.h"

namespace obliq {

/// A wedge of scan angles, of an antenna that is not stabilised, from sharp wedges of the ground's azimuths
/// (EchoPlan::ground). Each echo goes to the two scan angles beside the one at which it is seen
/// (SharpWedge::seen_at), the nearer the more: the sums' weights are then those between theirs. Count, state
/// and returns are those of level ground seen there.
SharpWedgePtr turned_wedge(const EchoPlan& plan, const EchoRows::Ready& ground, const SharpPlanes& planes,
                           std::uint64_t look_key);

}  // namespace obliq
