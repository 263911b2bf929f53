#pragma once
// Units and constants of nature.
#include <chrono>
#include <limits>
#include <numbers>

namespace obliq {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kPi = std::numbers::pi;
constexpr double kTurn_rad = 2 * kPi;
constexpr double kDegree_rad = kPi / 180;

constexpr double kFoot_m = 0.3048;  // the international foot, exact: NIST SP 811, appendix B

/// Mean earth radius R1 of WGS84 (IUGG). For estimates and spacings; positions use the ellipsoid.
constexpr double kMeanEarthRadius_m = 6371008.8;

constexpr double kSpeedOfLight_m_s = 299792458.0;  // exact: SI Brochure, 9th edition, 2.2

constexpr double wavelength_at(double frequency_ghz) { return kSpeedOfLight_m_s / (frequency_ghz * 1e9); }

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
