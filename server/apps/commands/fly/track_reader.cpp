#include "server/apps/commands/fly/track_reader.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <optional>
#include <sstream>
#include <system_error>
#include <utility>

#include "server/control/parameters.h"
#include "terrain/base/errors.h"
#include "terrain/base/text.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

constexpr std::size_t kLongestLine = 4096;
constexpr std::size_t kColumns = 5;
constexpr std::size_t kLongestFound = 40;  // of what a complaint repeats

struct Column {
  std::string_view name;
  std::string_view key;       ///< of the parameter whose limits it has; empty: the time
  std::string_view headings;  ///< what a header's word may begin with
};
constexpr std::array<Column, kColumns> kTable{{
    {"time", "", "t sec"},
    {"latitude", "antenna.latitude_deg", "lat"},
    {"longitude", "antenna.longitude_deg", "lon lng"},
    {"height", "antenna.height_m", "height alt elev"},
    {"bearing", "antenna.bearing_deg", "bearing heading course yaw"},
}};
constexpr std::string_view kWanted = "time,latitude,longitude,height,bearing";
// Nanoseconds in 63 bits (antenna.sim_time_ns).
constexpr double kLargestTime_s = 4e9;

/// Takes the text up to the next comma off the line.
std::string_view take_column(std::string_view& line) {
  const std::size_t comma = line.find(',');
  const std::string_view column = trimmed(line.substr(0, comma));
  line = comma == std::string_view::npos ? std::string_view() : line.substr(comma + 1);
  return column;
}

/// A number that may begin with a plus, as tables have it.
std::optional<double> parse_number(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  return number_in(text);
}

/// As a file had it, made fit for a terminal.
std::string shown(std::string_view text) {
  return "\"" + printable_text(text, kLongestFound) + (text.size() > kLongestFound ? "..." : "") + "\"";
}

bool within_limits(const Column& column, double value) {
  const Parameter* parameter = find_parameter(column.key);
  if (parameter != nullptr) return parameter->key.limits.contains(value);
  return value >= -kLargestTime_s && value <= kLargestTime_s;
}

std::string allowed(const Column& column) {
  RadarConfig any;
  const Parameter* parameter = find_parameter(column.key);
  if (parameter != nullptr) return allowed_text(parameter->key, parameter->slot(any));
  return "number -4e9 to 4e9 s";
}

/// In small letters; all that is no letter becomes a blank.
std::string letters_of(std::string_view word) {
  std::string lower(word);
  for (char& c : lower) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    if (c < 'a' || c > 'z') c = ' ';
  }
  return lower;
}

/// The unit that a heading names, in metres.
std::optional<double> unit_named(std::string_view word) {
  std::istringstream parts{letters_of(word)};
  for (std::string part; parts >> part;) {
    if (part == "m" || part == "metres" || part == "meters") return 1;
    if (part == "ft" || part == "feet") return kFoot_m;
  }
  return std::nullopt;
}

bool is_heading(std::string_view word, const Column& column) {
  const std::string lower = letters_of(word);
  std::istringstream headings{std::string(column.headings)};
  for (std::string heading; headings >> heading;)
    if (lower.starts_with(heading)) return true;
  return false;
}

}  // namespace

TrackReader::TrackReader(const std::string& path, double height_unit_m)
    : name_(path == "-" ? "standard input" : path),
      usual_height_unit_m_(height_unit_m),
      height_unit_m_(height_unit_m) {
  fd_.reset(path == "-" ? ::dup(STDIN_FILENO) : ::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (!fd_) throw InputError(name_ + ": cannot be read: " + std::system_category().message(errno));
  struct stat status {};
  if (::fstat(fd_.get(), &status) == 0 && S_ISDIR(status.st_mode))
    throw InputError(name_ + ": found a folder; allowed: a file with lines of " + std::string(kWanted));
  is_file_ = S_ISREG(status.st_mode);
}

void TrackReader::rewind() {
  ::lseek(fd_.get(), 0, SEEK_SET);
  read_.clear();
  searched_ = 0;
  line_ = 0;
  behind_.clear();
  height_unit_m_ = usual_height_unit_m_;
  ended_ = begun_ = flying_ = is_track_ = false;
}

std::string TrackReader::where() const { return fmt::format("{}:{}", name_, line_); }

TrackReader::Got TrackReader::next_line(std::string& line, std::chrono::milliseconds patience) {
  for (;;) {
    const std::size_t end = read_.find('\n', searched_);
    if (end != std::string::npos || (ended_ && !read_.empty())) {
      ++line_;
      line = read_.substr(0, end);
      read_.erase(0, end == std::string::npos ? read_.size() : end + 1);
      searched_ = 0;
      return Got::point;
    }
    if (ended_) return Got::end;
    searched_ = read_.size();
    if (read_.size() > kLongestLine)
      throw InputError(fmt::format("{}:{}: found a line of more than {} characters; allowed: {}", name_,
                                   line_ + 1, kLongestLine, kWanted));
    pollfd entry{fd_.get(), POLLIN, 0};
    const int ready = is_file_ ? 1 : ::poll(&entry, 1, static_cast<int>(patience.count()));
    if (ready <= 0) return Got::nothing_yet;
    std::array<char, kLongestLine> bytes{};
    const ssize_t n = ::read(fd_.get(), bytes.data(), bytes.size());
    if (n < 0 && (errno == EINTR || errno == EAGAIN)) return Got::nothing_yet;
    if (n < 0) throw InputError(name_ + ": cannot be read: " + std::system_category().message(errno));
    ended_ = n == 0;
    read_.append(bytes.data(), static_cast<std::size_t>(n));
  }
}

TrackReader::Got TrackReader::next(TrackPoint& point, std::chrono::milliseconds patience) {
  std::string line;
  for (;;) {
    const Got got = next_line(line, patience);
    if (got == Got::end && !flying_)
      throw InputError(name_ + ": found no pose; allowed: lines of " + std::string(kWanted));
    if (got != Got::point) return got;
    if (line_ == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);  // as some spreadsheets begin
    const std::string_view text = trimmed(line);
    if (text.empty() || text.front() == '#') continue;
    if (parse(text, point)) return Got::point;
  }
}

void TrackReader::read_header(std::string_view line) {
  for (std::size_t i = 0; i < kColumns; ++i) {
    const std::string_view word = take_column(line);
    if (!is_heading(word, kTable[i]))
      throw InputError(fmt::format("{}: column {}: found {}; allowed: a number, or a header of {}", where(),
                                   i + 1, i == 0 ? "neither" : shown(word), kWanted));
    if (kTable[i].name == "height") height_unit_m_ = unit_named(word).value_or(usual_height_unit_m_);
  }
  behind_.clear();
  while (!line.empty()) {
    const auto found = std::ranges::find(kMotionColumns, take_column(line), &MotionColumn::name);
    behind_.push_back(found == kMotionColumns.end() ? nullptr : &*found);
  }
}

void TrackReader::read_motion(std::string_view rest, TrackPoint& point) const {
  for (const MotionColumn& column : kMotionColumns) point.*column.value = std::nullopt;
  for (const MotionColumn* column : behind_) {
    const std::string_view text = take_column(rest);
    if (column == nullptr || text.empty()) continue;
    const Column limits{column->name, column->parameter, {}};
    auto number = parse_number(text);
    if (number) *number *= column->unit;
    if (!number || !within_limits(limits, *number))
      throw InputError(
          fmt::format("{}: {}: found {}; allowed: {}", where(), column->name, shown(text), allowed(limits)));
    point.*column->value = number;
  }
}

/// False: it was the header.
bool TrackReader::parse(std::string_view line, TrackPoint& point) {
  std::string_view rest = line;
  const std::string_view first = take_column(rest);
  if (!std::exchange(begun_, true) && !parse_number(first)) {
    read_header(line);
    is_track_ = true;
    return false;
  }
  rest = line;
  const std::array<double*, kColumns> values{&point.time_s, &point.latitude_deg, &point.longitude_deg,
                                             &point.height_m, &point.bearing_deg};
  for (std::size_t i = 0; i < kColumns; ++i) {
    if (rest.empty())
      throw InputError(fmt::format("{}: found {}{}; allowed: {} and whatever follows, with commas between",
                                   where(), i, i == 1 ? " column" : " columns", kWanted));
    const std::string_view text = take_column(rest);
    auto number = parse_number(text);
    if (number && values[i] == &point.height_m) *number *= height_unit_m_;
    if (!number || !within_limits(kTable[i], *number))
      throw InputError(fmt::format("{}: {}: found {}; allowed: {}", where(), kTable[i].name,
                                   number || is_track_ ? shown(text) : "no number", allowed(kTable[i])));
    *values[i] = *number;
  }
  read_motion(rest, point);
  if (flying_ && point.time_s < last_time_s_)
    throw InputError(fmt::format("{}: time: found {} after {}; allowed: a time that does not go back",
                                 where(), toml_number(point.time_s), toml_number(last_time_s_)));
  flying_ = is_track_ = true;
  last_time_s_ = point.time_s;
  return true;
}

}  // namespace obliq
