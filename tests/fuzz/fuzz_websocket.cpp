// What a WebSocket's message may hold. First byte: bit 0 gives the message a header that fits, of the type in
// the second byte, and the rest is its JSON; else the rest is the whole message. What is let in must be a
// message of the stream, the one that protobuf's own reader makes of it, and must come back the same from
// JSON. The seeds are two bytes and JSON by hand.
#include <google/protobuf/message.h>
#include <google/protobuf/util/json_util.h>

#include <algorithm>
#include <memory>
#include <string>

#include "proto/json_text.h"
#include "proto/limits.h"
#include "server/websocket/json_message.h"
#include "tests/fuzz/input.h"

namespace obliq::websocket {
namespace {

constexpr std::uint32_t kMostBytes = 1 << 16;

wire::Bytes message_of(fuzz::Input input) {
  const bool mended = (input.u8() & 1) != 0;
  wire::MessageHeader header{.type = static_cast<wire::MessageType>(mended ? input.u8() : 0),
                             .flags = wire::kJsonDescriptor};
  const auto rest = input.rest();
  if (!mended) return {rest.begin(), rest.end()};
  header.payload_length = header.descriptor_length = static_cast<std::uint32_t>(rest.size());
  wire::Bytes bytes(wire::kHeaderBytes);
  wire::encode_header(header, std::span(bytes).first<wire::kHeaderBytes>());
  bytes.insert(bytes.end(), rest.begin(), rest.end());
  return bytes;
}

/// What is let in protobuf takes as well, and takes it for the same.
void compare(std::span<const std::byte> message, const wire::MessageView& view) {
  const auto* example = example_of(view.header.type);
  if (example == nullptr) return;
  wire::MessageHeader header;
  (void)wire::decode_header(message.first<wire::kHeaderBytes>(), {kMostBytes, kMostBytes}, header);
  const auto json = message.subspan(header.header_length, header.descriptor_length);
  const std::unique_ptr<google::protobuf::Message> descriptor(example->New());
  const auto read = google::protobuf::util::JsonStringToMessage(
      {reinterpret_cast<const char*>(json.data()), json.size()}, descriptor.get());
  if (!read.ok()) fuzz::broken("protobuf refuses what was let in");
  const std::string bytes = descriptor->SerializeAsString();
  if (!std::ranges::equal(view.descriptor, std::as_bytes(std::span(bytes))))
    fuzz::broken("protobuf reads another message");
}

void run(fuzz::Input input) {
  const wire::Bytes message = message_of(input);
  wire::Bytes binary;
  if (const auto refusal = to_binary(message, kMostBytes, binary)) {
    if (refusal->text.empty() || refusal->number == wire::ErrorNumber::none)
      fuzz::broken("refused without words");
    return;
  }
  wire::MessageView view;
  if (wire::decode_message(binary, wire::kMaxPayloadBytes, view) != wire::MessageStatus::ok)
    fuzz::broken("what was let in is no message");
  compare(message, view);
  const auto* example = example_of(view.header.type);
  if (example == nullptr) return;  // a type of a later version
  const std::unique_ptr<google::protobuf::Message> descriptor(example->New());
  if (!wire::parse_descriptor(view.descriptor, *descriptor)) fuzz::broken("what was let in does not parse");
  const std::string head =
      wire::json_head(view.header.type, {view.header.stream_id, view.header.sequence, view.header.utc_ns},
                      *descriptor, view.plane.size());
  const auto head_bytes = std::as_bytes(std::span(head));
  wire::Bytes again(head_bytes.begin(), head_bytes.end());
  again.insert(again.end(), view.plane.begin(), view.plane.end());
  wire::Bytes back;
  if (to_binary(again, wire::kMaxPayloadBytes * 8, back)) fuzz::broken("our own JSON is refused");
  if (back != binary) fuzz::broken("there and back is another message");
}

}  // namespace
}  // namespace obliq::websocket

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  const obliq::fuzz::QuietProtobuf quiet;
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  obliq::websocket::run(obliq::fuzz::Input(data, size));
  return 0;
}
