// JSON descriptors: every message type with every field, against protobuf's own JSON, and the message that
// PROTOCOL.md prints.
#include "server/websocket/json_message.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/util/json_util.h>
#include <google/protobuf/util/message_differencer.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <random>

#include "proto/json_text.h"
#include "proto/limits.h"
#include "proto/obliq.pb.h"
#include "server/websocket/json_reader.h"
#include "tests/integration/web_peer.h"

namespace obliq::websocket::json_message_test {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using wire::MessageType;

/// Fills a message with numbers that are hard to write: the smallest, the largest, halves, none at all.
class Filler {
 public:
  explicit Filler(unsigned seed) : random_(seed) {}

  void fill(Message& message, int depth = 0) {
    const auto& reflection = *message.GetReflection();
    for (int i = 0; i < message.GetDescriptor()->field_count(); ++i) {
      const FieldDescriptor* field = message.GetDescriptor()->field(i);
      if (random_() % 4 == 0 || depth > 4) continue;
      const int n = field->is_repeated() ? static_cast<int>(random_() % 3) : 1;
      for (int k = 0; k < n; ++k) set(message, reflection, field, depth);
    }
  }

 private:
  template <class Number>
  Number number() {
    using Limits = std::numeric_limits<Number>;
    switch (random_() % 8) {
      case 0:
        return 0;
      case 1:
        return Limits::max();
      case 2:
        return Limits::lowest();
      case 3:
        return Limits::is_integer ? Number{1} : Limits::infinity();
      case 4:
        return Limits::is_integer ? Number{7} : Limits::denorm_min();
      default:
        return static_cast<Number>(static_cast<double>(random_()) / 7);
    }
  }
  double real() { return random_() % 16 == 0 ? -0.0 : number<double>(); }

  void set(Message& message, const google::protobuf::Reflection& reflection, const FieldDescriptor* field,
           int depth) {
    const bool many = field->is_repeated();
    const auto put = [&](auto one, auto more, auto value) {
      many ? (reflection.*more)(&message, field, value) : (reflection.*one)(&message, field, value);
    };
    using R = google::protobuf::Reflection;
    switch (field->cpp_type()) {
      case FieldDescriptor::CPPTYPE_INT32:
        return put(&R::SetInt32, &R::AddInt32, number<std::int32_t>());
      case FieldDescriptor::CPPTYPE_UINT32:
        return put(&R::SetUInt32, &R::AddUInt32, number<std::uint32_t>());
      case FieldDescriptor::CPPTYPE_INT64:
        return put(&R::SetInt64, &R::AddInt64, number<std::int64_t>());
      case FieldDescriptor::CPPTYPE_UINT64:
        return put(&R::SetUInt64, &R::AddUInt64, number<std::uint64_t>());
      case FieldDescriptor::CPPTYPE_DOUBLE:
        return put(&R::SetDouble, &R::AddDouble, real());
      case FieldDescriptor::CPPTYPE_FLOAT:
        return put(&R::SetFloat, &R::AddFloat, number<float>());
      case FieldDescriptor::CPPTYPE_BOOL:
        return put(&R::SetBool, &R::AddBool, random_() % 2 == 0);
      case FieldDescriptor::CPPTYPE_ENUM: {
        const int index = static_cast<int>(random_()) & 0x7fffffff;
        const auto* type = field->enum_type();
        const int value = index % 9 == 0 ? 4711 : type->value(index % type->value_count())->number();
        return put(&R::SetEnumValue, &R::AddEnumValue, value);
      }
      case FieldDescriptor::CPPTYPE_STRING: {
        const std::string text = "M\u00fcnchen \"a\\b\"\n\t\x01 \u20ac";
        return many ? reflection.AddString(&message, field, text)
                    : reflection.SetString(&message, field, text);
      }
      case FieldDescriptor::CPPTYPE_MESSAGE:
        return fill(
            many ? *reflection.AddMessage(&message, field) : *reflection.MutableMessage(&message, field),
            depth + 1);
    }
  }

  std::mt19937 random_;
};

void expect_same(const Message& found, const Message& wanted) {
  google::protobuf::util::MessageDifferencer difference;
  difference.set_message_field_comparison(google::protobuf::util::MessageDifferencer::EQUAL);
  std::string why;
  difference.ReportDifferencesToString(&why);
  EXPECT_TRUE(difference.Compare(wanted, found)) << wanted.GetTypeName() << ": " << why;
}

struct Sample {
  MessageType type;
  std::unique_ptr<Message> message;
};

/// One of each type of the protocol.
std::vector<Sample> samples(unsigned seed) {
  using namespace wire;
  std::vector<Sample> all;
  const auto add = [&](MessageType type, const Message& example) {
    all.push_back({type, std::unique_ptr<Message>(example.New())});
    Filler(seed + static_cast<unsigned>(type)).fill(*all.back().message);
  };
  using enum wire::MessageType;
  add(hello, Hello());
  add(welcome, Welcome());
  add(ack, Ack());
  add(error, Error());
  add(heartbeat, Heartbeat());
  add(list_radars, ListRadars());
  add(radar_list, RadarList());
  add(get_radar, GetRadar());
  add(radar_info, RadarInfo());
  add(claim_control, ClaimControl());
  add(release_control, ReleaseControl());
  add(set_settings, SetSettings());
  add(set_pose, SetPose());
  add(subscribe, Subscribe());
  add(unsubscribe, Unsubscribe());
  add(render_once, RenderOnce());
  add(get_status, GetStatus());
  add(MessageType::status, Status());
  add(set_state, SetState());
  add(query_ground, QueryGround());
  add(ground_answer, GroundAnswer());
  add(reset_exercise, ResetExercise());
  add(get_exercise, GetExercise());
  add(exercise_state, ExerciseState());
  add(load_exercise, LoadExercise());
  add(set_exercise, SetExercise());
  add(frame_begin, FrameBegin());
  add(wedge_block, WedgeBlock());
  add(frame_end, FrameEnd());
  add(frame_abort, FrameAbort());
  return all;
}

/// A message as a browser is sent it.
wire::Bytes as_json(MessageType type, const wire::Addressing& addressing, const Message& descriptor,
                    const wire::Bytes& plane) {
  const std::string head = wire::json_head(type, addressing, descriptor, plane.size());
  const auto bytes = std::as_bytes(std::span(head));
  wire::Bytes whole(bytes.begin(), bytes.end());
  whole.insert(whole.end(), plane.begin(), plane.end());
  return whole;
}

TEST(WebSocketTranslation, EveryFieldOfEveryTypeIsWhatProtobufWrites) {
  google::protobuf::util::JsonPrintOptions options;
  options.preserve_proto_field_names = true;
  for (unsigned seed = 0; seed < 200; ++seed) {
    for (const Sample& sample : samples(1000 * seed)) {
      std::string ours, theirs;
      wire::append_json(*sample.message, ours);
      ASSERT_TRUE(google::protobuf::util::MessageToJsonString(*sample.message, &theirs, options).ok());
      ASSERT_EQ(nlohmann::json::parse(ours), nlohmann::json::parse(theirs)) << sample.message->GetTypeName();
      const std::unique_ptr<Message> back(sample.message->New());
      const auto status = google::protobuf::util::JsonStringToMessage(ours, back.get());
      ASSERT_TRUE(status.ok()) << status.ToString() << "\n" << ours;
      expect_same(*back, *sample.message);
    }
  }
}

/// Read as a message of a type: the reason why not; empty when it is one.
std::string refusal_of(MessageType type, const std::string& json, Message* read = nullptr) {
  const std::unique_ptr<Message> message(example_of(type)->New());
  const auto why = read_json(json, *message);
  if (read != nullptr) read->CopyFrom(*message);
  return why.value_or("");
}

TEST(WebSocketTranslation, WhatProtobufWritesIsReadAsProtobufReadsIt) {
  for (const bool as_in_proto : {false, true}) {
    google::protobuf::util::JsonPrintOptions options;
    options.preserve_proto_field_names = as_in_proto;
    for (unsigned seed = 0; seed < 100; ++seed) {
      for (const Sample& sample : samples(31 * seed)) {
        std::string json;
        ASSERT_TRUE(google::protobuf::util::MessageToJsonString(*sample.message, &json, options).ok());
        const std::unique_ptr<Message> ours(sample.message->New()), theirs(sample.message->New());
        EXPECT_EQ(refusal_of(sample.type, json, ours.get()), "");
        ASSERT_TRUE(google::protobuf::util::JsonStringToMessage(json, theirs.get()).ok());
        expect_same(*ours, *theirs);
      }
    }
  }
}

// RFC 8259; protobuf's own reader takes some of these.
TEST(WebSocketTranslation, WhatIsNoJsonIsRefused) {
  using namespace std::string_literals;
  for (const std::string& json : {"{'major':1}"s,
                                  "{\"major\":'1'}"s,
                                  "{major:1}"s,
                                  "{\"major\":1,}"s,
                                  "{\"major\":0x10}"s,
                                  "\xef\xbb\xbf{}"s,
                                  "{}\0{}"s,
                                  "{}{}"s,
                                  "{\"major\":01}"s,
                                  "{\"major\":+1}"s,
                                  "{\"major\":.5}"s,
                                  "{\"major\":NaN}"s,
                                  "{\"client_name\":\"\xff\"}"s,
                                  "{\"client_name\":\"\\ud800\"}"s,
                                  "{\"client_name\":\"\n\"}"s,
                                  "{/**/}"s,
                                  "{"s,
                                  ""s,
                                  "[]"s,
                                  "1"s,
                                  "null"s})
    EXPECT_NE(refusal_of(MessageType::hello, json), "") << json;
  EXPECT_EQ(refusal_of(MessageType::hello, " \t\r\n{ \"major\" : 1 }\n"), "");
}

TEST(WebSocketTranslation, NumbersAreReadByTheirFieldsType) {
  const auto major = [](const std::string& value) {
    wire::Hello hello;
    return refusal_of(MessageType::hello, "{\"major\":" + value + "}", &hello).empty()
               ? std::to_string(hello.major())
               : "refused";
  };
  EXPECT_EQ(major("4294967295"), "4294967295");
  EXPECT_EQ(major("\"7\""), "7");
  EXPECT_EQ(major("1e3"), "1000");
  EXPECT_EQ(major("null"), "0");
  for (const char* wrong :
       {"4294967296", "-1", "1.5", "1e10", "\"\"", "\"7 \"", "\"0x7\"", "true", "[1]", "{}"})
    EXPECT_EQ(major(wrong), "refused") << wrong;
  wire::Hello hello;
  EXPECT_EQ(refusal_of(MessageType::hello, R"({"request_id":18446744073709551615})", &hello), "");
  EXPECT_EQ(hello.request_id(), std::numeric_limits<std::uint64_t>::max());
  EXPECT_NE(refusal_of(MessageType::hello, R"({"request_id":18446744073709551616})"), "");
  wire::Subscribe subscribe;
  EXPECT_EQ(refusal_of(MessageType::subscribe, R"({"rate_hz":"Infinity"})", &subscribe), "");
  EXPECT_EQ(subscribe.rate_hz(), std::numeric_limits<double>::infinity());
  EXPECT_NE(refusal_of(MessageType::subscribe, R"({"rate_hz":"inf"})"), "");
}

TEST(WebSocketTranslation, AKeyStandsOnceAndAListHasNoMoreValuesThanThereAreToName) {
  EXPECT_NE(refusal_of(MessageType::subscribe, R"({"rate_hz":1,"radar":"main","rate_hz":1})")
                .find("\"rate_hz\" twice"),
            std::string::npos);
  EXPECT_NE(refusal_of(MessageType::subscribe, R"({"rate_hz":1,"rateHz":1})"), "") << "the same field";
  EXPECT_NE(refusal_of(MessageType::subscribe, R"({"planes":["IQ"],"planes":["POWER"]})"), "");
  const std::string all =
      R"("IQ","POWER","COUNT","STATE","VIDEO","PULSES","MATERIAL","BUILDING","HEIGHT","RETURNS","TARGET")";
  EXPECT_EQ(refusal_of(MessageType::subscribe, R"({"planes":[)" + all + "]}"), "");
  EXPECT_NE(refusal_of(MessageType::subscribe, R"({"planes":[)" + all + R"(,"IQ"]})").find("at most 11"),
            std::string::npos);
  EXPECT_NE(refusal_of(MessageType::subscribe, R"({"planes":"IQ"})").find("allowed: a list"),
            std::string::npos);
  const auto places = [](std::uint32_t n) {
    std::string json = R"({"latitude_deg":[0)";
    for (std::uint32_t i = 1; i < n; ++i) json += ",0";
    return json + "]}";
  };
  EXPECT_EQ(refusal_of(MessageType::query_ground, places(wire::kMaxQueryPoints)), "");
  EXPECT_NE(refusal_of(MessageType::query_ground, places(wire::kMaxQueryPoints + 1)), "");
}

TEST(WebSocketTranslation, WhatIsTooLongAsProtobufIsRefusedAndNothingElseHappens) {
  const std::string text = R"({"radar":")" + std::string(100, 'x') + "\"}";
  wire::Bytes binary{std::byte{7}};
  const auto refusal = to_binary(test::web_message(MessageType::get_radar, text), {1000, 101}, binary);
  ASSERT_TRUE(refusal);
  EXPECT_EQ(refusal->number, wire::ErrorNumber::bad_length);
  EXPECT_EQ(binary, wire::Bytes{std::byte{7}});
  EXPECT_FALSE(to_binary(test::web_message(MessageType::get_radar, text), {1000, 102}, binary));
}

TEST(WebSocketTranslation, AnAbsentFieldAndOneThatIsZeroAreTwoThings) {
  wire::SetPose pose;
  pose.mutable_pose()->set_bearing_deg(0);
  std::string json;
  wire::append_json(pose, json);
  EXPECT_EQ(json, R"({"pose":{"bearing_deg":0}})");
}

TEST(WebSocketTranslation, BytesThatAreNoTextAreReplaced) {
  wire::Error error;
  error.set_text("a \xff name");
  std::string json;
  wire::append_json(error, json);
  EXPECT_EQ(json, "{\"text\":\"a \xef\xbf\xbd name\"}");
}

TEST(WebSocketTranslation, ATypeOfALaterVersionIsPassedOnEmptyAndSkipped) {
  wire::MessageHeader header{.type = static_cast<MessageType>(4000), .flags = wire::kJsonDescriptor};
  header.payload_length = header.descriptor_length = 2;
  wire::Bytes bytes(wire::kHeaderBytes + 2, std::byte{'{'});
  bytes.back() = std::byte{'}'};
  wire::encode_header(header, std::span(bytes).first<wire::kHeaderBytes>());
  wire::Bytes binary;
  EXPECT_FALSE(to_binary(bytes, 1000, binary));
  EXPECT_EQ(binary.size(), wire::kHeaderBytes);
}

TEST(WebSocketTranslation, TheMessageInTheProtocolsPageIsWhatTheServerSends) {
  wire::WedgeBlock block;
  block.set_frame_id(1);
  block.set_plane(wire::STATE);
  block.set_first_azimuth(8);
  block.set_n_azimuth(2);
  block.set_n_range(3);
  block.set_wedge_index(1);
  wire::Bytes plane;
  for (const int state : {1, 1, 2, 1, 0, 3}) plane.push_back(static_cast<std::byte>(state));
  EXPECT_EQ(as_json(MessageType::wedge_block, {2, 5, 1767225600000000000}, block, plane),
            test::bytes_of_block(OBLIQ_SOURCE_DIR "/proto/PROTOCOL.md", "web"));
}

}  // namespace
}  // namespace obliq::websocket::json_message_test
