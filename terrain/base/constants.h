#pragma once
#include <numbers>

namespace obliq {

constexpr double kDegree_rad = std::numbers::pi / 180;

/// Mean earth radius R1 of WGS84 (IUGG). For estimates and spacings; positions use the ellipsoid.
constexpr double kMeanEarthRadius_m = 6371008.8;

}  // namespace obliq
