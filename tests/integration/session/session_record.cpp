#include "tests/integration/session/session_record.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <fstream>
#include <memory>
#include <string_view>

#include "proto/limits.h"
#include "proto/obliq.pb.h"
#include "proto/plane_coding.h"
#include "tests/support/fnv1a.h"

namespace obliq::test {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using wire::MessageType;

enum class Mask {
  none,
  one,        ///< a time or an amount: 1 unless it is 0
  gone,       ///< may be 0 or not
  star,       ///< a sentence or a secret: "*" unless it is empty
  no_address  ///< a name, then the address in brackets
};

Mask mask_of(const std::string& field) {
  static const std::map<std::string_view, Mask> masks{{"pose_received_ns", Mask::one},
                                                      {"render_start_ns", Mask::one},
                                                      {"send_ns", Mask::one},
                                                      {"beam_ns", Mask::one},
                                                      {"begin_ns", Mask::one},
                                                      {"render_s", Mask::one},
                                                      {"waited_s", Mask::one},
                                                      {"last_render_s", Mask::one},
                                                      {"uptime_s", Mask::one},
                                                      {"bytes_sent", Mask::one},
                                                      {"live_frames", Mask::gone},
                                                      {"live_bytes", Mask::gone},
                                                      {"server_version", Mask::star},
                                                      {"token", Mask::star},
                                                      {"text", Mask::star},
                                                      {"reason", Mask::star},
                                                      {"warnings", Mask::star},
                                                      {"found", Mask::star},
                                                      {"allowed", Mask::star},
                                                      {"fault", Mask::star},
                                                      {"coverage_reason", Mask::star},
                                                      {"window_error", Mask::star},
                                                      {"window_failure", Mask::star},
                                                      {"client_name", Mask::no_address},
                                                      {"controller", Mask::no_address},
                                                      {"settings_controller", Mask::no_address},
                                                      {"by", Mask::no_address},
                                                      {"taken_from", Mask::no_address},
                                                      {"utc_ns", Mask::one},
                                                      {"build", Mask::star}};
  const auto at = masks.find(field);
  return at == masks.end() ? Mask::none : at->second;
}

std::string masked(Mask mask, const std::string& text) {
  if (mask == Mask::no_address) return text.substr(0, text.find(" ("));
  return text.empty() ? "" : "*";
}

void set_one(Message& message, const FieldDescriptor& field) {
  const auto& reflection = *message.GetReflection();
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return reflection.SetDouble(&message, &field, 1);
    case FieldDescriptor::CPPTYPE_INT64:
      return reflection.SetInt64(&message, &field, 1);
    case FieldDescriptor::CPPTYPE_UINT64:
      return reflection.SetUInt64(&message, &field, 1);
    default:
      ADD_FAILURE() << "no mask for the type of " << field.full_name();
  }
}

void mask_fields(Message& message) {
  const auto& reflection = *message.GetReflection();
  std::vector<const FieldDescriptor*> fields;
  reflection.ListFields(message, &fields);
  for (const FieldDescriptor* field : fields) {
    if (field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) {
      if (!field->is_repeated()) mask_fields(*reflection.MutableMessage(&message, field));
      for (int k = 0; field->is_repeated() && k < reflection.FieldSize(message, field); ++k)
        mask_fields(*reflection.MutableRepeatedMessage(&message, field, k));
      continue;
    }
    const Mask mask = mask_of(field->name());
    if (mask == Mask::none) continue;
    if (mask == Mask::gone) {
      reflection.ClearField(&message, field);
    } else if (mask == Mask::one) {
      set_one(message, *field);
    } else if (field->is_repeated()) {
      for (int k = 0; k < reflection.FieldSize(message, field); ++k)
        reflection.SetRepeatedString(&message, field, k,
                                     masked(mask, reflection.GetRepeatedString(message, field, k)));
    } else {
      reflection.SetString(&message, field, masked(mask, reflection.GetString(message, field)));
    }
  }
}

std::string hash_of(std::span<const std::byte> bytes) {
  Fnv1a sum;
  sum.add(std::vector<std::byte>(bytes.begin(), bytes.end()));
  char text[17];
  std::snprintf(text, sizeof text, "%016" PRIx64, sum.sum());
  return text;
}

std::string text_of(const Message& message) {
  google::protobuf::TextFormat::Printer printer;
  printer.SetSingleLineMode(true);
  std::string text;
  printer.PrintToString(message, &text);
  if (!text.empty() && text.back() == ' ') text.pop_back();
  return "{" + text + "}";
}

/// " 512 bytes HASH", of a WedgeBlock's values.
std::string values_of(const wire::WedgeBlock& block, std::span<const std::byte> payload) {
  EXPECT_EQ(wire::fault_of_block(block, payload.size()), "");
  std::vector<std::byte> plain(block.plain_bytes());
  if (block.compression() == wire::ZSTD) {
    EXPECT_TRUE(wire::decompress(payload, plain));
    payload = plain;
  }
  return " " + std::to_string(payload.size()) + " bytes " + hash_of(payload);
}

/// How a line begins, and what it says from a little before the first difference on: that of the fields, if
/// there is one, which says more than that of the hashes.
std::string from_difference(const std::string& line, const std::string& other) {
  const auto fields = [](const std::string& of) { return of.substr(std::min(of.find('{'), of.size())); };
  const std::string text = fields(line) == fields(other) ? line : fields(line);
  const std::string other_text = fields(line) == fields(other) ? other : fields(other);
  const auto at = static_cast<std::size_t>(std::ranges::mismatch(text, other_text).in1 - text.begin());
  return line.substr(0, 30) + " ... " + text.substr(at < 60 ? 0 : at - 60, 160);
}

}  // namespace

std::unique_ptr<Message> empty_message(MessageType type) {
  const auto* named = wire::Hello::descriptor()->file()->FindMessageTypeByName(facts_of(type).name);
  return std::unique_ptr<Message>(
      google::protobuf::MessageFactory::generated_factory()->GetPrototype(named)->New());
}

// No default: a new type must be named here, and then come in the session.
TypeFacts facts_of(MessageType type) {
  switch (type) {
    case MessageType::hello:
      return {"Hello", true, false};
    case MessageType::welcome:
      return {"Welcome", false, true};
    case MessageType::ack:
      return {"Ack", false, true};
    case MessageType::error:
      return {"Error", true, true};
    case MessageType::heartbeat:
      return {"Heartbeat", true, true};
    case MessageType::list_radars:
      return {"ListRadars", true, false};
    case MessageType::radar_list:
      return {"RadarList", false, true};
    case MessageType::get_radar:
      return {"GetRadar", true, false};
    case MessageType::radar_info:
      return {"RadarInfo", false, true};
    case MessageType::claim_control:
      return {"ClaimControl", true, false};
    case MessageType::release_control:
      return {"ReleaseControl", true, false};
    case MessageType::set_settings:
      return {"SetSettings", true, false};
    case MessageType::set_pose:
      return {"SetPose", true, false};
    case MessageType::subscribe:
      return {"Subscribe", true, false};
    case MessageType::unsubscribe:
      return {"Unsubscribe", true, false};
    case MessageType::render_once:
      return {"RenderOnce", true, false};
    case MessageType::get_status:
      return {"GetStatus", true, false};
    case MessageType::status:
      return {"Status", false, true};
    case MessageType::set_state:
      return {"SetState", true, false};
    case MessageType::query_ground:
      return {"QueryGround", true, false};
    case MessageType::ground_answer:
      return {"GroundAnswer", false, true};
    case MessageType::set_replay:
      return {"SetReplay", true, false};
    case MessageType::replay_state:
      return {"ReplayState", false, false};  // of a replay alone
    case MessageType::reset_exercise:
      return {"ResetExercise", true, false};
    case MessageType::get_exercise:
      return {"GetExercise", true, false};
    case MessageType::exercise_state:
      return {"ExerciseState", false, true};
    case MessageType::load_exercise:
      return {"LoadExercise", true, false};
    case MessageType::set_exercise:
      return {"SetExercise", true, false};
    case MessageType::get_events:
      return {"GetEvents", true, false};
    case MessageType::exercise_events:
      return {"ExerciseEvents", false, true};
    case MessageType::add_bookmark:
      return {"AddBookmark", true, false};
    case MessageType::set_targets:
      return {"SetTargets", true, false};
    case MessageType::get_targets:
      return {"GetTargets", true, false};
    case MessageType::target_list:
      return {"TargetList", false, true};
    case MessageType::target_block:
      return {"TargetBlock", false, true};
    case MessageType::frame_begin:
      return {"FrameBegin", false, true};
    case MessageType::wedge_block:
      return {"WedgeBlock", false, true};
    case MessageType::frame_end:
      return {"FrameEnd", false, true};
    case MessageType::frame_abort:
      return {"FrameAbort", false, true};
  }
  return {};
}

void SessionRecord::sent(const std::string& who, MessageType type, const Message& message) {
  sent_.insert(type);
  const std::unique_ptr<Message> shown(message.New());
  shown->CopyFrom(message);
  mask_fields(*shown);
  note(who + " > " + facts_of(type).name + " " + text_of(*shown));
}

bool SessionRecord::received(const std::string& who, const wire::MessageView& view) {
  const wire::MessageHeader& header = view.header;
  const TypeFacts facts = facts_of(header.type);
  EXPECT_NE(facts.name, nullptr) << "message type " << static_cast<unsigned>(header.type);
  if (facts.name == nullptr) return false;
  received_.insert(header.type);
  if (header.type == MessageType::frame_end) ended_[header.stream_id].insert(header.sequence);
  EXPECT_EQ(header.flags, 0);
  EXPECT_EQ(header.header_length, wire::kHeaderBytes);
  EXPECT_GT(header.utc_ns, 0);
  const std::unique_ptr<Message> message = empty_message(header.type);
  EXPECT_TRUE(wire::parse_descriptor(view.descriptor, *message));
  const std::string again = message->SerializeAsString();
  EXPECT_TRUE(std::ranges::equal(std::as_bytes(std::span(again)), view.descriptor))
      << facts.name << ": its bytes, read and written again, are others";
  std::string values;
  if (header.type == MessageType::wedge_block) {
    values = values_of(dynamic_cast<const wire::WedgeBlock&>(*message), view.plane);
  } else if (header.type == MessageType::ground_answer || header.type == MessageType::target_block) {
    // The last bits of places are the C library's; ground_query_test.cpp and targets_test.cpp have their
    // values.
    values = " " + std::to_string(view.plane.size()) + " bytes";
  } else {
    EXPECT_TRUE(view.plane.empty());
  }
  mask_fields(*message);
  const std::string bytes = message->SerializeAsString();
  note(who + " < " + facts.name + " " + std::to_string(header.stream_id) + "/" +
       std::to_string(header.sequence) + " " + hash_of(std::as_bytes(std::span(bytes))) + values + " " +
       text_of(*message));
  return true;
}

std::uint64_t SessionRecord::frames_ended(std::uint32_t stream_id) const {
  const auto at = ended_.find(stream_id);
  return at == ended_.end() ? 0 : at->second.size();
}

void SessionRecord::write(const std::string& file) const {
  std::ofstream written(file);
  written << "# A session, a line a message (session_record.h). Written by session_bytes_test, see there.\n";
  for (const std::string& line : lines_) written << line << '\n';
}

void SessionRecord::compare(const std::string& file, const std::string& until) const {
  std::ifstream opened(file);
  std::string line;
  ASSERT_TRUE(std::getline(opened, line)) << file;  // what it is
  int differences = 0;
  for (std::size_t k = 0; k < lines_.size() && differences < 3; ++k) {
    if (!std::getline(opened, line)) line = "(nothing)";
    if (lines_[k] == line) continue;
    ++differences;
    ADD_FAILURE() << file << ":" << k + 2 << "\n  found    " << from_difference(lines_[k], line)
                  << "\n  recorded " << from_difference(line, lines_[k]);
  }
  if (differences > 0) ADD_FAILURE() << "if it should: cmake --build --preset release --target generated";
  if (differences == 0) {
    const bool more = static_cast<bool>(std::getline(opened, line));
    EXPECT_TRUE(more ? line == until : until.empty()) << file << " has more: " << line.substr(0, 100);
  }
}

}  // namespace obliq::test
