#include "proto/message_header.h"

#include <isa-l/crc.h>

#include <type_traits>

namespace obliq::wire {
namespace {

// Byte by byte, so that neither the machine's byte order nor alignment matters.
template <typename T>
void put(std::byte*& at, T value) {
  const auto bits = static_cast<std::make_unsigned_t<T>>(value);
  for (std::size_t i = 0; i < sizeof(T); ++i) *at++ = static_cast<std::byte>((bits >> (8 * i)) & 0xFF);
}

template <typename T>
T take(const std::byte*& at) {
  std::make_unsigned_t<T> bits = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i)
    bits = static_cast<std::make_unsigned_t<T>>(
        bits | (static_cast<std::make_unsigned_t<T>>(std::to_integer<std::uint8_t>(*at++)) << (8 * i)));
  return static_cast<T>(bits);
}

}  // namespace

std::string describe(HeaderStatus status, const MessageHeader& header, const MessageLimits& limits) {
  switch (status) {
    case HeaderStatus::ok:
      return "ok";
    case HeaderStatus::bad_magic:
      return "not an obliq stream: the message does not begin with OBLQ";
    case HeaderStatus::version_mismatch:
      return "protocol version: found " + std::to_string(header.major) + "." + std::to_string(header.minor) +
             "; allowed: " + std::to_string(kMajorVersion) + ".x";
    case HeaderStatus::bad_length:
      return "message lengths: found header " + std::to_string(header.header_length) + ", protobuf " +
             std::to_string(header.descriptor_length) + ", payload " + std::to_string(header.payload_length) +
             " bytes; allowed: header " + std::to_string(kHeaderBytes) + " to " +
             std::to_string(kMaxHeaderBytes) + ", protobuf at most " +
             std::to_string(limits.descriptor_bytes) + " and the payload, payload at most " +
             std::to_string(limits.payload_bytes);
  }
  return "?";
}

std::uint32_t crc32c(std::span<const std::byte> bytes, std::uint32_t so_far) {
  // ISA-L's function is the bare register: it neither inverts the seed nor the result, and counts in int.
  std::uint32_t state = ~so_far;
  while (!bytes.empty()) {
    const std::size_t n = std::min<std::size_t>(bytes.size(), std::size_t{1} << 30);
    // The parameter is not const, but the function only reads.
    auto* data = reinterpret_cast<unsigned char*>(const_cast<std::byte*>(bytes.data()));
    state = crc32_iscsi(data, static_cast<int>(n), state);
    bytes = bytes.subspan(n);
  }
  return ~state;
}

void encode_header(const MessageHeader& header, std::span<std::byte, kHeaderBytes> out) {
  std::byte* at = out.data();
  put(at, kMagic);
  put(at, header.major);
  put(at, header.minor);
  put(at, static_cast<std::uint16_t>(header.type));
  put(at, header.flags);
  put(at, header.header_length);
  put(at, header.payload_length);
  put(at, header.descriptor_length);
  put(at, header.stream_id);
  put(at, header.sequence);
  put(at, header.utc_ns);
  put(at, header.crc);
  put(at, std::uint32_t{0});
}

HeaderStatus decode_header(std::span<const std::byte, kHeaderBytes> bytes, const MessageLimits& limits,
                           MessageHeader& header) {
  const std::byte* at = bytes.data();
  const auto magic = take<std::uint32_t>(at);
  header.major = take<std::uint8_t>(at);
  header.minor = take<std::uint8_t>(at);
  header.type = static_cast<MessageType>(take<std::uint16_t>(at));
  header.flags = take<std::uint16_t>(at);
  header.header_length = take<std::uint16_t>(at);
  header.payload_length = take<std::uint32_t>(at);
  header.descriptor_length = take<std::uint32_t>(at);
  header.stream_id = take<std::uint32_t>(at);
  header.sequence = take<std::uint64_t>(at);
  header.utc_ns = take<std::int64_t>(at);
  header.crc = take<std::uint32_t>(at);
  // In this order: only bytes that are ours have a version, only our version has these lengths.
  if (magic != kMagic) return HeaderStatus::bad_magic;
  if (header.major != kMajorVersion) return HeaderStatus::version_mismatch;
  if (header.header_length < kHeaderBytes || header.header_length > kMaxHeaderBytes ||
      header.payload_length > limits.payload_bytes || header.descriptor_length > limits.descriptor_bytes ||
      header.descriptor_length > header.payload_length)
    return HeaderStatus::bad_length;
  return HeaderStatus::ok;
}

std::uint32_t message_crc(std::span<const std::byte> header, std::span<const std::byte> payload) {
  constexpr std::size_t kCrcBytes = sizeof(std::uint32_t);
  const std::array<std::byte, kCrcBytes> zero{};
  std::uint32_t crc = crc32c(header.first(kCrcOffset));
  crc = crc32c(zero, crc);
  crc = crc32c(header.subspan(kCrcOffset + kCrcBytes), crc);
  return crc32c(payload, crc);
}

}  // namespace obliq::wire
