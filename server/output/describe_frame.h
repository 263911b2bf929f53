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
class Receiver;
class Scene;

/// Of what a scene's world is made from and of its materials, as FrameDescriptor has it; empty for a world
/// that was not loaded from a scene.
std::string scene_hash(const Scene& scene);

/// Fills the descriptor that the files and the stream share; everything known before the first wedge.
void describe_frame(const FramePlan& plan, const std::string& radar, const std::string& scene_name,
                    wire::FrameDescriptor& descriptor);

/// Adds what the frame's receiver does to its bins.
void describe_receiver(const Receiver& receiver, wire::FrameDescriptor& descriptor);

/// Fills the summary that is known after the last wedge.
void summarise_frame(const FramePlan& plan, const FrameStats& stats, wire::FrameSummary& summary);

/// All that is to be warned of in a frame: the descriptor's, and sector without ground.
std::vector<std::string> frame_warnings(const wire::FrameDescriptor& descriptor,
                                        const wire::FrameSummary& summary);

/// frame.json: every field of descriptor and summary under its protobuf name, the planes that have files,
/// notes on what is not plain, and last the bin edges. Numbers are written so that they read back to the same
/// double; infinity, which JSON lacks, as null.
std::string frame_json(const wire::FrameDescriptor& descriptor, const wire::FrameSummary& summary,
                       const std::vector<std::string>& planes);

/// A bearing as an operator reads it: 0 to 360.
double compass_deg(double bearing_deg);

}  // namespace obliq
