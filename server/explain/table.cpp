#include "server/explain/table.h"

#include <algorithm>

namespace obliq {
namespace {

constexpr std::size_t kWordColumns = 2;
constexpr std::size_t kWidestWord = 20;
constexpr const char* kGap = "  ";

std::string padded(const std::string& text, std::size_t width, bool left) {
  const std::string space(width > text.size() ? width - text.size() : 0, ' ');
  return left ? text + space : space + text;
}

std::string cut(const std::string& text) {
  return text.size() <= kWidestWord ? text : text.substr(0, kWidestWord - 2) + "..";
}

}  // namespace

std::string plain_table(const Table& table) {
  std::vector<std::vector<std::string>> lines = table.head;
  lines.insert(lines.end(), table.rows.begin(), table.rows.end());
  std::vector<std::size_t> widths;
  for (std::vector<std::string>& line : lines) {
    widths.resize(std::max(widths.size(), line.size()));
    for (std::size_t c = 0; c < line.size(); ++c) {
      if (c < kWordColumns) line[c] = cut(line[c]);
      widths[c] = std::max(widths[c], line[c].size());
    }
  }
  std::string text;
  for (std::size_t n = 0; n < lines.size(); ++n) {
    if (n == table.head.size()) {
      std::size_t rule = widths.empty() ? 0 : 2 * (widths.size() - 1);
      for (const std::size_t width : widths) rule += width;
      text += std::string(rule, '-') + "\n";
    }
    std::string line;
    for (std::size_t c = 0; c < lines[n].size(); ++c)
      line += (c > 0 ? kGap : "") + padded(lines[n][c], widths[c], c < kWordColumns);
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

std::string markdown_table(const Table& table) {
  std::string text = "|";
  const std::size_t columns = table.head.empty() ? 0 : table.head.front().size();
  for (std::size_t c = 0; c < columns; ++c) {
    std::string title;
    for (const auto& line : table.head)
      if (!line[c].empty()) title += (title.empty() ? "" : " ") + line[c];
    text += " " + title + " |";
  }
  text += "\n|";
  for (std::size_t c = 0; c < columns; ++c) text += c < kWordColumns ? "---|" : "---:|";
  for (const auto& row : table.rows) {
    text += "\n|";
    for (const std::string& cell : row) text += " " + cell + " |";
  }
  return text + "\n";
}

std::string wrapped(const std::string& label, const std::string& text, std::size_t width,
                    std::size_t indent) {
  const std::string margin(indent, ' ');
  const bool own_line = label.size() >= indent && !label.empty();
  std::string result = own_line ? label + "\n" : "";
  std::string line = own_line ? margin : padded(label, indent, true);
  std::size_t words = 0;
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    const std::string word = text.substr(at, end - at);
    at = end + 1;
    if (words > 0 && line.size() + 1 + word.size() > width) {
      result += line + "\n";
      line = margin;
      words = 0;
    }
    line += (words++ > 0 ? " " : "") + word;
  }
  return result + line + "\n";
}

}  // namespace obliq
