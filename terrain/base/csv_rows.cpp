#include "terrain/base/csv_rows.h"

#include <algorithm>
#include <utility>

#include "terrain/base/errors.h"
#include "terrain/base/files.h"

namespace obliq {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
constexpr std::size_t kMostRows = 100'000;
constexpr std::size_t kLongestLine = 200;

}  // namespace

std::string CsvRows::shown(std::string_view text) {
  std::string result = "\"";
  for (const char c : text.substr(0, 40)) result += c >= ' ' && c < 0x7f ? c : '?';
  return result + "\"";
}

CsvRows::CsvRows(const std::filesystem::path& file, std::string key, std::string heading)
    : file_(file), key_(std::move(key)), heading_(std::move(heading)) {
  refuse_endless_file(file.string() + ": " + key_, file.string());
  stream_.open(file, std::ios::binary);
  std::error_code none;
  if (!stream_ || std::filesystem::is_directory(file, none))
    throw InputError(file.string() + ": " + key_ + ": cannot be read; allowed: a readable file");
  std::string line;
  if (!read_line(line)) refuse("no rows", "the heading " + heading_ + ", and rows");
  if (line.starts_with(kByteOrderMark)) line.erase(0, kByteOrderMark.size());  // of spreadsheets
  // What was found is not shown: the file may be any, under a wrong name.
  if (line != heading_) refuse("another first line", "the heading " + heading_);
}

void CsvRows::refuse(const std::string& found, const std::string& allowed) const {
  throw InputError(file_.string() + ":" + std::to_string(std::max<std::size_t>(line_, 1)) + ": " + key_ +
                   ": found " + found + "; allowed: " + allowed);
}

bool CsvRows::read_line(std::string& line) {
  line.clear();
  if (stream_.peek() == std::ifstream::traits_type::eof()) return false;
  if (++line_ > kMostRows) refuse("more rows", "at most " + std::to_string(kMostRows));
  for (char c = 0; stream_.get(c) && c != '\n';) {
    line += c;
    if (line.size() > kLongestLine)
      refuse("a line of more than " + std::to_string(kLongestLine) + " characters", heading_);
  }
  if (!line.empty() && line.back() == '\r') line.pop_back();
  return true;
}

std::vector<std::string> CsvRows::split(const std::string& line) const {
  std::vector<std::string> cells;
  for (std::size_t from = 0; from <= line.size();) {
    const std::size_t comma = std::min(line.find(',', from), line.size());
    cells.push_back(line.substr(from, comma - from));
    from = comma + 1;
  }
  return cells;
}

bool CsvRows::next() {
  std::string line;
  do {
    if (!read_line(line)) return false;
  } while (line.empty());
  cells_ = split(line);
  if (cells_.size() != split(heading_).size()) refuse(shown(line), heading_);
  return true;
}

double CsvRows::number(std::size_t column, double low, double high) const {
  const std::string& text = cells_[column];
  std::size_t used = 0;
  double value = 0;
  try {
    value = std::stod(text, &used);
  } catch (const std::exception&) {
    used = 0;
  }
  if (text.empty() || used != text.size() || !(value >= low && value <= high))
    refuse(shown(text), "a number from " + std::to_string(static_cast<int>(low)) + " to " +
                            std::to_string(static_cast<int>(high)));
  return value;
}

}  // namespace obliq
