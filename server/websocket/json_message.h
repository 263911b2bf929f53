#pragma once
// Messages whose descriptor is JSON, as peers send them: the header's flag kJsonDescriptor, no CRC, and
// instead of protobuf its JSON mapping (PROTOCOL.md, "WebSocket"; wire::json_head writes them). Knows no
// sockets.
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "proto/error_number.h"
#include "proto/message_codec.h"

namespace google::protobuf {
class Message;
}

namespace obliq::websocket {

/// The subprotocol's name in the opening handshake (RFC 6455 section 1.9).
constexpr const char* kSubprotocol = "obliq.v1.json";

/// Of every type but QueryGround, whose lists are long: reading a megabyte takes the thread that all clients
/// share up to 8 ms.
constexpr std::uint32_t kMaxJsonBytes = 65536;

/// An empty message of a type; null: a later version's.
const google::protobuf::Message* example_of(wire::MessageType type);

struct Refusal {
  wire::ErrorNumber number{};
  std::string text;  ///< what was found and what is allowed
};

/// A whole message of a peer as the stream has it, with its CRC. Types that are not known come without their
/// descriptor. Refused is what is too long, as JSON or as protobuf, is no JSON, or has a field that its
/// message has not; the text names it, and `binary` is left as it was.
[[nodiscard]] std::optional<Refusal> to_binary(std::span<const std::byte> message,
                                               const wire::MessageLimits& limits, wire::Bytes& binary);

}  // namespace obliq::websocket
