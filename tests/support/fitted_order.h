#pragma once
// How fast an error falls.
#include <cmath>
#include <vector>

namespace obliq::test {

/// A size (step, 1 / number of samples) and the error at it.
struct ErrorAtSize {
  double size;
  double error;
};

/// Least-squares slope of log error over log size: 2 for an error that falls by 4 when the size is halved.
inline double fitted_order(const std::vector<ErrorAtSize>& points) {
  double x = 0, y = 0, xx = 0, xy = 0;
  for (const ErrorAtSize& p : points) {
    const double a = std::log(p.size), b = std::log(p.error);
    x += a;
    y += b;
    xx += a * a;
    xy += a * b;
  }
  const auto n = static_cast<double>(points.size());
  return (n * xy - x * y) / (n * xx - x * x);
}

}  // namespace obliq::test
