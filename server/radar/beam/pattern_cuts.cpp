#include "server/radar/beam/pattern_cuts.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <string>
#include <string_view>

#include "terrain/base/errors.h"
#include "terrain/base/files.h"

namespace obliq {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
constexpr std::size_t kMostRows = 100'000;
constexpr std::size_t kLongestLine = 200;
/// A table that steps over half its own beam says nothing about it.
constexpr std::size_t kLeastRows = 3;

/// Beyond these a table is of losses, of ratios, or cut off.
constexpr double kMostOffBoresight_db = 6;
constexpr double kLeastEdge_db = 10;
constexpr double kAllRound_rad = 355 * std::numbers::pi / 180;

std::string decibels(double db) { return fmt::format("{:.3g}", db); }

/// The file and the line that is being read.
struct Place {
  const std::filesystem::path& file;
  std::size_t line;
};

[[noreturn]] void refuse(const Place& at, const std::string& found, const std::string& allowed) {
  throw InputError(at.file.string() + ":" + std::to_string(at.line) + ": beam.file: found " + found +
                   "; allowed: " + allowed);
}

std::string shown(std::string_view text) {
  std::string result = "\"";
  for (const char c : text.substr(0, 40)) result += c >= ' ' && c < 0x7f ? c : '?';
  return result + "\"";
}

double number(const Place& at, const std::string& text, double low, double high) {
  std::size_t used = 0;
  double value = 0;
  try {
    value = std::stod(text, &used);
  } catch (const std::exception&) {
    used = 0;
  }
  if (text.empty() || used != text.size() || !(value >= low && value <= high))
    refuse(at, shown(text),
           "a number from " + std::to_string(static_cast<int>(low)) + " to " +
               std::to_string(static_cast<int>(high)));
  return value;
}

void take_row(const Place& at, const std::string& line, PatternCuts& cuts) {
  const std::size_t first = line.find(',');
  const std::size_t second = first == std::string::npos ? first : line.find(',', first + 1);
  if (second == std::string::npos || line.find(',', second + 1) != std::string::npos)
    refuse(at, shown(line), "cut,angle_deg,gain_db");
  const std::string cut_name = line.substr(0, first);
  if (cut_name != "azimuth" && cut_name != "elevation") refuse(at, shown(cut_name), "azimuth or elevation");
  PatternCut& cut = cut_name == "azimuth" ? cuts.azimuth : cuts.elevation;
  const double angle =
      number(at, line.substr(first + 1, second - first - 1), -180, 180) * std::numbers::pi / 180;
  if (!cut.angle_rad.empty() && angle <= cut.angle_rad.back())
    refuse(at, shown(line.substr(first + 1, second - first - 1)), "angles that rise from row to row");
  cut.angle_rad.push_back(angle);
  cut.gain_db.push_back(number(at, line.substr(second + 1), -300, 100));
}

/// Relative to the peak, which must be near the boresight: a table in the wrong units or of the wrong cut has
/// it elsewhere.
void normalise(const Place& end, const std::string& name, PatternCut& cut) {
  if (cut.angle_rad.empty()) return;
  if (cut.angle_rad.size() < kLeastRows)
    refuse(end, std::to_string(cut.angle_rad.size()) + " rows of cut " + name,
           "at least " + std::to_string(kLeastRows));
  if (cut.angle_rad.front() > 0 || cut.angle_rad.back() < 0)
    refuse(end, "a cut " + name + " that leaves out angle 0",
           "angles from the boresight, on both sides of it");
  const double peak = *std::ranges::max_element(cut.gain_db);
  for (double& gain : cut.gain_db) gain -= peak;
  const double ahead_db = 10 * std::log10(cut.gain(0));
  if (ahead_db < -kMostOffBoresight_db)
    refuse(end, "a cut " + name + " that is " + decibels(-ahead_db) + " dB below its peak at angle 0",
           "gains, not losses, with the peak on the boresight or at most " + decibels(kMostOffBoresight_db) +
               " dB above it");
  const bool all_round = cut.angle_rad.back() - cut.angle_rad.front() >= kAllRound_rad;
  const double edge_db = std::max(cut.gain_db.front(), cut.gain_db.back());
  if (!all_round && edge_db > -kLeastEdge_db)
    refuse(end, "a cut " + name + " that is only " + decibels(-edge_db) + " dB below its peak where it ends",
           "dB, not ratios, and angles as far as at least " + decibels(kLeastEdge_db) + " dB below the peak");
}

}  // namespace

double PatternCut::gain(double offset_rad) const {
  if (angle_rad.empty() || !(offset_rad >= angle_rad.front() && offset_rad <= angle_rad.back())) return 0;
  const auto above = std::ranges::upper_bound(angle_rad, offset_rad);
  const auto k = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(
      above - angle_rad.begin(), 1, static_cast<std::ptrdiff_t>(angle_rad.size()) - 1));
  const double share = (offset_rad - angle_rad[k - 1]) / (angle_rad[k] - angle_rad[k - 1]);
  return std::pow(10, (gain_db[k - 1] + share * (gain_db[k] - gain_db[k - 1])) / 10);
}

double PatternCut::extent_rad(double edge) const {
  const double edge_db = 10 * std::log10(edge);
  double extent = 0;
  for (std::size_t k = 0; k < angle_rad.size(); ++k)
    for (const std::size_t near : {k == 0 ? k : k - 1, std::min(k + 1, angle_rad.size() - 1)})
      if (gain_db[k] > edge_db) extent = std::max(extent, std::abs(angle_rad[near]));
  return extent;
}

PatternCuts read_pattern_cuts(const std::filesystem::path& file) {
  refuse_endless_file(file.string() + ": beam.file", file.string());
  std::ifstream stream(file, std::ios::binary);
  Place at{file, 0};
  std::error_code none;
  if (!stream || std::filesystem::is_directory(file, none))
    throw InputError(file.string() + ": beam.file: cannot be read; allowed: a readable file");
  PatternCuts cuts;
  cuts.path = file;
  std::string line;
  for (char c = 0; stream.get(c);) {
    if (c != '\n') {
      line += c;
      if (line.size() > kLongestLine)
        refuse({file, at.line + 1}, "a line of more than " + std::to_string(kLongestLine) + " characters",
               "cut,angle_deg,gain_db");
      if (stream.peek() != std::ifstream::traits_type::eof()) continue;
    }
    if (++at.line > kMostRows) refuse(at, "more rows", "at most " + std::to_string(kMostRows));
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (at.line == 1) {
      if (line.starts_with(kByteOrderMark)) line.erase(0, kByteOrderMark.size());  // of spreadsheets
      // What was found is not shown: the file may be any, under a wrong name.
      if (line != "cut,angle_deg,gain_db")
        refuse(at, "another first line", "the heading cut,angle_deg,gain_db");
    } else if (!line.empty()) {
      take_row(at, line, cuts);
    }
    line.clear();
  }
  if (cuts.azimuth.angle_rad.empty() && cuts.elevation.angle_rad.empty())
    refuse(at, "no rows", "rows of the cuts azimuth and elevation");
  normalise(at, "azimuth", cuts.azimuth);
  normalise(at, "elevation", cuts.elevation);
  return cuts;
}

}  // namespace obliq
