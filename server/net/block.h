#pragma once
#include <cstdint>
#include <memory>

#include "proto/message_codec.h"
#include "proto/plane.h"

namespace obliq::net {

/// An encoded message of a frame, shared by all clients it goes to. Never changes once made.
struct Block {
  wire::Bytes bytes;
  wire::MessageType type{};
  wire::PlaneSet planes = 0;  ///< wedge_block: its plane; frame_begin: the planes that will follow
  std::uint32_t stream_id = 0;
  std::uint64_t frame_id = 0;
  std::uint64_t sequence = 0;
};
using BlockPtr = std::shared_ptr<const Block>;

}  // namespace obliq::net
