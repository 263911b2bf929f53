#pragma once
// Hard limits of the stream. A peer that exceeds one is refused before anything is allocated for it.
#include <cstdint>

namespace obliq::wire {

constexpr std::uint16_t kDefaultPort = 7420;

/// Raw plane data of one block. Small enough that control messages never wait long behind it.
constexpr std::uint32_t kMaxPlaneBytes = 1u << 20;
/// Protobuf part of any message. A descriptor with 255 materials and many warnings stays under a quarter.
constexpr std::uint32_t kMaxDescriptorBytes = 1u << 18;
/// What a server accepts unless it is told otherwise.
constexpr std::uint32_t kMaxRequestBytes = 1u << 20;
/// Of that before Hello has been answered: a name and a token.
constexpr std::uint32_t kMaxHelloBytes = 4096;
/// What a client accepts.
constexpr std::uint32_t kMaxPayloadBytes = kMaxPlaneBytes + kMaxDescriptorBytes;

/// How long a message of a peer may be, behind its header: in all, and its protobuf part.
struct MessageLimits {
  constexpr MessageLimits(std::uint32_t payload, std::uint32_t descriptor = kMaxDescriptorBytes)
      : payload_bytes(payload), descriptor_bytes(descriptor) {}
  std::uint32_t payload_bytes;
  std::uint32_t descriptor_bytes;
};

/// Places of one QueryGround: three doubles each stay below kMaxDescriptorBytes, records below
/// kMaxPlaneBytes.
constexpr std::uint32_t kMaxQueryPoints = 10000;

/// Of a bookmark's text, in bytes of UTF-8.
constexpr std::uint32_t kMaxBookmarkBytes = 1000;

/// Names of clients, servers and radars, in bytes; longer ones are cut.
constexpr std::uint32_t kMaxNameBytes = 64;

}  // namespace obliq::wire
