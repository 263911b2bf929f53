#pragma once
#include <chrono>

namespace obliq {

inline double to_seconds(std::chrono::nanoseconds time) {
  return std::chrono::duration<double>(time).count();
}

inline double seconds_since(std::chrono::steady_clock::time_point start) {
  return to_seconds(std::chrono::steady_clock::now() - start);
}

/// To the nanosecond below.
inline std::chrono::nanoseconds from_seconds(double time_s) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::duration<double>(time_s));
}

}  // namespace obliq
