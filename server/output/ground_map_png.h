#pragma once
#include <filesystem>

#include "server/output/ground_map.h"

namespace obliq::wire {
class FrameDescriptor;
class FrameSummary;
}  // namespace obliq::wire

namespace obliq {

/// Draws a ground map as a display would: brightness in dB, range rings, bearings, a legend, a caption. For
/// display only, magnitude is multiplied by r^2 (sensitivity time control) unless the frame is already
/// normalised, and the grey scale spans the 5th to the 99.7th percentile. Throws InputError.
void write_ground_map_png(const std::filesystem::path& path, const GroundMap& map,
                          const wire::FrameDescriptor& descriptor, const wire::FrameSummary& summary);

}  // namespace obliq
