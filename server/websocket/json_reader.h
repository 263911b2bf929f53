#pragma once
#include <optional>
#include <string>
#include <string_view>

namespace google::protobuf {
class Message;
}

namespace obliq::websocket {

/// Reads protobuf's JSON mapping into an empty message, in one pass and by reflection. Stricter than
/// protobuf's own reader, which accepts more than JSON (RFC 8259), and takes tens of milliseconds for a
/// megabyte of repeated keys or values: no key twice, and a list has at most as many values as its enum, or
/// kMaxQueryPoints. What is wrong, in a few words that hold little of the text; nothing when all is well.
[[nodiscard]] std::optional<std::string> read_json(std::string_view json, google::protobuf::Message& message);

}  // namespace obliq::websocket
