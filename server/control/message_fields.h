#pragma once
// Values of keys to and from fields of messages, by reflection.
#include <string_view>

#include "server/control/key.h"

namespace google::protobuf {
class FieldDescriptor;
class Message;
}  // namespace google::protobuf

namespace obliq {

/// The message's field of that name. Throws std::logic_error where there is none: that is our mistake.
const google::protobuf::FieldDescriptor& message_field(std::string_view name,
                                                       const google::protobuf::Message& message);

/// What the field holds, whether it is set or not.
Value read_field(const Key& key, const google::protobuf::FieldDescriptor& field,
                 const google::protobuf::Message& message);
void write_field(const Key& key, const google::protobuf::FieldDescriptor& field, const Value& value,
                 google::protobuf::Message& message);

}  // namespace obliq
