#pragma once
// Frames through the server's encoder and the client's assembler.
#include "client/frame_assembler.h"
#include "server/stream/frame_encoder.h"

namespace obliq::net {

/// Decodes a block as a client does and hands it on.
client::Status feed(client::FrameAssembler& frames, const stream::Block& block);

/// Bins whose values tell where they belong.
BinBlock filled(int first, int n_azimuth, int n_range);

wire::FrameDescriptor descriptor(int n_azimuth, int n_range);

}  // namespace obliq::net
