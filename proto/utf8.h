#pragma once
// Texts of messages are UTF-8 (RFC 3629, section 4): a peer ends the connection over one that is not.
#include <cstddef>
#include <optional>
#include <string_view>

namespace obliq::wire {

/// Of the character that begins there; 0: none does.
std::size_t character_bytes(std::string_view text, std::size_t at);

/// The byte where it is no UTF-8; nothing: it is.
std::optional<std::size_t> utf8_fault(std::string_view text);

}  // namespace obliq::wire
