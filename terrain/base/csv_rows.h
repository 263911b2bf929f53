#pragma once
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace obliq {

/// The rows of a small table of texts and numbers with a heading, one after the other. What is wrong is told
/// by InputError with file, line and the key that names the file.
class CsvRows {
 public:
  /// heading: what the first line must be, "cut,angle_deg,gain_db". Throws InputError where it is another.
  CsvRows(const std::filesystem::path& file, std::string key, std::string heading);

  /// To the next row that is not empty; false at the end. Throws InputError of a row that has another number
  /// of cells than the heading, of lines and tables that are too long.
  bool next();
  const std::string& cell(std::size_t column) const { return cells_[column]; }
  double number(std::size_t column, double low, double high) const;

  /// About the current row, or after the end the last line.
  [[noreturn]] void refuse(const std::string& found, const std::string& allowed) const;
  /// What a cell says, fit to show.
  static std::string shown(std::string_view text);

 private:
  bool read_line(std::string& line);
  std::vector<std::string> split(const std::string& line) const;

  std::filesystem::path file_;
  std::string key_, heading_;
  std::ifstream stream_;
  std::size_t line_ = 0;
  std::vector<std::string> cells_;
};

}  // namespace obliq
