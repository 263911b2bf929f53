#include "client/frame_dispatch.h"

#include "proto/message_codec.h"
#include "proto/obliq.pb.h"
#include "proto/plane_coding.h"

namespace obliq::client {

using wire::MessageType;

namespace {

Status check_block(std::span<const std::byte> descriptor, std::span<const std::byte> values,
                   wire::WedgeBlock& block) {
  if (!wire::parse_descriptor(descriptor, block)) return unreadable("WedgeBlock");
  const std::string fault = wire::fault_of_block(block, values.size());
  return fault.empty() ? Status() : Status::failure(Outcome::bad_stream, "from the server: " + fault);
}

}  // namespace

Status unreadable(const char* what) {
  return Status::failure(Outcome::bad_stream,
                         std::string("a message from the server does not parse: ") + what);
}

bool is_frame(MessageType type) {
  return type >= MessageType::frame_begin && type <= MessageType::target_block;
}

Status dispatch_frame(const wire::MessageHeader& header, std::span<const std::byte> descriptor,
                      std::span<const std::byte> plane, FrameHandler& to) {
  switch (header.type) {
    case MessageType::frame_begin: {
      wire::FrameBegin begin;
      if (!wire::parse_descriptor(descriptor, begin)) return unreadable("FrameBegin");
      return to.on_begin(header, begin);
    }
    case MessageType::wedge_block: {
      wire::WedgeBlock block;
      if (Status status = check_block(descriptor, plane, block); !status.ok()) return status;
      return to.on_block(header, block, plane);
    }
    case MessageType::target_block: {
      wire::TargetBlock block;
      std::vector<wire::TargetRecord> records;
      if (!wire::parse_descriptor(descriptor, block) ||
          !wire::decode_target_records(plane, block.records(), block.record_bytes(), records))
        return unreadable("TargetBlock");
      return to.on_targets(header, block, records);
    }
    case MessageType::frame_end: {
      wire::FrameEnd end;
      if (!wire::parse_descriptor(descriptor, end)) return unreadable("FrameEnd");
      return to.on_end(header, end);
    }
    case MessageType::frame_abort: {
      wire::FrameAbort abort;
      if (!wire::parse_descriptor(descriptor, abort)) return unreadable("FrameAbort");
      return to.on_abort(header, abort);
    }
    default:
      return {};
  }
}

}  // namespace obliq::client
