#pragma once
#include <cstdint>

#include "server/radar/settings.h"

namespace obliq {

/// Whether a frame of these settings has to tell materials apart, as labels do, where its scene has a sea.
bool may_need_materials(const RadarSettings& settings);

/// An upper estimate of the memory that a thread needs for its wedge: bins, profiles, scatterers, samples
/// that wait, and hits. It leaves out the scene, the frame's plan and planes that wait to be sent.
/// label_materials: of a scene whose labels are wanted, or which may_need_materials(); 0: none are.
std::int64_t wedge_bytes(const RadarSettings& settings, int label_materials = 0);

/// What a rendering by so many threads takes at once, wherever the antenna is.
struct RenderingSize {
  /// Their wedges; behind a beam also its plan, each thread's sums, and the sharp wedges that they add up.
  std::int64_t bytes = 0;
  std::int64_t plan_taps = 0;  ///< weights of the beam's plan; 0: there is none
};
RenderingSize rendering_size(const RadarSettings& settings, std::int64_t threads, int label_materials = 0);

}  // namespace obliq
