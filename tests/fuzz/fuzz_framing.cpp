// Bytes as they come from a socket: headers, whole messages, every message's protobuf part, frames put
// together.
#include "client/frame_assembler.h"
#include "client/frame_dispatch.h"
#include "proto/limits.h"
#include "proto/message_codec.h"
#include "proto/obliq.pb.h"
#include "tests/fuzz/input.h"

namespace obliq {
namespace {

const fuzz::QuietProtobuf kQuiet;
constexpr std::uint64_t kMostFrameBytes = 1u << 20;

template <typename... Messages>
void parse_as_each(std::span<const std::byte> descriptor) {
  const auto parse = [&](auto message) {
    if (!wire::parse_descriptor(descriptor, message)) return;
    // What parses can be sent on.
    if (wire::encode_message(wire::MessageType::hello, {}, message).empty() &&
        message.ByteSizeLong() <= wire::kMaxDescriptorBytes) {
      fuzz::broken("a message that parses does not encode");
    }
  };
  (parse(Messages()), ...);
}

void check_header(const wire::MessageHeader& header, std::span<const std::byte> bytes) {
  wire::HeaderBytes encoded;
  wire::encode_header(header, encoded);
  wire::MessageHeader again;
  if (wire::decode_header(encoded, wire::kMaxPayloadBytes, again) != wire::HeaderStatus::ok ||
      again.sequence != header.sequence || again.utc_ns != header.utc_ns ||
      again.payload_length != header.payload_length) {
    fuzz::broken("a header that decodes does not come back");
  }
  if (bytes.size() < std::size_t{header.header_length} + header.payload_length) {
    fuzz::broken("a whole message is longer than its bytes");
  }
}

}  // namespace
}  // namespace obliq

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace obliq;
  const wire::Bytes bytes = fuzz::stream_of(data, size);

  client::FrameAssembler frames(wire::kEveryPlane, kMostFrameBytes);
  std::span<const std::byte> left(bytes);
  while (!left.empty()) {
    wire::MessageView view;
    const auto status = wire::decode_message(left, wire::kMaxPayloadBytes, view);
    if (status != wire::MessageStatus::ok) {
      left = left.subspan(1);
      continue;
    }
    check_header(view.header, left);
    parse_as_each<wire::Hello, wire::Welcome, wire::Ack, wire::Error, wire::RadarList, wire::RadarInfo,
                  wire::Status>(view.descriptor);
    (void)client::dispatch_frame(view.header, view.descriptor, view.plane, frames).ok();
    if (frames.state() == client::FrameAssembler::State::complete ||
        frames.state() == client::FrameAssembler::State::aborted) {
      (void)frames.take();
    }
    left = left.subspan(view.size);
  }
  return 0;
}
