#include "server/frontier/log_axis.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "server/frontier/frontier_table.h"
#include "terrain/base/text.h"

namespace obliq {
namespace {
constexpr double kAir = 1.18;  // factor between the outermost values and the axis' ends

/// "0.01", "2e-5": an axis has room for few signs.
std::string label_of(double value) {
  if (value > 9.5e-4) return short_number(value);
  const int exponent = static_cast<int>(std::floor(std::log10(value) + 1e-9));
  return fmt::format("{:.0f}e{}", value / std::pow(10, exponent), exponent);
}

}  // namespace

LogAxis::LogAxis(const std::vector<double>& values, double least_decades) : low_(1), high_(1) {
  if (!values.empty()) {
    low_ = *std::ranges::min_element(values);
    high_ = *std::ranges::max_element(values);
  }
  low_ /= kAir;
  high_ *= kAir;
  const double missing = least_decades - std::log10(high_ / low_);
  if (missing > 0) {
    low_ *= std::pow(10, -missing / 2);
    high_ *= std::pow(10, missing / 2);
  }
}

double LogAxis::place(double value) const { return std::log(value / low_) / std::log(high_ / low_); }

std::vector<LogAxis::Tick> LogAxis::ticks(double factor, const char* unit) const {
  const bool few = std::log10(high_ / low_) < 2;
  std::vector<Tick> ticks;
  for (int decade = static_cast<int>(std::floor(std::log10(low_))); std::pow(10, decade) <= high_; ++decade)
    for (int k = 1; k <= 9; ++k) {
      const double value = k * std::pow(10, decade);
      if (value < low_ || value > high_) continue;
      const bool labelled = k == 1 || (few && (k == 2 || k == 5));
      ticks.push_back({value, labelled ? label_of(value * factor) + unit : ""});
    }
  return ticks;
}

}  // namespace obliq
