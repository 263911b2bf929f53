#include "proto/bookmark.h"

#include "proto/limits.h"
#include "proto/utf8.h"

namespace obliq::wire {
namespace {

/// Of C0 and DEL, or of C1, which UTF-8 has as 0xc2 0x80 to 0x9f (ECMA-48 5.2): a terminal would obey them.
bool is_control(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) {
    return static_cast<unsigned char>(i < text.size() ? text[i] : 'x');
  };
  const bool c1 = byte(at) == 0xc2 && byte(at + 1) >= 0x80 && byte(at + 1) <= 0x9f;
  return byte(at) < 0x20 || byte(at) == 0x7f || c1;
}

}  // namespace

std::optional<BookmarkFault> bookmark_fault(std::string_view text) {
  const std::string allowed =
      "1 to " + std::to_string(kMaxBookmarkBytes) + " bytes of text without control characters";
  if (text.empty() || text.size() > kMaxBookmarkBytes)
    return BookmarkFault{std::to_string(text.size()) + " bytes", allowed};
  for (std::size_t at = 0; at < text.size(); at += character_bytes(text, at)) {
    if (character_bytes(text, at) == 0)
      return BookmarkFault{"no UTF-8 at byte " + std::to_string(at), allowed};
    if (is_control(text, at))
      return BookmarkFault{"a control character at byte " + std::to_string(at), allowed};
  }
  return std::nullopt;
}

}  // namespace obliq::wire
