#pragma once
#include "server/radar/bins.h"

namespace obliq::wire {
class FrameDescriptor;
}

namespace obliq {

/// The descriptor of a frame's window as if it were a frame of its own, so that bin k lies where its number
/// says: edges, widths and bin counts are the window's. Of every n bins one, each stands for all n, from its
/// own near or left edge on. A frame without a window stays as it is. Throws InputError for a window that
/// has no bin in its frame.
wire::FrameDescriptor placed_window(const wire::FrameDescriptor& descriptor);

}  // namespace obliq
