#include "server/stream/block.h"

#include <google/protobuf/message.h>

#include "proto/json_text.h"

namespace obliq::stream {

BlockPtr block_for_one(wire::MessageType type, const wire::Addressing& addressing,
                       const google::protobuf::Message& descriptor, bool as_json,
                       std::span<const std::byte> plane) {
  auto block = std::make_shared<Block>();
  block->type = type;
  block->stream_id = addressing.stream_id;
  block->sequence = addressing.sequence;
  block->plane_bytes = plane.size();
  if (as_json) {
    block->bytes.assign(plane.begin(), plane.end());
    block->json_head = wire::json_head(type, addressing, descriptor, plane.size());
  } else {
    block->bytes = wire::encode_message(type, addressing, descriptor, plane);
  }
  return block;
}

}  // namespace obliq::stream
