#pragma once
#include <initializer_list>
#include <string>
#include <string_view>

namespace obliq {

/// The parameters for a terminal: one line each.
std::string parameters_text();

/// Every key as an object of a JSON array: key, message_field (or null), type, unit, default, limits
/// (at_least, above, at_most, below, one_of, retired), allowed in words, change (live, reload, restart),
/// text. Of a radar's parameter also enumerators (name to that of the message), and knob, modes, of_programs,
/// not_ideal where its Meaning has them.
std::string parameters_json();

/// The file of a radar preset. Throws InputError for a name that is none.
std::string preset_text(std::string_view name);

/// The reference page server/control/PARAMETERS.md; a test compares the two.
std::string parameters_markdown();

/// Of the reference pages' Markdown: text as code; empty stays empty.
std::string markdown_code(std::string_view text);
/// "| a | b |" and a line break; bars inside a cell are escaped.
std::string markdown_row(std::initializer_list<std::string_view> cells);

}  // namespace obliq
