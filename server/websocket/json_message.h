#pragma once
// Messages whose descriptor is JSON, to and from those of the stream: the header's flag kJsonDescriptor, no
// CRC, and instead of protobuf its JSON mapping (PROTOCOL.md, "WebSocket"). Knows no sockets.
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
/// Of MessageHeader::flags.
constexpr std::uint16_t kJsonDescriptor = 1;

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

/// A whole message of the stream in two parts: header and descriptor, and the plane, which is unchanged and
/// still that of `message`. False when it is not one whole message of a type that PROTOCOL.md has.
struct JsonMessage {
  std::string head;
  std::span<const std::byte> plane;
};
[[nodiscard]] bool to_json(std::span<const std::byte> message, JsonMessage& json);

}  // namespace obliq::websocket
