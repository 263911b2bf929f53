#include "terrain/buildings/height_text.h"

#include <cctype>
#include <charconv>
#include <cmath>
#include <string>

#include "terrain/base/units.h"

namespace obliq {
namespace {

constexpr double kInch_m = 0.0254;

void skip_spaces(std::string_view& text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
}

std::optional<double> take_number(std::string_view& text) {
  skip_spaces(text);
  std::size_t n = 0;
  std::string digits;
  while (n < text.size() && (std::isdigit(static_cast<unsigned char>(text[n])) || text[n] == '.' ||
                             text[n] == ',' || ((text[n] == '-' || text[n] == '+') && n == 0))) {
    // A decimal comma; a number with two of either sign fails to parse as a whole below.
    if (!(n == 0 && text[n] == '+')) digits.push_back(text[n] == ',' ? '.' : text[n]);
    ++n;
  }
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || end != digits.data() + digits.size()) return {};
  // Exponents, which drivers write when they turn large numbers into text.
  std::string_view rest = text.substr(n);
  if (rest.size() > 1 && (rest[0] == 'e' || rest[0] == 'E') &&
      (std::isdigit(static_cast<unsigned char>(rest[1])) || rest[1] == '-' || rest[1] == '+')) {
    int exponent = 0;
    const std::size_t sign = rest[1] == '+' ? 2 : 1;
    const auto [e_end, e_error] = std::from_chars(rest.data() + sign, rest.data() + rest.size(), exponent);
    if (e_error != std::errc()) return {};
    value *= std::pow(10.0, exponent);
    rest.remove_prefix(static_cast<std::size_t>(e_end - rest.data()));
  }
  text = rest;
  return value;
}

/// Letters or one quotation mark, in lower case.
std::string take_unit(std::string_view& text) {
  skip_spaces(text);
  std::string unit;
  if (!text.empty() && (text.front() == '\'' || text.front() == '"')) {
    unit.push_back(text.front());
    text.remove_prefix(1);
    if (unit == "'" && !text.empty() && text.front() == '\'') {  // two single marks for inches
      unit = "\"";
      text.remove_prefix(1);
    }
    return unit;
  }
  while (!text.empty() && std::isalpha(static_cast<unsigned char>(text.front()))) {
    unit.push_back(static_cast<char>(std::tolower(static_cast<unsigned char>(text.front()))));
    text.remove_prefix(1);
  }
  if (!text.empty() && text.front() == '.') text.remove_prefix(1);  // "ft."
  return unit;
}

double metres_of(const std::string& unit) {
  if (unit == "m" || unit == "metre" || unit == "metres" || unit == "meter" || unit == "meters") return 1;
  if (unit == "ft" || unit == "feet" || unit == "foot" || unit == "'") return kFoot_m;
  if (unit == "in" || unit == "inch" || unit == "inches" || unit == "\"") return kInch_m;
  if (unit == "cm") return 0.01;
  for (const char* storey : {"storey", "storeys", "story", "stories", "floor", "floors", "level", "levels"}) {
    if (unit == storey) return kStorey_m;
  }
  return 0;
}

}  // namespace

std::optional<double> parse_height_m(std::string_view text, double metres_per_bare_unit) {
  const std::optional<double> number = take_number(text);
  if (!number) return {};
  const std::string unit = take_unit(text);
  if (unit.empty()) {
    skip_spaces(text);
    if (!text.empty()) return {};
    return *number * metres_per_bare_unit;
  }
  const double metres = metres_of(unit);
  if (metres == 0) return {};
  double height_m = *number * metres;
  skip_spaces(text);
  if (!text.empty()) {
    const std::optional<double> inches = take_number(text);
    const std::string second = take_unit(text);
    skip_spaces(text);
    if (metres != kFoot_m || !inches || !text.empty() || !(second.empty() || metres_of(second) == kInch_m))
      return {};
    height_m += *inches * kInch_m;
  }
  return height_m;
}

}  // namespace obliq
