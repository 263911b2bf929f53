#pragma once
#include "client/frame_assembler.h"
#include "server/radar/bins.h"

namespace obliq {

/// A received frame's planes as the file writer takes them; they are moved out of the frame.
BinBlock take_bins(client::AssembledFrame& frame);

}  // namespace obliq
