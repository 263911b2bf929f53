#pragma once
#include <string>
#include <vector>

#include "server/radar/bins.h"

namespace obliq::wire {
class FrameDescriptor;
class FrameSummary;
}  // namespace obliq::wire

namespace obliq {

class FramePlan;

/// Fills the descriptor that the files and the stream share; everything known before the first wedge.
void describe_frame(const FramePlan& plan, const std::string& radar, const std::string& scene_name,
                    wire::FrameDescriptor& descriptor);

/// Fills the summary that is known after the last wedge.
void summarise_frame(const FramePlan& plan, const FrameStats& stats, wire::FrameSummary& summary);

/// All that is to be warned of in a frame: the descriptor's, and sector without ground.
std::vector<std::string> frame_warnings(const wire::FrameDescriptor& descriptor,
                                        const wire::FrameSummary& summary);

}  // namespace obliq
