#pragma once
// Messages as JSON with the names of obliq.proto, written by reflection: a block's descriptor costs a seventh
// of what protobuf's own writer takes, which goes through the bytes of the message and a type resolver
// (websocket_bench). Messages of obliq.proto have neither maps nor bytes.
#include <cstddef>
#include <string>

#include "proto/message_codec.h"

namespace google::protobuf {
class Message;
}

namespace obliq::wire {

/// Appends the object by protobuf's mapping (protobuf.dev, "ProtoJSON format"): fields that are absent or
/// have their default are left out, 64-bit numbers are texts, enums their names, numbers that are not finite
/// "NaN", "Infinity" and "-Infinity".
void append_json(const google::protobuf::Message& message, std::string& out);

/// A message for browsers but for its plane, which stands behind: a header with kJsonDescriptor, and the
/// descriptor.
std::string json_head(MessageType type, const Addressing& addressing,
                      const google::protobuf::Message& descriptor, std::size_t plane_bytes);

/// As files and scripts have it: every field, in the order of obliq.proto; numbers are numbers, a real one
/// with its point or exponent; what is not finite is null; enums are words (enum_word).
std::string file_json(const google::protobuf::Message& message);

/// The scene file's word for an enumerator: GROUND_SPECKLE is "ground".
std::string enum_word(std::string enumerator);

}  // namespace obliq::wire
