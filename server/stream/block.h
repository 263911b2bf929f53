#pragma once
#include <cstdint>
#include <memory>

#include "proto/message_codec.h"
#include "proto/plane.h"
#include "server/stream/live_frames.h"
#include "server/stream/stream_choice.h"

namespace obliq::net {

/// An encoded message of a frame, shared by all clients it goes to. Never changes once made.
struct Block {
  Block() = default;
  ~Block() {
    if (!meter) return;
    --meter->blocks;
    meter->bytes -= bytes.size();
  }
  Block(const Block&) = delete;
  Block& operator=(const Block&) = delete;

  wire::Bytes bytes;
  wire::MessageType type{};
  wire::PlaneSet planes = 0;  ///< wedge_block: its plane; frame_begin: the planes that will follow
  BlockFormat format;         ///< wedge_block: as of its plane; frame_begin: its window alone counts
  std::uint32_t stream_id = 0;
  std::uint64_t frame_id = 0;
  std::uint64_t sequence = 0;
  std::shared_ptr<BlockMeter> meter;  ///< counts it; may be null
};
using BlockPtr = std::shared_ptr<const Block>;

}  // namespace obliq::net
