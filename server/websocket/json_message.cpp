#include "server/websocket/json_message.h"

#include <fmt/core.h>
#include <google/protobuf/message.h>

#include <algorithm>
#include <map>
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
  static const std::map<MessageType, const Message*> kExamples = {
      {MessageType::hello, &wire::Hello::default_instance()},
      {MessageType::welcome, &wire::Welcome::default_instance()},
      {MessageType::ack, &wire::Ack::default_instance()},
      {MessageType::error, &wire::Error::default_instance()},
      {MessageType::heartbeat, &wire::Heartbeat::default_instance()},
      {MessageType::list_radars, &wire::ListRadars::default_instance()},
      {MessageType::radar_list, &wire::RadarList::default_instance()},
      {MessageType::get_radar, &wire::GetRadar::default_instance()},
      {MessageType::radar_info, &wire::RadarInfo::default_instance()},
      {MessageType::claim_control, &wire::ClaimControl::default_instance()},
      {MessageType::release_control, &wire::ReleaseControl::default_instance()},
      {MessageType::set_settings, &wire::SetSettings::default_instance()},
      {MessageType::set_pose, &wire::SetPose::default_instance()},
      {MessageType::subscribe, &wire::Subscribe::default_instance()},
      {MessageType::unsubscribe, &wire::Unsubscribe::default_instance()},
      {MessageType::render_once, &wire::RenderOnce::default_instance()},
      {MessageType::get_status, &wire::GetStatus::default_instance()},
      {MessageType::status, &wire::Status::default_instance()},
      {MessageType::set_state, &wire::SetState::default_instance()},
      {MessageType::query_ground, &wire::QueryGround::default_instance()},
      {MessageType::ground_answer, &wire::GroundAnswer::default_instance()},
      {MessageType::set_replay, &wire::SetReplay::default_instance()},
      {MessageType::replay_state, &wire::ReplayState::default_instance()},
      {MessageType::set_targets, &wire::SetTargets::default_instance()},
      {MessageType::get_targets, &wire::GetTargets::default_instance()},
      {MessageType::target_list, &wire::TargetList::default_instance()},
      {MessageType::reset_exercise, &wire::ResetExercise::default_instance()},
      {MessageType::get_exercise, &wire::GetExercise::default_instance()},
      {MessageType::exercise_state, &wire::ExerciseState::default_instance()},
      {MessageType::load_exercise, &wire::LoadExercise::default_instance()},
      {MessageType::set_exercise, &wire::SetExercise::default_instance()},
      {MessageType::get_events, &wire::GetEvents::default_instance()},
      {MessageType::exercise_events, &wire::ExerciseEvents::default_instance()},
      {MessageType::add_bookmark, &wire::AddBookmark::default_instance()},
      {MessageType::frame_begin, &wire::FrameBegin::default_instance()},
      {MessageType::wedge_block, &wire::WedgeBlock::default_instance()},
      {MessageType::target_block, &wire::TargetBlock::default_instance()},
      {MessageType::frame_end, &wire::FrameEnd::default_instance()},
      {MessageType::frame_abort, &wire::FrameAbort::default_instance()},
  };
  const auto found = kExamples.find(type);
  return found == kExamples.end() ? nullptr : found->second;
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
