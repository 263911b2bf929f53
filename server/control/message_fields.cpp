#include "server/control/message_fields.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>
#include <google/protobuf/reflection.h>

#include <stdexcept>
#include <string>

namespace obliq {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

namespace {

/// An enumerator by the name that the scene file uses; one that is unknown keeps its number, which fits
/// nothing.
Value choice_value(const Key& key, const FieldDescriptor& field, int number) {
  const auto* enumerator = field.enum_type()->FindValueByNumber(number);
  if (enumerator != nullptr)
    for (const Choice& choice : key.choices)
      if (choice.wire_name == enumerator->name()) return std::string(choice.name);
  return std::int64_t{number};
}

void write_choice(const Key& key, const FieldDescriptor& field, const std::string& name, Message& message) {
  for (const Choice& choice : key.choices)
    if (choice.name == name)
      message.GetReflection()->SetEnum(&message, &field,
                                       field.enum_type()->FindValueByName(std::string(choice.wire_name)));
}

}  // namespace

const FieldDescriptor& message_field(std::string_view name, const Message& message) {
  const FieldDescriptor* field = message.GetDescriptor()->FindFieldByName(std::string(name));
  if (field == nullptr) throw std::logic_error("no field " + std::string(name) + " in the message");
  return *field;
}

Value read_field(const Key& key, const FieldDescriptor& field, const Message& message) {
  const auto* reflection = message.GetReflection();
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return reflection->GetDouble(message, &field);
    case FieldDescriptor::CPPTYPE_BOOL:
      return reflection->GetBool(message, &field);
    case FieldDescriptor::CPPTYPE_INT32:
      return std::int64_t{reflection->GetInt32(message, &field)};
    case FieldDescriptor::CPPTYPE_INT64:
      return reflection->GetInt64(message, &field);
    case FieldDescriptor::CPPTYPE_UINT64:
      return reflection->GetUInt64(message, &field);
    case FieldDescriptor::CPPTYPE_STRING:
      return reflection->GetString(message, &field);
    case FieldDescriptor::CPPTYPE_ENUM:
      return choice_value(key, field, reflection->GetEnumValue(message, &field));
    case FieldDescriptor::CPPTYPE_MESSAGE: {
      const Message& list = reflection->GetMessage(message, &field);
      const auto numbers =
          list.GetReflection()->GetRepeatedFieldRef<double>(list, list.GetDescriptor()->field(0));
      return std::vector<double>(numbers.begin(), numbers.end());
    }
    default:
      throw std::logic_error("no parameter has the type of field " + field.full_name());
  }
}

void write_field(const Key& key, const FieldDescriptor& field, const Value& value, Message& message) {
  const auto* reflection = message.GetReflection();
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return reflection->SetDouble(&message, &field, std::get<double>(value));
    case FieldDescriptor::CPPTYPE_BOOL:
      return reflection->SetBool(&message, &field, std::get<bool>(value));
    case FieldDescriptor::CPPTYPE_INT32:
      return reflection->SetInt32(&message, &field, static_cast<std::int32_t>(std::get<std::int64_t>(value)));
    case FieldDescriptor::CPPTYPE_INT64:
      return reflection->SetInt64(&message, &field, std::get<std::int64_t>(value));
    case FieldDescriptor::CPPTYPE_UINT64:
      return reflection->SetUInt64(&message, &field, std::get<std::uint64_t>(value));
    case FieldDescriptor::CPPTYPE_STRING:
      return reflection->SetString(&message, &field, std::get<std::string>(value));
    case FieldDescriptor::CPPTYPE_ENUM:
      return write_choice(key, field, std::get<std::string>(value), message);
    case FieldDescriptor::CPPTYPE_MESSAGE: {
      Message& list = *reflection->MutableMessage(&message, &field);
      const auto numbers =
          list.GetReflection()->GetMutableRepeatedFieldRef<double>(&list, list.GetDescriptor()->field(0));
      numbers.Clear();
      for (const double number : std::get<std::vector<double>>(value)) numbers.Add(number);
      return;
    }
    default:
      throw std::logic_error("no parameter has the type of field " + field.full_name());
  }
}

}  // namespace obliq
