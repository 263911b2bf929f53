#pragma once
#include "terrain/dem/load_report.h"

namespace obliq {
namespace wire {
class FrameDescriptor;
}

/// What the ground of a frame was made of, and what loading warned of. Lists that would fill the message are
/// cut: the log has them all.
void describe_load(const LoadReport& report, wire::FrameDescriptor& descriptor);

}  // namespace obliq
