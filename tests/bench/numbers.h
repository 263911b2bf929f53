#pragma once
// What the benchmarks say about their figures.
#include <algorithm>
#include <cmath>
#include <vector>

namespace obliq::bench {

/// share 0.5: the median; 0.99: what all but one in a hundred do not exceed. Of no values: 0.
inline double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const double at = std::ceil(share * static_cast<double>(values.size())) - 1;
  return values[static_cast<std::size_t>(std::clamp(at, 0.0, static_cast<double>(values.size() - 1)))];
}

}  // namespace obliq::bench
