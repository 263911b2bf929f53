#include "server/websocket/json_reader.h"

#include <fmt/core.h>
#include <google/protobuf/message.h>

#include <charconv>
#include <cmath>
#include <concepts>
#include <limits>
#include <nlohmann/json.hpp>
#include <type_traits>
#include <utility>
#include <vector>

#include "proto/limits.h"
#include "terrain/base/text.h"

namespace obliq::websocket {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;

/// A whole number that fits, also where it is written as 1e3; nothing else.
template <std::integral To, class From>
std::optional<To> whole(From value) {
  if constexpr (std::is_integral_v<From>) {
    if (std::in_range<To>(value)) return static_cast<To>(value);
  } else {
    // The greatest numbers of both types are one less than a power of two, which a double holds.
    constexpr double kBeyond = 2.0 * static_cast<double>(std::numeric_limits<To>::max() / 2 + 1);
    if (value >= static_cast<double>(std::numeric_limits<To>::min()) && value < kBeyond &&
        std::trunc(value) == value)
      return static_cast<To>(value);
  }
  return std::nullopt;
}

/// All of the text as a number.
template <class Number>
std::optional<Number> number_in(const std::string& text) {
  if constexpr (std::is_floating_point_v<Number>) {
    if (text == "NaN") return std::numeric_limits<Number>::quiet_NaN();
    if (text == "Infinity") return std::numeric_limits<Number>::infinity();
    if (text == "-Infinity") return -std::numeric_limits<Number>::infinity();
  }
  const std::size_t digit = text.starts_with('-') ? 1 : 0;
  if (digit >= text.size() || text[digit] < '0' || text[digit] > '9') return std::nullopt;
  Number number{};
  const char* end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, number);
  return error == std::errc() && stopped == end ? std::optional(number) : std::nullopt;
}

/// What nlohmann's reader calls for each thing that it finds; false ends it.
class Reader {
 public:
  explicit Reader(Message& message) : message_(message) {}
  const std::string& fault() const { return fault_; }

  bool null() {
    const Open* open = place();
    // As if the field were not there.
    return (open != nullptr && !open->in_list) || found("null");
  }
  bool boolean(bool value) {
    if (!takes_value("a truth value")) return false;
    if (field().cpp_type() != FieldDescriptor::CPPTYPE_BOOL) return found("a truth value");
    return put(&Reflection::SetBool, &Reflection::AddBool, value);
  }
  bool number_integer(std::int64_t value) { return number(value); }
  bool number_unsigned(std::uint64_t value) { return number(value); }
  bool number_float(double value, const std::string&) { return number(value); }
  bool string(const std::string& text);
  bool binary(const nlohmann::json::binary_t&) { return false; }  // JSON has none

  bool start_object(std::size_t) {
    if (open_.empty()) return begin(message_);
    if (!takes_value("an object")) return false;
    if (field().cpp_type() != FieldDescriptor::CPPTYPE_MESSAGE) return found("an object");
    Message& of = *open_.back().message;
    const Reflection& reflection = *of.GetReflection();
    return begin(*(field().is_repeated() ? reflection.AddMessage(&of, &field())
                                         : reflection.MutableMessage(&of, &field())));
  }
  bool key(const std::string& name);
  bool end_object() {
    open_.pop_back();
    return true;
  }
  bool start_array(std::size_t) {
    Open* open = place();
    if (open == nullptr || open->in_list || !field().is_repeated()) return found("a list");
    open->in_list = true;
    open->values = 0;
    return true;
  }
  bool end_array() {
    open_.back().in_list = false;
    return true;
  }
  bool parse_error(std::size_t position, const std::string&, const nlohmann::json::exception& error) {
    constexpr int kNumberOverflow = 406;
    return error.id == kNumberOverflow ? found("a number beyond those of a double")
                                       : refuse(fmt::format("no JSON from byte {} on", position));
  }

 private:
  /// An object that has begun and not ended.
  struct Open {
    Message* message;
    std::vector<bool> had;                   ///< its fields, by index
    const FieldDescriptor* field = nullptr;  ///< whose value comes
    bool in_list = false;
    std::uint32_t values = 0;  ///< in the list so far
  };

  Open* place() { return open_.empty() ? nullptr : &open_.back(); }
  const FieldDescriptor& field() const { return *open_.back().field; }

  bool begin(Message& message) {
    open_.push_back(
        {&message, std::vector<bool>(static_cast<std::size_t>(message.GetDescriptor()->field_count()))});
    return true;
  }

  bool refuse(std::string why) {
    if (fault_.empty()) fault_ = std::move(why);
    return false;
  }
  bool found(std::string_view what);
  std::string path() const;
  std::string allowed() const;

  /// Whether a value that is no list may stand here; counts it.
  bool takes_value(std::string_view what) {
    Open* open = place();
    if (open == nullptr || field().is_repeated() != open->in_list) return found(what);
    if (!open->in_list) return true;
    const auto* of_enum = field().enum_type();
    const std::uint32_t most =
        of_enum != nullptr ? static_cast<std::uint32_t>(of_enum->value_count()) : wire::kMaxQueryPoints;
    if (++open->values <= most) return true;
    return refuse(fmt::format("{}: found more than {} values; allowed: at most {}", path(), most, most));
  }

  template <class One, class More, class Value>
  bool put(One one, More more, const Value& value) {
    Message& of = *open_.back().message;
    const Reflection& reflection = *of.GetReflection();
    field().is_repeated() ? (reflection.*more)(&of, &field(), value)
                          : (reflection.*one)(&of, &field(), value);
    return true;
  }
  template <class One, class More, class Value>
  bool put_some(One one, More more, const std::optional<Value>& value, std::string_view what) {
    return value ? put(one, more, *value) : found(what);
  }

  template <class Number>
  bool number(Number value);

  Message& message_;
  std::vector<Open> open_;
  std::string fault_;
};

/// "pose.bearing_deg"; of the message itself nothing.
std::string Reader::path() const {
  std::string names;
  for (const Open& open : open_)
    if (open.field != nullptr) names += (names.empty() ? "" : ".") + open.field->name();
  return names;
}

std::string Reader::allowed() const {
  if (open_.empty()) return "an object";
  if (field().is_repeated() && !open_.back().in_list) return "a list";
  switch (field().cpp_type()) {
    case FieldDescriptor::CPPTYPE_BOOL:
      return "true or false";
    case FieldDescriptor::CPPTYPE_STRING:
      return "a text";
    case FieldDescriptor::CPPTYPE_MESSAGE:
      return "an object";
    case FieldDescriptor::CPPTYPE_ENUM: {
      std::string names;
      for (int i = 0; i < field().enum_type()->value_count(); ++i)
        names += (i == 0 ? "" : ", ") + field().enum_type()->value(i)->name();
      return names;
    }
    default:
      return std::string("a number of type ") + field().cpp_type_name();
  }
}

bool Reader::found(std::string_view what) {
  const std::string where = path();
  return refuse(fmt::format("{}found {}; allowed: {}", where.empty() ? "" : where + ": ", what, allowed()));
}

bool Reader::key(const std::string& name) {
  Open& open = open_.back();
  const auto& descriptor = *open.message->GetDescriptor();
  const FieldDescriptor* known = descriptor.FindFieldByName(name);
  if (known == nullptr) known = descriptor.FindFieldByCamelcaseName(name);
  open.field = nullptr;
  const std::string shown = printable_text(name, wire::kMaxNameBytes);
  if (known == nullptr)
    return refuse(
        fmt::format("found the field \"{}\"; allowed: those of {} in obliq.proto", shown, descriptor.name()));
  const auto index = static_cast<std::size_t>(known->index());
  if (open.had[index]) return refuse(fmt::format("found the field \"{}\" twice; allowed: once", shown));
  open.had[index] = true;
  open.field = known;
  return true;
}

template <class Number>
bool Reader::number(Number value) {
  if (!takes_value("a number")) return false;
  using R = Reflection;
  constexpr const char* kOther = "a number that it cannot be";
  switch (field().cpp_type()) {
    case FieldDescriptor::CPPTYPE_INT32:
      return put_some(&R::SetInt32, &R::AddInt32, whole<std::int32_t>(value), kOther);
    case FieldDescriptor::CPPTYPE_UINT32:
      return put_some(&R::SetUInt32, &R::AddUInt32, whole<std::uint32_t>(value), kOther);
    case FieldDescriptor::CPPTYPE_INT64:
      return put_some(&R::SetInt64, &R::AddInt64, whole<std::int64_t>(value), kOther);
    case FieldDescriptor::CPPTYPE_UINT64:
      return put_some(&R::SetUInt64, &R::AddUInt64, whole<std::uint64_t>(value), kOther);
    case FieldDescriptor::CPPTYPE_ENUM:
      return put_some(&R::SetEnumValue, &R::AddEnumValue, whole<std::int32_t>(value), kOther);
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return put(&R::SetDouble, &R::AddDouble, static_cast<double>(value));
    case FieldDescriptor::CPPTYPE_FLOAT: {
      const auto single = static_cast<double>(value);
      if (std::abs(single) > static_cast<double>(std::numeric_limits<float>::max())) return found(kOther);
      return put(&R::SetFloat, &R::AddFloat, static_cast<float>(value));
    }
    default:
      return found("a number");
  }
}

bool Reader::string(const std::string& text) {
  if (!takes_value("a text")) return false;
  using R = Reflection;
  const auto shown = [&] { return '"' + printable_text(text, wire::kMaxNameBytes) + '"'; };
  const auto read = [&]<class Value>(auto one, auto more, const std::optional<Value>& value) {
    return value ? put(one, more, *value) : found(shown());
  };
  switch (field().cpp_type()) {
    case FieldDescriptor::CPPTYPE_STRING:
      return put(&R::SetString, &R::AddString, text);
    case FieldDescriptor::CPPTYPE_INT32:
      return read(&R::SetInt32, &R::AddInt32, number_in<std::int32_t>(text));
    case FieldDescriptor::CPPTYPE_UINT32:
      return read(&R::SetUInt32, &R::AddUInt32, number_in<std::uint32_t>(text));
    case FieldDescriptor::CPPTYPE_INT64:
      return read(&R::SetInt64, &R::AddInt64, number_in<std::int64_t>(text));
    case FieldDescriptor::CPPTYPE_UINT64:
      return read(&R::SetUInt64, &R::AddUInt64, number_in<std::uint64_t>(text));
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return read(&R::SetDouble, &R::AddDouble, number_in<double>(text));
    case FieldDescriptor::CPPTYPE_FLOAT:
      return read(&R::SetFloat, &R::AddFloat, number_in<float>(text));
    case FieldDescriptor::CPPTYPE_ENUM: {
      const auto* value = field().enum_type()->FindValueByName(text);
      if (value == nullptr) return found(shown());
      return put(&R::SetEnumValue, &R::AddEnumValue, value->number());
    }
    default:
      return found("a text");
  }
}

}  // namespace

std::optional<std::string> read_json(std::string_view json, Message& message) {
  // nlohmann's reader takes a NUL for the end, and skips a byte order mark.
  if (json.find('\0') != std::string_view::npos) return "found a NUL byte; allowed: JSON";
  const std::size_t begin = json.find_first_not_of(" \t\r\n");
  if (begin == std::string_view::npos || json[begin] != '{') return "found no object; allowed: an object";
  Reader reader(message);
  if (nlohmann::json::sax_parse(json.begin(), json.end(), &reader)) return std::nullopt;
  return reader.fault();
}

}  // namespace obliq::websocket
