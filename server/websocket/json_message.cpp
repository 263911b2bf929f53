#include "server/websocket/json_message.h"

#include <fmt/core.h>
#include <google/protobuf/util/json_util.h>

#include <algorithm>
#include <memory>
#include <string_view>

#include "proto/limits.h"
#include "proto/obliq.pb.h"
#include "server/websocket/json_writer.h"

namespace obliq::websocket {
namespace {

using google::protobuf::Message;
using wire::ErrorNumber;
using wire::MessageType;

/// What a message of a type is an example of; null: a later version's.
const Message* example_of(MessageType type) {
  switch (type) {
    case MessageType::hello:
      return &wire::Hello::default_instance();
    case MessageType::welcome:
      return &wire::Welcome::default_instance();
    case MessageType::ack:
      return &wire::Ack::default_instance();
    case MessageType::error:
      return &wire::Error::default_instance();
    case MessageType::heartbeat:
      return &wire::Heartbeat::default_instance();
    case MessageType::list_radars:
      return &wire::ListRadars::default_instance();
    case MessageType::radar_list:
      return &wire::RadarList::default_instance();
    case MessageType::get_radar:
      return &wire::GetRadar::default_instance();
    case MessageType::radar_info:
      return &wire::RadarInfo::default_instance();
    case MessageType::claim_control:
      return &wire::ClaimControl::default_instance();
    case MessageType::release_control:
      return &wire::ReleaseControl::default_instance();
    case MessageType::set_settings:
      return &wire::SetSettings::default_instance();
    case MessageType::set_pose:
      return &wire::SetPose::default_instance();
    case MessageType::subscribe:
      return &wire::Subscribe::default_instance();
    case MessageType::unsubscribe:
      return &wire::Unsubscribe::default_instance();
    case MessageType::render_once:
      return &wire::RenderOnce::default_instance();
    case MessageType::get_status:
      return &wire::GetStatus::default_instance();
    case MessageType::status:
      return &wire::Status::default_instance();
    case MessageType::set_state:
      return &wire::SetState::default_instance();
    case MessageType::set_replay:
      return &wire::SetReplay::default_instance();
    case MessageType::replay_state:
      return &wire::ReplayState::default_instance();
    case MessageType::query_ground:
      return &wire::QueryGround::default_instance();
    case MessageType::ground_answer:
      return &wire::GroundAnswer::default_instance();
    case MessageType::frame_begin:
      return &wire::FrameBegin::default_instance();
    case MessageType::wedge_block:
      return &wire::WedgeBlock::default_instance();
    case MessageType::frame_end:
      return &wire::FrameEnd::default_instance();
    case MessageType::frame_abort:
      return &wire::FrameAbort::default_instance();
  }
  return nullptr;
}

std::string_view text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Of objects and lists in each other, without regard to whether the JSON is whole.
int depth_of(std::string_view json) {
  int depth = 0, deepest = 0;
  bool in_text = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (in_text && c == '\\') {
      ++i;
    } else if (c == '"') {
      in_text = !in_text;
    } else if (!in_text && (c == '{' || c == '[')) {
      deepest = std::max(deepest, ++depth);
    } else if (!in_text && (c == '}' || c == ']')) {
      --depth;
    }
  }
  return deepest;
}

Refusal refusal_of_header(wire::HeaderStatus status, const wire::MessageHeader& header, std::uint32_t limit) {
  const auto number = status == wire::HeaderStatus::bad_magic          ? ErrorNumber::bad_magic
                      : status == wire::HeaderStatus::version_mismatch ? ErrorNumber::version_mismatch
                                                                       : ErrorNumber::bad_length;
  return {number, wire::describe(status, header, limit)};
}

/// JSON may be longer than kMaxDescriptorBytes, which is for protobuf.
bool only_descriptor_is_long(const wire::MessageHeader& header, std::uint32_t limit) {
  return header.header_length >= wire::kHeaderBytes && header.header_length <= wire::kMaxHeaderBytes &&
         header.payload_length <= limit && header.descriptor_length <= header.payload_length;
}

}  // namespace

std::optional<Refusal> to_binary(std::span<const std::byte> message, std::uint32_t max_request_bytes,
                                 wire::Bytes& binary) {
  if (message.size() < wire::kHeaderBytes)
    return Refusal{ErrorNumber::bad_length, fmt::format("a message of {} bytes; allowed: a header of {} and "
                                                        "what it announces, in one binary message",
                                                        message.size(), wire::kHeaderBytes)};
  wire::MessageHeader header;
  const auto status = wire::decode_header(message.first<wire::kHeaderBytes>(), max_request_bytes, header);
  if (status != wire::HeaderStatus::ok &&
      !(status == wire::HeaderStatus::bad_length && only_descriptor_is_long(header, max_request_bytes)))
    return refusal_of_header(status, header, max_request_bytes);
  if (message.size() != std::size_t{header.header_length} + header.payload_length)
    return Refusal{ErrorNumber::bad_length,
                   fmt::format("a message of {} bytes; allowed: the {} that its header announces",
                               message.size(), header.header_length + header.payload_length)};
  if ((header.flags & kJsonDescriptor) == 0)
    return Refusal{ErrorNumber::bad_message,
                   fmt::format("the header's flags are {}; allowed: bit 0 set, since in {} a descriptor is "
                               "JSON",
                               header.flags, kSubprotocol)};
  const auto payload = message.subspan(header.header_length);
  const std::string_view json = text_of(payload.first(header.descriptor_length));
  if (const int depth = depth_of(json); depth > kMaxDepth)
    return Refusal{ErrorNumber::bad_message,
                   fmt::format("JSON of depth {}; allowed: at most {}", depth, kMaxDepth)};
  const wire::Addressing addressing{header.stream_id, header.sequence, header.utc_ns};
  const Message* example = example_of(header.type);
  if (example == nullptr) {  // it will be skipped
    binary = wire::encode_message(header.type, addressing, wire::Ack::default_instance());
    return std::nullopt;
  }
  const std::unique_ptr<Message> descriptor(example->New());
  const auto parsed =
      google::protobuf::util::JsonStringToMessage({json.data(), json.size()}, descriptor.get(), {});
  if (!parsed.ok()) {
    // The lines after the first show where, with whatever the peer sent.
    std::string why(parsed.message().data(), parsed.message().size());
    why.resize(std::min(why.find('\n'), why.size()));
    if (why.ends_with('.')) why.pop_back();
    return Refusal{ErrorNumber::bad_message,
                   fmt::format("the JSON of {}: {}; allowed: the fields and values that obliq.proto has",
                               descriptor->GetDescriptor()->name(), why)};
  }
  binary =
      wire::encode_message(header.type, addressing, *descriptor, payload.subspan(header.descriptor_length));
  if (!binary.empty()) return std::nullopt;
  return Refusal{ErrorNumber::bad_length,
                 fmt::format("a descriptor of {} bytes as protobuf; allowed: at most {}",
                             descriptor->ByteSizeLong(), wire::kMaxDescriptorBytes)};
}

bool to_json(std::span<const std::byte> message, JsonMessage& json) {
  wire::MessageHeader header;
  if (message.size() < wire::kHeaderBytes) return false;
  const auto status =
      wire::decode_header(message.first<wire::kHeaderBytes>(), wire::kMaxPayloadBytes, header);
  const Message* example = example_of(header.type);
  if (status != wire::HeaderStatus::ok || example == nullptr ||
      message.size() != std::size_t{header.header_length} + header.payload_length)
    return false;
  const auto payload = message.subspan(header.header_length);
  const std::unique_ptr<Message> descriptor(example->New());
  if (!wire::parse_descriptor(payload.first(header.descriptor_length), *descriptor)) return false;
  json.plane = payload.subspan(header.descriptor_length);
  json.head.assign(wire::kHeaderBytes, '\0');
  append_json(*descriptor, json.head);
  header.header_length = wire::kHeaderBytes;
  header.descriptor_length = static_cast<std::uint32_t>(json.head.size() - wire::kHeaderBytes);
  header.payload_length = header.descriptor_length + static_cast<std::uint32_t>(json.plane.size());
  header.flags |= kJsonDescriptor;
  header.crc = 0;
  const std::span<std::byte> head = std::as_writable_bytes(std::span(json.head));
  wire::encode_header(header, head.first<wire::kHeaderBytes>());
  return true;
}

}  // namespace obliq::websocket
