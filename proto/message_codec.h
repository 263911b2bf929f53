#pragma once
// Whole messages: header, protobuf part, plane data, CRC. Protobuf types appear by name only.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "proto/message_header.h"

namespace google::protobuf {
class MessageLite;
}

namespace obliq::wire {

using Bytes = std::vector<std::byte>;

/// Where a message belongs; the codec fills in lengths and CRC.
struct Addressing {
  std::uint32_t stream_id = 0;
  std::uint64_t sequence = 0;
  std::int64_t utc_ns = 0;
};

/// A complete message. Empty when the parts exceed the limits of limits.h, which is a fault of the caller, or
/// the protobuf part those given. memory: the message is written there, where it has room.
Bytes encode_message(MessageType type, const Addressing& addressing,
                     const google::protobuf::MessageLite& descriptor, std::span<const std::byte> plane = {},
                     std::uint32_t max_descriptor_bytes = kMaxDescriptorBytes, Bytes memory = {});

enum class MessageStatus { ok, need_more, bad_magic, version_mismatch, bad_length, bad_crc };

/// A message inside a buffer. The spans point into that buffer.
struct MessageView {
  MessageHeader header;
  std::span<const std::byte> descriptor;
  std::span<const std::byte> plane;
  std::size_t size = 0;  ///< bytes of the whole message
};

/// Decodes the message at the front of `bytes`; need_more when it is not all there yet.
[[nodiscard]] MessageStatus decode_message(std::span<const std::byte> bytes, const MessageLimits& limits,
                                           MessageView& view);

/// Parses the protobuf part. False when the bytes are not such a message.
[[nodiscard]] bool parse_descriptor(std::span<const std::byte> bytes,
                                    google::protobuf::MessageLite& descriptor);

/// Now, in nanoseconds since 1970-01-01T00:00Z.
std::int64_t utc_now_ns();

}  // namespace obliq::wire
