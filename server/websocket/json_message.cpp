#include "server/websocket/json_message.h"

#include <fmt/core.h>
#include <google/protobuf/message.h>

#include <algorithm>
#include <memory>
#include <string_view>
#include <utility>

#include "proto/limits.h"
#include "proto/obliq.pb.h"
#include "server/websocket/json_reader.h"

namespace obliq::websocket {
namespace {

using google::protobuf::Message;
using wire::ErrorNumber;
using wire::MessageType;

std::string_view text_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Whether some number has more characters than any needs: of a million, reading takes 17 ms.
bool has_long_number(std::string_view json) {
  constexpr std::size_t kLongest = 100;
  constexpr std::string_view kOfNumbers = "0123456789+-.eE";
  std::size_t begin = 0;
  while ((begin = json.find_first_of(kOfNumbers, begin)) != std::string_view::npos) {
    const std::size_t end = std::min(json.find_first_not_of(kOfNumbers, begin), json.size());
    if (end - begin > kLongest) return true;
    begin = end;
  }
  return false;
}

Refusal refusal_of_header(wire::HeaderStatus status, const wire::MessageHeader& header,
                          const wire::MessageLimits& limits) {
  const auto number = status == wire::HeaderStatus::bad_magic          ? ErrorNumber::bad_magic
                      : status == wire::HeaderStatus::version_mismatch ? ErrorNumber::version_mismatch
                                                                       : ErrorNumber::bad_length;
  return {number, wire::describe(status, header, limits)};
}

}  // namespace

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

std::optional<Refusal> to_binary(std::span<const std::byte> message, const wire::MessageLimits& limits,
                                 wire::Bytes& binary) {
  if (message.size() < wire::kHeaderBytes)
    return Refusal{ErrorNumber::bad_length, fmt::format("a message of {} bytes; allowed: a header of {} and "
                                                        "what it announces, in one binary message",
                                                        message.size(), wire::kHeaderBytes)};
  wire::MessageHeader header;
  // JSON may be longer than the protobuf that it stands for.
  const wire::MessageLimits as_json(limits.payload_bytes, limits.payload_bytes);
  const auto status = wire::decode_header(message.first<wire::kHeaderBytes>(), as_json, header);
  if (status != wire::HeaderStatus::ok) return refusal_of_header(status, header, as_json);
  if (message.size() != std::size_t{header.header_length} + header.payload_length)
    return Refusal{ErrorNumber::bad_length,
                   fmt::format("a message of {} bytes; allowed: the {} that its header announces",
                               message.size(), header.header_length + header.payload_length)};
  if ((header.flags & wire::kJsonDescriptor) == 0)
    return Refusal{ErrorNumber::bad_message,
                   fmt::format("the header's flags are {}; allowed: bit 0 set, since in {} a descriptor is "
                               "JSON",
                               header.flags, kSubprotocol)};
  const auto payload = message.subspan(header.header_length);
  const wire::Addressing addressing{header.stream_id, header.sequence, header.utc_ns};
  const Message* example = example_of(header.type);
  if (example == nullptr) {  // it will be skipped
    binary = wire::encode_message(header.type, addressing, wire::Ack::default_instance());
    return std::nullopt;
  }
  const std::string_view json = text_of(payload.first(header.descriptor_length));
  if (json.size() > kMaxJsonBytes && (header.type != MessageType::query_ground || has_long_number(json)))
    return Refusal{ErrorNumber::bad_length,
                   fmt::format("JSON of {} bytes; allowed: at most {}, but for QueryGround's lists",
                               json.size(), kMaxJsonBytes)};
  const std::unique_ptr<Message> descriptor(example->New());
  if (const auto why = read_json(json, *descriptor))
    return Refusal{ErrorNumber::bad_message,
                   fmt::format("the JSON of {}: {}", descriptor->GetDescriptor()->name(), *why)};
  auto encoded = wire::encode_message(header.type, addressing, *descriptor,
                                      payload.subspan(header.descriptor_length), limits.descriptor_bytes);
  if (encoded.empty())
    return Refusal{
        ErrorNumber::bad_length,
        fmt::format("a descriptor of {} bytes as protobuf and {} behind it; allowed: at most {} and {}",
                    descriptor->ByteSizeLong(), header.payload_length - header.descriptor_length,
                    limits.descriptor_bytes, wire::kMaxPlaneBytes)};
  binary = std::move(encoded);
  return std::nullopt;
}

}  // namespace obliq::websocket
