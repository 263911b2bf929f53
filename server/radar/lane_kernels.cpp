#include "server/radar/lane_kernels.h"

#include "server/scene/tracer_isa.h"

namespace obliq {

const std::vector<LaneKernels>& all_lane_kernels() {
  static const std::vector<LaneKernels> kernels = [] {
    std::vector<LaneKernels> here{{"sse", sse::speckle_lanes, sse::march_ground, sse::cut_ground}};
    if (has_isa(TracerIsa::avx2))
      here.push_back({"avx2", avx2::speckle_lanes, avx2::march_ground, avx2::cut_ground});
    if (has_isa(TracerIsa::avx512))
      here.push_back({"avx512", avx512::speckle_lanes, avx512::march_ground, avx512::cut_ground});
    return here;
  }();
  return kernels;
}

const LaneKernels& lane_kernels() {
  static const LaneKernels& widest = all_lane_kernels().back();
  return widest;
}

}  // namespace obliq
