#include "terrain/base/text.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace obliq {

std::string short_number(double value) {
  if (value == 0) return "0";
  const int digits = std::clamp(2 - static_cast<int>(std::floor(std::log10(std::abs(value)))), 0, 9);
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  std::string out = text;
  if (out.find('.') != std::string::npos) {
    out.erase(out.find_last_not_of('0') + 1);
    if (out.back() == '.') out.pop_back();
  }
  return out;
}

std::string percent_text(double fraction) { return short_number(100 * fraction) + " %"; }

std::string metres_text(double value_m) {
  char text[64];
  std::snprintf(text, sizeof text, "%.2f m", value_m);
  return text;
}

}  // namespace obliq
