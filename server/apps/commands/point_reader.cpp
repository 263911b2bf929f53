#include "server/apps/commands/point_reader.h"

#include <charconv>
#include <fstream>
#include <iostream>
#include <optional>

#include "terrain/base/errors.h"
#include "terrain/base/files.h"
#include "terrain/base/text.h"

namespace obliq {
namespace {

constexpr std::size_t kMostPoints = 1'000'000;  ///< of a file: each is kept in memory

std::optional<double> number_of(std::string text) {
  const std::size_t begin = text.find_first_not_of(" \t\r");
  if (begin == std::string::npos) return std::nullopt;
  text = text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

GivenPoint parse_point(const std::string& text, const std::string& where) {
  const std::vector<std::string> fields = csv_fields(text);
  double numbers[3] = {};
  bool good = fields.size() == 2 || fields.size() == 3;
  for (std::size_t k = 0; good && k < fields.size(); ++k) {
    const auto number = number_of(fields[k]);
    good = number.has_value();
    if (good) numbers[k] = *number;
  }
  if (!good)
    throw InputError(
        where + ": found " + printable_text(text, 80) +
        "; allowed: two or three numbers with commas between them, the third a height in metres");
  return {numbers[0], numbers[1], numbers[2], fields.size() == 3};
}

std::vector<GivenPoint> read_points(const std::string& path) {
  std::ifstream file;
  if (path != "-") {
    refuse_endless_file("--points: " + path, path);
    file.open(path);
    if (!file) throw InputError("--points: " + path + " cannot be read");
  }
  std::istream& lines = path == "-" ? std::cin : file;
  std::vector<GivenPoint> points;
  std::string line;
  for (std::size_t number = 1; std::getline(lines, line); ++number) {
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin == std::string::npos || line[begin] == '#') continue;
    const bool header = points.empty() && !number_of(csv_fields(line).front());
    if (header) continue;
    try {
      points.push_back(parse_point(line, path + ":" + std::to_string(number)));
    } catch (const InputError&) {
      // Before a first point the file may be any, under a wrong name: nothing of it is shown.
      if (!points.empty()) throw;
      throw InputError(path + ":" + std::to_string(number) +
                       ": found no point; allowed: two or three numbers with commas between them");
    }
    if (points.size() > kMostPoints)
      throw InputError("--points: found more than " + std::to_string(kMostPoints) +
                       " points; allowed: that many; split the file");
  }
  if (points.empty()) throw InputError("--points: " + path + ": found no point; allowed: at least one");
  return points;
}

}  // namespace obliq
