#include "server/accuracy/thresholds.h"

#include <algorithm>
#include <cmath>

#include "terrain/base/units.h"

namespace obliq {
namespace {

constexpr double kFurthest_m = 1e7;

}  // namespace

double earth_drop_m(double ground_range_m, double curvature) {
  return ground_range_m * ground_range_m * curvature / (2 * kMeanEarthRadius_m);
}

double ground_slant_range_m(double ground_range_m, double height_m, double curvature) {
  return std::hypot(ground_range_m, height_m + earth_drop_m(ground_range_m, curvature));
}

double curved_ground_power_ratio(double slant_range_m, double height_m, double curvature) {
  const double share = slant_range_m / horizon_m(height_m, curvature);
  return std::max(0.0, 1 - share * share);
}

double horizon_m(double height_m, double curvature) {
  return std::sqrt(2 * kMeanEarthRadius_m * height_m / curvature);
}

double range_of_power_change_m(double height_m, double curvature, double other_curvature, double change_db) {
  const double less = std::min(curvature, other_curvature);
  const double more = std::max(curvature, other_curvature);
  if (less == more) return kInfinity;
  // (1 - u more) / (1 - u less) = ratio for u = r^2 / (2 R h).
  const double ratio = std::pow(10.0, -change_db / 10);
  const double u = (1 - ratio) / (more - ratio * less);
  return std::sqrt(2 * kMeanEarthRadius_m * height_m * u);
}

double range_of_slant_shift_m(double height_m, double curvature, double other_curvature, double shift_m) {
  const auto shift_at = [&](double ground_range_m) {
    return std::abs(ground_slant_range_m(ground_range_m, height_m, other_curvature) -
                    ground_slant_range_m(ground_range_m, height_m, curvature));
  };
  if (!(shift_at(kFurthest_m) > shift_m)) return kInfinity;
  double near = 0, far = kFurthest_m;  // the shift grows with the distance
  for (int round = 0; round < 100; ++round) {
    const double middle = (near + far) / 2;
    (shift_at(middle) < shift_m ? near : far) = middle;
  }
  return near;
}

double wall_share(double height_m, double depth_m, double depression_rad) {
  const double wall = height_m * std::cos(depression_rad);
  return wall / (wall + depth_m * std::sin(depression_rad));
}

double depression_of_wall_share_rad(double height_m, double depth_m, double share) {
  return std::atan2(height_m * (1 / share - 1), depth_m);
}

double vertical_tolerance_m(double shift_m, double depression_rad) {
  return shift_m / std::sin(depression_rad);
}

double cell_of_error_m(double cell_m, double error_m, double order, double allowed_error_m) {
  return cell_m * std::pow(allowed_error_m / error_m, 1 / order);
}

}  // namespace obliq
