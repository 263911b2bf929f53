#pragma once
// protobuf's JSON mapping (protobuf.dev, "ProtoJSON format") with the names of obliq.proto, written by
// reflection: a block's descriptor costs a seventh of what protobuf's own writer takes, which goes through
// the bytes of the message and a type resolver (websocket_bench).
#include <string>

namespace google::protobuf {
class Message;
}

namespace obliq::websocket {

/// Appends the object: fields that are absent or have their default are left out, 64-bit numbers are texts,
/// enums their names, numbers that are not finite "NaN", "Infinity" and "-Infinity". Messages of obliq.proto
/// have neither maps nor bytes.
void append_json(const google::protobuf::Message& message, std::string& out);

}  // namespace obliq::websocket
