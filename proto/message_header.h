#pragma once
// The fixed little-endian header in front of every message; PROTOCOL.md has the byte table. Knows neither
// sockets nor protobuf: bytes in, fields out. Never throws.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "proto/limits.h"
#include "proto/message_type.h"

namespace obliq::wire {

constexpr std::uint32_t kMagic = 0x514C424F;  ///< the bytes "OBLQ"
constexpr std::uint8_t kMajorVersion = 1;
constexpr std::uint8_t kMinorVersion = 2;
constexpr std::size_t kHeaderBytes = 48;      ///< of this version
constexpr std::size_t kMaxHeaderBytes = 256;  ///< of any later minor version
constexpr std::size_t kCrcOffset = 40;

/// Of MessageHeader::flags: the descriptor is JSON, and there is no CRC (PROTOCOL.md, "WebSocket").
constexpr std::uint16_t kJsonDescriptor = 1;

using HeaderBytes = std::array<std::byte, kHeaderBytes>;

struct MessageHeader {
  std::uint8_t major = kMajorVersion;
  std::uint8_t minor = kMinorVersion;
  MessageType type{};
  std::uint16_t flags = 0;  ///< kJsonDescriptor; unknown ones are ignored
  std::uint16_t header_length = kHeaderBytes;
  std::uint32_t payload_length = 0;     ///< bytes after the header
  std::uint32_t descriptor_length = 0;  ///< of those, the first that are protobuf; the rest is plane data
  std::uint32_t stream_id = 0;          ///< 0: control; else the stream that FrameBegin opened
  std::uint64_t sequence = 0;           ///< rises within a stream, gaps are messages not sent to this peer
  std::int64_t utc_ns = 0;              ///< when encoded, nanoseconds since 1970-01-01T00:00Z
  std::uint32_t crc = 0;                ///< CRC-32C over header (this field zero) and payload
};

enum class HeaderStatus { ok, bad_magic, version_mismatch, bad_length };

/// One sentence for a log or an Error message: what was found and what is allowed.
std::string describe(HeaderStatus status, const MessageHeader& header, const MessageLimits& limits);

/// Writes all fields, the magic and the reserved zero; crc as it stands in `header`.
void encode_header(const MessageHeader& header, std::span<std::byte, kHeaderBytes> out);

/// Reads the first kHeaderBytes of a message and checks magic, major version and lengths. When
/// header_length is more than kHeaderBytes the caller reads the excess before the payload.
[[nodiscard]] HeaderStatus decode_header(std::span<const std::byte, kHeaderBytes> bytes,
                                         const MessageLimits& limits, MessageHeader& header);

/// CRC-32C (Castagnoli; RFC 3720 appendix B.4): reflected, initial value and final xor all ones, so that
/// crc32c("123456789") = 0xE3069283. To continue over more bytes, pass the value so far.
std::uint32_t crc32c(std::span<const std::byte> bytes, std::uint32_t so_far = 0);

/// The CRC of a message, for header bytes (the whole header, any length) whose CRC field is taken as zero.
std::uint32_t message_crc(std::span<const std::byte> header, std::span<const std::byte> payload);

}  // namespace obliq::wire
