#pragma once
// A reader of CSV of its own (RFC 4180), so that what our programs write is read by rules that are not
// theirs.
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace obliq::test {

using CsvRow = std::map<std::string, std::string>;

/// Fields of each line.
inline std::vector<std::vector<std::string>> parse_csv(const std::string& text) {
  std::vector<std::vector<std::string>> lines;
  std::vector<std::string> line;
  std::string field;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted && c == '"' && i + 1 < text.size() && text[i + 1] == '"') {
      field += text[++i];
    } else if (c == '"') {
      quoted = !quoted;
    } else if (quoted || (c != ',' && c != '\n')) {
      field += c;
    } else {
      line.push_back(field);
      field.clear();
      if (c == '\n') {
        lines.push_back(line);
        line.clear();
      }
    }
  }
  return lines;
}

/// The lines below the header, by the header's names. Throws when a line has another number of fields.
inline std::vector<CsvRow> csv_rows(const std::string& text) {
  const auto lines = parse_csv(text);
  std::vector<CsvRow> rows;
  for (std::size_t n = 1; n < lines.size(); ++n) {
    if (lines[n].size() != lines[0].size()) throw std::runtime_error("csv: line " + std::to_string(n + 1));
    CsvRow row;
    for (std::size_t k = 0; k < lines[n].size(); ++k) row[lines[0][k]] = lines[n][k];
    rows.push_back(row);
  }
  return rows;
}

}  // namespace obliq::test
