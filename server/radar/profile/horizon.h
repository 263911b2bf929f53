#pragma once
#include <vector>

#include "server/radar/profile/line_of_sight.h"
#include "server/scene/scene.h"

namespace obliq {

/// Bounds of what the ground around one bearing stands at: no slope (height above the antenna over ground
/// distance) up to a distance is greater. For all profiles within half a width of the bearing.
class HorizonBound {
 public:
  HorizonBound(const Scene& scene, const glm::dvec3& antenna_m, SinCos bearing, double half_width_rad,
               double to_m);

  /// All ground up to a distance lies below a horizon.
  bool hidden_by(const Horizon<double>& horizon, double to_m) const {
    const auto step = static_cast<std::size_t>(to_m * steps_per_m_);
    return step < slope_.size() && slope_[step] * horizon.d_m < horizon.h_m;
  }

 private:
  double steps_per_m_;
  std::vector<double> slope_;  // up to the end of each step
};

/// The highest elevation that the ground has along one vertical profile up to to_m: exactly what a march from
/// the nadir would have found, for the price of a look at the tiles that the ridge does not leave out.
Horizon<double> ground_horizon(const Scene& scene, const HorizonBound& ridge, const glm::dvec3& antenna_m,
                               SinCos bearing, double to_m);

}  // namespace obliq
