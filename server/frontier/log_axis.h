#pragma once
#include <string>
#include <vector>

namespace obliq {

/// A logarithmic axis that spans positive values with some air, and its ticks.
class LogAxis {
 public:
  struct Tick {
    double value;
    std::string label;  ///< empty: a line without words
  };

  /// Spans the values, at least `least_decades`; all must be positive, and there may be none.
  LogAxis(const std::vector<double>& values, double least_decades);

  double low() const { return low_; }
  double high() const { return high_; }
  /// 0 at low, 1 at high.
  double place(double value) const;
  /// Whole decades are labelled; 2 and 5 as well where the axis spans less than two decades.
  std::vector<Tick> ticks(double factor, const char* unit) const;

 private:
  double low_;
  double high_;
};

}  // namespace obliq
