#pragma once
// Decibels by the project's own exponential and logarithm: the same bits whatever the processor.
#include "server/radar/simd/exact_math.h"

namespace obliq {

constexpr double kNepersOfDecibel = 0.2302585092994045684;  ///< ln(10) / 10

/// 10^(db / 10), for |db| below 3000.
inline double ratio_of_db(double db) {
  const double x = kNepersOfDecibel * db;
  return x <= 0 ? exp_of_negative(x) : 1 / exp_of_negative(-x);
}

/// 10 log10(ratio), of a positive normal number.
inline double db_of_ratio(double ratio) { return log_of_positive(ratio) / kNepersOfDecibel; }

}  // namespace obliq
