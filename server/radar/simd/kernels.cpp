#include "server/radar/simd/kernels.h"

#include "server/scene/tracer_isa.h"

namespace obliq {

#define OBLIQ_LANE_KERNELS(isa)                                                                             \
  LaneKernels {                                                                                             \
#isa, isa::speckle_lanes, isa::march_ground, isa::cut_ground, isa::highest_ground, isa::march_profiles, \
        isa::place_samples, isa::merge_scatterers, isa::answer_rays, isa::meet_ground, isa::aim_pixels,     \
        isa::cast_ground                                                                                    \
  }

const std::vector<LaneKernels>& all_lane_kernels() {
  static const std::vector<LaneKernels> kernels = [] {
    std::vector<LaneKernels> here{OBLIQ_LANE_KERNELS(sse)};
    if (has_isa(TracerIsa::avx2)) here.push_back(OBLIQ_LANE_KERNELS(avx2));
    if (has_isa(TracerIsa::avx512)) here.push_back(OBLIQ_LANE_KERNELS(avx512));
    return here;
  }();
  return kernels;
}

const LaneKernels& lane_kernels() {
  static const LaneKernels& widest = all_lane_kernels().back();
  return widest;
}

}  // namespace obliq
