#pragma once
#include <filesystem>
#include <string>

#include "proto/message_type.h"

namespace obliq::wire {
class RenderOnce;
}

namespace obliq::fuzz {

const std::filesystem::path& corpus_folder();
void write_seed(const std::string& target, const std::string& name, const std::string& bytes);

/// A request as fuzz_requests reads it.
template <typename Message>
std::string request(wire::MessageType type, const Message& message, bool second_client = false) {
  const std::string descriptor = message.SerializeAsString();
  std::string bytes{second_client ? '\x80' : '\0', static_cast<char>(type)};
  bytes += static_cast<char>(descriptor.size() & 0xFF);
  bytes += static_cast<char>(descriptor.size() >> 8);
  return bytes + descriptor;
}

constexpr char kMended = 1;  ///< first byte of a stream whose CRCs are put right

/// A stream of pulses.
void write_trains();

/// Those about targets; once: a RenderOnce that is good.
void write_target_requests(const wire::RenderOnce& once);

/// The files that GDAL reads.
void write_elevations();
void write_footprints();

}  // namespace obliq::fuzz
