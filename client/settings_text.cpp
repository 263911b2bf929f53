#include "client/settings_text.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>
#include <google/protobuf/reflection.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>

#include "proto/obliq.pb.h"

namespace obliq::client {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

Status refuse(std::string_view field, std::string_view found, const std::string& allowed) {
  Status status = Status::failure(Outcome::bad_argument, "settings");
  status.fields.push_back({std::string(field), std::string(found), allowed});
  return status;
}

template <class Number>
std::optional<Number> number_of(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

template <class Number>
std::string number_text(Number value) {
  std::array<char, 64> digits;
  return {digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr};
}

/// In a list: commas are between settings.
constexpr char kBetweenNumbers = ';';

template <class Number>
std::string whole_numbers() {
  using Limits = std::numeric_limits<Number>;
  return "a whole number from " + number_text(Limits::min()) + " to " + number_text(Limits::max());
}

std::string enumerators(const FieldDescriptor& field) {
  std::string names;
  for (int k = 0; k < field.enum_type()->value_count(); ++k)
    names += (k > 0 ? " | " : "") + std::string(field.enum_type()->value(k)->name());
  return names;
}

/// Numbers, "-2;-5", in the one field of a list; nothing between the signs: an empty list.
std::optional<std::string> put_list(Message& list, std::string_view text) {
  const auto numbers =
      list.GetReflection()->GetMutableRepeatedFieldRef<double>(&list, list.GetDescriptor()->field(0));
  numbers.Clear();
  while (!text.empty()) {
    const std::string_view word = text.substr(0, text.find(kBetweenNumbers));
    text.remove_prefix(std::min(text.size(), word.size() + 1));
    const auto number = number_of<double>(word);
    if (!number) return std::string("numbers with ") + kBetweenNumbers + " between them, such as -2;-5";
    numbers.Add(*number);
  }
  return std::nullopt;
}

std::string list_text(const Message& list) {
  std::string text;
  for (const double number :
       list.GetReflection()->GetRepeatedFieldRef<double>(list, list.GetDescriptor()->field(0)))
    text += (text.empty() ? "" : std::string(1, kBetweenNumbers)) + number_text(number);
  return text;
}

/// Puts a value in its field; what is allowed where it does not fit.
std::optional<std::string> put(Message& message, const FieldDescriptor& field, std::string_view text) {
  const auto& reflection = *message.GetReflection();
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_DOUBLE:
      if (const auto value = number_of<double>(text))
        return reflection.SetDouble(&message, &field, *value), std::nullopt;
      return "a number";
    case FieldDescriptor::CPPTYPE_BOOL:
      if (text != "true" && text != "false") return "true | false";
      return reflection.SetBool(&message, &field, text == "true"), std::nullopt;
    case FieldDescriptor::CPPTYPE_INT32:
      if (const auto value = number_of<std::int32_t>(text))
        return reflection.SetInt32(&message, &field, *value), std::nullopt;
      return whole_numbers<std::int32_t>();
    case FieldDescriptor::CPPTYPE_INT64:
      if (const auto value = number_of<std::int64_t>(text))
        return reflection.SetInt64(&message, &field, *value), std::nullopt;
      return whole_numbers<std::int64_t>();
    case FieldDescriptor::CPPTYPE_UINT64:
      if (const auto value = number_of<std::uint64_t>(text))
        return reflection.SetUInt64(&message, &field, *value), std::nullopt;
      return whole_numbers<std::uint64_t>();
    case FieldDescriptor::CPPTYPE_ENUM:
      if (const auto* value = field.enum_type()->FindValueByName(std::string(text)))
        return reflection.SetEnum(&message, &field, value), std::nullopt;
      return enumerators(field);
    case FieldDescriptor::CPPTYPE_MESSAGE:
      return put_list(*reflection.MutableMessage(&message, &field), text);
    default:
      return "nothing that a text can say";
  }
}

}  // namespace

Status read_settings(std::string_view text, wire::RadarSettings& settings) {
  constexpr std::string_view kSpace = " \t\r\n,";
  while (true) {
    const std::size_t begin = text.find_first_not_of(kSpace);
    if (begin == std::string_view::npos) return {};
    text.remove_prefix(begin);
    const std::string_view word = text.substr(0, text.find_first_of(kSpace));
    text.remove_prefix(word.size());
    const std::size_t equals = word.find('=');
    if (equals == std::string_view::npos || equals == 0)
      return refuse("settings", word, "NAME=VALUE, such as receiver_gain_db=6");
    const std::string_view name = word.substr(0, equals);
    const FieldDescriptor* field = settings.GetDescriptor()->FindFieldByName(std::string(name));
    if (field == nullptr) return refuse(name, "no field of RadarSettings", "those of obliq.proto");
    if (const auto allowed = put(settings, *field, word.substr(equals + 1)))
      return refuse(name, word.substr(equals + 1), *allowed);
  }
}

std::optional<std::string> setting_text(const wire::RadarSettings& settings, std::string_view name) {
  const FieldDescriptor* field = settings.GetDescriptor()->FindFieldByName(std::string(name));
  if (field == nullptr) return std::nullopt;
  const auto& reflection = *settings.GetReflection();
  switch (field->cpp_type()) {
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return number_text(reflection.GetDouble(settings, field));
    case FieldDescriptor::CPPTYPE_BOOL:
      return reflection.GetBool(settings, field) ? "true" : "false";
    case FieldDescriptor::CPPTYPE_INT32:
      return number_text(reflection.GetInt32(settings, field));
    case FieldDescriptor::CPPTYPE_INT64:
      return number_text(reflection.GetInt64(settings, field));
    case FieldDescriptor::CPPTYPE_UINT64:
      return number_text(reflection.GetUInt64(settings, field));
    case FieldDescriptor::CPPTYPE_ENUM:
      return std::string(reflection.GetEnum(settings, field)->name());
    case FieldDescriptor::CPPTYPE_MESSAGE:
      return list_text(reflection.GetMessage(settings, field));
    default:
      return std::nullopt;
  }
}

}  // namespace obliq::client
