#pragma once
#include <cstdint>

#include "server/radar/simd/ground_echoes.h"

namespace obliq {

/// Where the ground cells of echoes lie: by range bin, and by profile.
struct PlaceOfEchoes {
  double antenna_x_m, antenna_z_m;
  double sin_bearing[SightProfiles::kLanes];
  double cos_bearing[SightProfiles::kLanes];
  const double* cells_per_m;        ///< [n_range]
  const std::uint64_t* level_bits;  ///< [n_range] as in ScattererKey::kind
};

/// The ground cell of each echo, as ScattererKey's place and kind. Written up to a multiple of 8.
OBLIQ_KERNEL(void, ground_places, const PlaceOfEchoes&, const GroundEchoes&, std::uint64_t* place,
             std::uint64_t* kind);

}  // namespace obliq
