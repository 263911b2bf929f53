#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace obliq::client {

struct Endpoint {
  std::string host;
  std::uint16_t port = 0;

  std::string text() const;
};

/// "HOST", "HOST:PORT", ":PORT", "PORT", "[IPv6]" or "[IPv6]:PORT"; without a port the default one, without a
/// host 127.0.0.1. Nothing if it is none of these.
std::optional<Endpoint> parse_endpoint(std::string_view text);

}  // namespace obliq::client
