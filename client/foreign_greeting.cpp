#include "client/foreign_greeting.h"

#include <algorithm>
#include <cstdio>
#include <string_view>

namespace obliq::client {
namespace {

struct Known {
  std::string_view beginning;
  std::string_view program;
};
// RFC 9112, RFC 4253 4.2, RFC 8446 5.1 (records of type alert and handshake), RFC 5321 and RFC 959 (220).
constexpr Known kKnown[] = {
    {"HTTP/", "an HTTP server (obliqd's own has another port than its stream)"},
    {"SSH-", "an SSH server"},
    {"\x15\x03", "a server that speaks TLS (obliq: --tls, if it is obliqd)"},
    {"\x16\x03", "a server that speaks TLS (obliq: --tls, if it is obliqd)"},
    {"220", "a mail or FTP server"},
};

bool is_printable(char c) { return c >= ' ' && c <= '~'; }

/// The first line as text, or the first bytes as numbers.
std::string shown(std::string_view text) {
  const std::string_view line = text.substr(0, text.find_first_of("\r\n"));
  if (!line.empty() && std::ranges::all_of(line, is_printable)) return "\"" + std::string(line) + "\"";
  std::string bytes = "the bytes";
  for (const char c : text.substr(0, 8)) {
    char number[4];
    std::snprintf(number, sizeof number, " %02X", static_cast<unsigned>(static_cast<unsigned char>(c)));
    bytes += number;
  }
  return bytes;
}

}  // namespace

std::string foreign_greeting(std::span<const std::byte> first) {
  const std::string_view text(reinterpret_cast<const char*>(first.data()), first.size());
  std::string_view program = "another program";
  for (const Known& known : kKnown)
    if (text.starts_with(known.beginning)) program = known.program;
  return "not an obliq stream: found " + shown(text) + ", which is " + std::string(program) +
         "; allowed: where obliqd listens (server.port, 7420 unless its scene file says otherwise)";
}

}  // namespace obliq::client
