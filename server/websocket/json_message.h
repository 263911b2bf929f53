#pragma once
// Messages whose descriptor is JSON, to and from those of the stream: the header's flag kJsonDescriptor, no
// CRC, and instead of protobuf its JSON mapping (PROTOCOL.md, "WebSocket"). Knows no sockets.
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "proto/error_number.h"
#include "proto/message_codec.h"

namespace obliq::websocket {

/// The subprotocol's name in the opening handshake (RFC 6455 section 1.9).
constexpr const char* kSubprotocol = "obliq.v1.json";
/// Of MessageHeader::flags.
constexpr std::uint16_t kJsonDescriptor = 1;
/// Objects and lists in each other; messages of obliq.proto have less than half of it.
constexpr int kMaxDepth = 16;

struct Refusal {
  wire::ErrorNumber number{};
  std::string text;  ///< what was found and what is allowed
};

/// A whole message of a peer as the stream has it, with its CRC. Types that are not known come without their
/// descriptor. Refused is what Welcome.limits do not allow, is no JSON, or has a field that its message has
/// not; the text names it.
[[nodiscard]] std::optional<Refusal> to_binary(std::span<const std::byte> message,
                                               std::uint32_t max_request_bytes, wire::Bytes& binary);

/// A whole message of the stream in two parts: header and descriptor, and the plane, which is unchanged and
/// still that of `message`. False when it is not one whole message of a type that PROTOCOL.md has.
struct JsonMessage {
  std::string head;
  std::span<const std::byte> plane;
};
[[nodiscard]] bool to_json(std::span<const std::byte> message, JsonMessage& json);

}  // namespace obliq::websocket
