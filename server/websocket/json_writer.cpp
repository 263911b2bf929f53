#include "server/websocket/json_writer.h"

#include <google/protobuf/message.h>

#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

namespace obliq::websocket {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;

/// A number of any kind; of floating point the shortest text that reads back as the same number.
template <class Number>
void append_number(Number number, std::string& out) {
  if constexpr (std::is_floating_point_v<Number>) {
    if (std::isnan(number)) {
      out += "\"NaN\"";
      return;
    }
    if (std::isinf(number)) {
      out += number > 0 ? "\"Infinity\"" : "\"-Infinity\"";
      return;
    }
    if (number == 0 && std::signbit(number)) {
      out += "-0.0";  // readers take -0 for the integer, which has no sign
      return;
    }
  }
  char text[32];
  out.append(text, std::to_chars(text, text + sizeof text, number).ptr);
}

template <class Number>
void append_quoted(Number number, std::string& out) {
  out += '"';
  append_number(number, out);
  out += '"';
}

void append_text(const std::string& text, std::string& out) {
  // What is no UTF-8 (a file's name, say) becomes U+FFFD.
  out += nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// A value of a field, or that at `index` of a repeated one.
void append_value(const Message& message, const Reflection& reflection, const FieldDescriptor* field,
                  int index, std::string& out) {
  const bool many = field->is_repeated();
  const auto value = [&](auto one, auto of_many) {
    return many ? (reflection.*of_many)(message, field, index) : (reflection.*one)(message, field);
  };
  switch (field->cpp_type()) {
    case FieldDescriptor::CPPTYPE_INT32:
      return append_number(value(&Reflection::GetInt32, &Reflection::GetRepeatedInt32), out);
    case FieldDescriptor::CPPTYPE_UINT32:
      return append_number(value(&Reflection::GetUInt32, &Reflection::GetRepeatedUInt32), out);
    case FieldDescriptor::CPPTYPE_INT64:
      return append_quoted(value(&Reflection::GetInt64, &Reflection::GetRepeatedInt64), out);
    case FieldDescriptor::CPPTYPE_UINT64:
      return append_quoted(value(&Reflection::GetUInt64, &Reflection::GetRepeatedUInt64), out);
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return append_number(value(&Reflection::GetDouble, &Reflection::GetRepeatedDouble), out);
    case FieldDescriptor::CPPTYPE_FLOAT:
      return append_number(value(&Reflection::GetFloat, &Reflection::GetRepeatedFloat), out);
    case FieldDescriptor::CPPTYPE_BOOL:
      out += value(&Reflection::GetBool, &Reflection::GetRepeatedBool) ? "true" : "false";
      return;
    case FieldDescriptor::CPPTYPE_ENUM: {
      const int number = value(&Reflection::GetEnumValue, &Reflection::GetRepeatedEnumValue);
      const auto* known = field->enum_type()->FindValueByNumber(number);
      if (known == nullptr) return append_number(number, out);
      out += '"';
      out += known->name();
      out += '"';
      return;
    }
    case FieldDescriptor::CPPTYPE_STRING:
      return append_text(value(&Reflection::GetString, &Reflection::GetRepeatedString), out);
    case FieldDescriptor::CPPTYPE_MESSAGE:
      return append_json(
          many ? reflection.GetRepeatedMessage(message, field, index) : reflection.GetMessage(message, field),
          out);
  }
}

}  // namespace

void append_json(const Message& message, std::string& out) {
  const Reflection& reflection = *message.GetReflection();
  std::vector<const FieldDescriptor*> fields;  // those that are there
  reflection.ListFields(message, &fields);
  out += '{';
  for (const FieldDescriptor* field : fields) {
    if (out.back() != '{') out += ',';
    out += '"';
    out += field->name();
    out += "\":";
    if (!field->is_repeated()) {
      append_value(message, reflection, field, 0, out);
      continue;
    }
    out += '[';
    for (int i = 0; i < reflection.FieldSize(message, field); ++i) {
      if (i > 0) out += ',';
      append_value(message, reflection, field, i, out);
    }
    out += ']';
  }
  out += '}';
}

}  // namespace obliq::websocket
