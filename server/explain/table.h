#pragma once
// Tables and paragraphs of plain text.
#include <string>
#include <vector>

namespace obliq {

/// A number that rounds to zero is zero: no "-0.00".
inline double without_sign_of_zero(double value, double step) {
  return value < step / 2 && value > -step / 2 ? 0 : value;
}

/// Cells of text. The first two columns are words, the rest numbers.
struct Table {
  std::vector<std::vector<std::string>> head;  ///< one or more lines above the rule
  std::vector<std::vector<std::string>> rows;
};

/// Columns aligned by spaces, words to the left and cut to their column, numbers to the right.
std::string plain_table(const Table& table);
/// A Markdown table; the lines of the head are joined.
std::string markdown_table(const Table& table);

/// Breaks at spaces so that no line has more than `width` characters. The text stands `indent` to the right;
/// the label takes that room on the first line, or a line of its own where it is longer.
std::string wrapped(const std::string& label, const std::string& text, std::size_t width, std::size_t indent);

}  // namespace obliq
