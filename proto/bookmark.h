#pragma once
// What a bookmark's text may be. PROTOCOL.md, "The log of an exercise".
#include <optional>
#include <string>
#include <string_view>

namespace obliq::wire {

struct BookmarkFault {
  std::string found;
  std::string allowed;
};

/// Nothing: it is good. Servers refuse a fault, and clients before they send it.
std::optional<BookmarkFault> bookmark_fault(std::string_view text);

}  // namespace obliq::wire
