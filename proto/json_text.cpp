#include "proto/json_text.h"

#include <google/protobuf/message.h>

#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

namespace obliq::wire {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;

enum class JsonStyle { protobuf, file };
void append_object(const Message& message, JsonStyle style, std::string& out);

/// A number of any kind; of floating point the shortest text that reads back as the same number.
template <class Number>
void append_number(Number number, JsonStyle style, std::string& out) {
  constexpr bool kIsReal = std::is_floating_point_v<Number>;
  if constexpr (kIsReal) {
    if (!std::isfinite(number)) {
      out += style == JsonStyle::file ? "null"
             : std::isnan(number)     ? "\"NaN\""
             : number > 0             ? "\"Infinity\""
                                      : "\"-Infinity\"";
      return;
    }
    if (number == 0 && std::signbit(number)) {
      out += "-0.0";  // readers take -0 for the integer, which has no sign
      return;
    }
  }
  char text[32];
  const std::string_view digits(text, std::to_chars(text, text + sizeof text, number).ptr);
  const bool quoted = !kIsReal && sizeof number == 8 && style == JsonStyle::protobuf;
  if (quoted) out += '"';
  out += digits;
  if (quoted) out += '"';
  if (kIsReal && style == JsonStyle::file && digits.find_first_of(".e") == digits.npos) out += ".0";
}

void append_text(const std::string& text, std::string& out) {
  // Bytes that are not UTF-8 (in a file's name, say) become U+FFFD.
  out += nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// A value of a field, or that at `index` of a repeated one.
void append_value(const Message& message, const Reflection& reflection, const FieldDescriptor* field,
                  int index, JsonStyle style, std::string& out) {
  const bool many = field->is_repeated();
  const auto value = [&](auto one, auto of_many) {
    return many ? (reflection.*of_many)(message, field, index) : (reflection.*one)(message, field);
  };
  switch (field->cpp_type()) {
    case FieldDescriptor::CPPTYPE_INT32:
      return append_number(value(&Reflection::GetInt32, &Reflection::GetRepeatedInt32), style, out);
    case FieldDescriptor::CPPTYPE_UINT32:
      return append_number(value(&Reflection::GetUInt32, &Reflection::GetRepeatedUInt32), style, out);
    case FieldDescriptor::CPPTYPE_INT64:
      return append_number(value(&Reflection::GetInt64, &Reflection::GetRepeatedInt64), style, out);
    case FieldDescriptor::CPPTYPE_UINT64:
      return append_number(value(&Reflection::GetUInt64, &Reflection::GetRepeatedUInt64), style, out);
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return append_number(value(&Reflection::GetDouble, &Reflection::GetRepeatedDouble), style, out);
    case FieldDescriptor::CPPTYPE_FLOAT:
      return append_number(value(&Reflection::GetFloat, &Reflection::GetRepeatedFloat), style, out);
    case FieldDescriptor::CPPTYPE_BOOL:
      out += value(&Reflection::GetBool, &Reflection::GetRepeatedBool) ? "true" : "false";
      return;
    case FieldDescriptor::CPPTYPE_ENUM: {
      const int number = value(&Reflection::GetEnumValue, &Reflection::GetRepeatedEnumValue);
      const auto* known = field->enum_type()->FindValueByNumber(number);
      if (known == nullptr) return append_number(number, style, out);
      out += '"';
      if (style == JsonStyle::file)
        out += enum_word(known->name());
      else
        out += known->name();
      out += '"';
      return;
    }
    case FieldDescriptor::CPPTYPE_STRING:
      return append_text(value(&Reflection::GetString, &Reflection::GetRepeatedString), out);
    case FieldDescriptor::CPPTYPE_MESSAGE:
      return append_object(
          many ? reflection.GetRepeatedMessage(message, field, index) : reflection.GetMessage(message, field),
          style, out);
  }
}

void append_object(const Message& message, JsonStyle style, std::string& out) {
  const Reflection& reflection = *message.GetReflection();
  std::vector<const FieldDescriptor*> fields;
  if (style == JsonStyle::protobuf) reflection.ListFields(message, &fields);
  for (int i = 0; style == JsonStyle::file && i < message.GetDescriptor()->field_count(); ++i)
    fields.push_back(message.GetDescriptor()->field(i));
  out += '{';
  for (const FieldDescriptor* field : fields) {
    if (out.back() != '{') out += ',';
    out += '"';
    out += field->name();
    out += "\":";
    if (!field->is_repeated()) {
      append_value(message, reflection, field, 0, style, out);
      continue;
    }
    out += '[';
    for (int i = 0; i < reflection.FieldSize(message, field); ++i) {
      if (i > 0) out += ',';
      append_value(message, reflection, field, i, style, out);
    }
    out += ']';
  }
  out += '}';
}

}  // namespace

void append_json(const Message& message, std::string& out) {
  append_object(message, JsonStyle::protobuf, out);
}

std::string json_head(MessageType type, const Addressing& addressing, const Message& descriptor,
                      std::size_t plane_bytes) {
  std::string head(kHeaderBytes, '\0');
  append_json(descriptor, head);
  MessageHeader header{.type = type,
                       .flags = kJsonDescriptor,
                       .stream_id = addressing.stream_id,
                       .sequence = addressing.sequence,
                       .utc_ns = addressing.utc_ns};
  header.descriptor_length = static_cast<std::uint32_t>(head.size() - kHeaderBytes);
  header.payload_length = header.descriptor_length + static_cast<std::uint32_t>(plane_bytes);
  encode_header(header, std::as_writable_bytes(std::span(head)).first<kHeaderBytes>());
  return head;
}

std::string file_json(const Message& message) {
  std::string text;
  append_object(message, JsonStyle::file, text);
  return text;
}

std::string enum_word(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  for (const std::string_view suffix : {"_speckle", "_plates"})
    if (text.ends_with(suffix)) text.resize(text.size() - suffix.size());
  return text;
}

}  // namespace obliq::wire
