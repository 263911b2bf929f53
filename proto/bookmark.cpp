#include "proto/bookmark.h"

#include "proto/limits.h"

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

/// Of the character that begins there in UTF-8 (RFC 3629, section 4); 0: none does.
std::size_t character_bytes(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(i < text.size() ? text[i] : 0); };
  const auto goes_on = [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i)
      if (byte(at + i) < 0x80 || byte(at + i) > 0xbf) return false;
    return true;
  };
  const unsigned char first = byte(at);
  const unsigned char second = byte(at + 1);
  if (first < 0x80) return 1;
  if (first >= 0xc2 && first <= 0xdf) return goes_on(1, 2) ? 2 : 0;
  if (first >= 0xe0 && first <= 0xef) {
    const bool fits = !(first == 0xe0 && second < 0xa0) && !(first == 0xed && second > 0x9f);
    return fits && goes_on(1, 3) ? 3 : 0;
  }
  if (first >= 0xf0 && first <= 0xf4) {
    const bool fits = !(first == 0xf0 && second < 0x90) && !(first == 0xf4 && second > 0x8f);
    return fits && goes_on(1, 4) ? 4 : 0;
  }
  return 0;
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
