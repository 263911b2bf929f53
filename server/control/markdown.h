#pragma once
// The reference pages' Markdown.
#include <initializer_list>
#include <string>
#include <string_view>

namespace obliq::markdown {

std::string code(std::string_view text);  ///< empty stays empty

/// "| a | b |" and a line break; bars inside a cell are escaped.
std::string row(std::initializer_list<std::string_view> cells);

}  // namespace obliq::markdown
