#pragma once
// The inner loops that exist once for each instruction set. All sets give the same bits.
#include <vector>

#include "server/radar/simd/bin_samples.h"
#include "server/radar/simd/cut_at_bins.h"
#include "server/radar/simd/free_ray_hits.h"
#include "server/radar/simd/ground_speckle.h"
#include "server/radar/simd/highest_ground.h"
#include "server/radar/simd/pixel_rays.h"
#include "server/radar/simd/profile_ray_hits.h"
#include "server/radar/simd/refine_hits.h"
#include "server/radar/simd/sum_scatterers.h"
#include "server/radar/simd/visible_ground.h"
#include "server/radar/simd/visible_ranges.h"

namespace obliq {

struct LaneKernels {
  const char* name;
  SpeckleKernel speckle;
  GroundKernel march_ground;
  PieceKernel cut_ground;
  HorizonKernel highest_ground;
  ProfileKernel march_profiles;
  PlaceKernel place;
  MergeKernel merge;
  AnswerKernel answer_rays;
  HitKernel meet_ground;
  AimKernel aim;
  CastKernel cast_ground;
};

/// Those of the widest set that this machine has.
const LaneKernels& lane_kernels();

/// Of all the sets that this machine has, the narrowest first.
const std::vector<LaneKernels>& all_lane_kernels();

/// Compiled with x86-64-v2, -v3 and -v4.
#define OBLIQ_DECLARE_LANES(isa)                                                                 \
  namespace isa {                                                                                \
  void speckle_lanes(const SpeckleGround&, const SpeckleBlock&);                                 \
  bool march_ground(const GroundView&, GroundLanes&, GroundPieces&);                             \
  unsigned march_profiles(const GroundView&, const RangeAxis&, ProfileLanes&);                   \
  HorizonPoint highest_ground(const GroundView&, const GroundStretch&);                          \
  int cut_ground(const PieceBins&, const GroundPieces&, int, SampleBatch&, bool&);               \
  void place_samples(const SwathCells&, const EchoFactors&, const SampleBatch&, PlacedSamples&); \
  unsigned answer_rays(const GroundView&, const RayRows&, RayLanes&);                            \
  std::uint32_t merge_scatterers(ScattererLists&, std::uint32_t, std::uint32_t);                 \
  int aim_pixels(const PixelCamera&, const PixelList&, const AimedRays&);                        \
  void meet_ground(const GroundRays&, GroundHits&);                                              \
  void cast_ground(const GroundView&, const CastRays&);                                          \
  }
OBLIQ_DECLARE_LANES(sse)
OBLIQ_DECLARE_LANES(avx2)
OBLIQ_DECLARE_LANES(avx512)
#undef OBLIQ_DECLARE_LANES

}  // namespace obliq
