#pragma once
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include "proto/message_codec.h"
#include "proto/plane.h"
#include "server/stream/spare_memory.h"
#include "server/stream/stream_choice.h"

namespace google::protobuf {
class Message;
}

namespace obliq::stream {

/// Memory that a radar's blocks take, wherever they wait, and what those left that have gone. From any
/// thread.
struct BlockMeter {
  std::atomic<std::size_t> blocks{0};
  std::atomic<std::size_t> bytes{0};
  SpareMemory spare;
};

/// An encoded message, shared by all clients it goes to. Never changes once made.
struct Block {
  Block() = default;
  ~Block() {
    if (!meter) return;
    --meter->blocks;
    meter->bytes -= memory();
    meter->spare.give(std::move(bytes));
  }
  Block(const Block&) = delete;
  Block& operator=(const Block&) = delete;

  std::span<const std::byte> plane() const { return std::span(bytes).last(plane_bytes); }
  std::size_t memory() const { return bytes.size() + json_head.size(); }
  /// How many are sent to a client.
  std::size_t sent_bytes(bool as_json) const {
    return as_json ? json_head.size() + plane_bytes : bytes.size();
  }

  wire::Bytes bytes;      ///< the message, its plane at the end; of one for a browser alone only the plane
  std::string json_head;  ///< wire::json_head, for all browsers; empty: none gets the message
  std::size_t plane_bytes = 0;
  wire::MessageType type{};
  wire::PlaneSet planes = 0;  ///< wedge_block: its plane; frame_begin: the planes that will follow
  BlockFormat format;         ///< wedge_block: as of its plane; frame_begin: its window alone counts
  std::uint32_t stream_id = 0;
  std::uint64_t frame_id = 0;
  std::uint64_t sequence = 0;
  std::shared_ptr<BlockMeter> meter;  ///< counts it; may be null
};
using BlockPtr = std::shared_ptr<const Block>;

/// A message for one client, in the one form that it reads.
BlockPtr block_for_one(wire::MessageType type, const wire::Addressing& addressing,
                       const google::protobuf::Message& descriptor, bool as_json,
                       std::span<const std::byte> plane = {});

}  // namespace obliq::stream
