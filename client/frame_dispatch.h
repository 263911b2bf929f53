#pragma once
#include <cstddef>
#include <span>

#include "client/frame_handler.h"

namespace obliq::client {

/// Whether a message belongs to a frame.
bool is_frame(wire::MessageType type);

/// Parses a message of a frame, wherever it comes from, checks a block's length against its rectangle and
/// hands it to the handler. bad_stream when it does not parse; otherwise what the handler returns. Messages
/// that belong to no frame are skipped.
Status dispatch_frame(const wire::MessageHeader& header, std::span<const std::byte> descriptor,
                      std::span<const std::byte> plane, FrameHandler& to);

/// What to say of a message that does not parse.
Status unreadable(const char* what);

}  // namespace obliq::client
