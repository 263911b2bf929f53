#pragma once
// One house on even ground and an antenna that sees it at a grazing angle, for tests of corners.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "server/radar/frame_plan.h"
#include "server/radar/render.h"
#include "tests/support/made_worlds.h"
#include "tests/support/sane_frames.h"
#include "tests/support/scenes.h"

namespace obliq::test {

constexpr double kLength_m = 20, kHeight_m = 8;

inline double db(double ratio) { return 10 * std::log10(ratio); }

/// Ground and walls that return nothing but corners.
inline std::vector<Material> corner_materials(double rms_slope = 0.1) {
  std::vector<Material> both = two_materials();
  both[0].gamma = both[1].gamma = 0;
  both[1].reflectivity = 0;
  both[0].rms_slope = rms_slope;
  both[0].permittivity_re = 6;
  both[0].permittivity_im = 0.6;
  both[1].permittivity_re = 5.3;
  both[1].permittivity_im = 0.3;
  return both;
}

/// A house whose wall faces the antenna, turned clockwise about its middle, and the antenna at a grazing
/// angle.
struct House {
  double heading_deg = 0;
  double distance_m = 20000;
  double grazing_deg = 20;
  double per_x = 0, per_z = 0;  ///< the ground's slopes

  glm::dvec3 antenna_m() const {
    return {0, std::tan(grazing_deg * kPi / 180) * distance_m + per_z * distance_m, 0};
  }
  Ring corners() const {
    const double turn = heading_deg * kPi / 180;
    const glm::dvec2 u(std::cos(turn), -std::sin(turn)), back(std::sin(turn), std::cos(turn));
    const glm::dvec2 foot(0.3, distance_m);
    const glm::dvec2 left = foot - u * (kLength_m / 2), right = foot + u * (kLength_m / 2);
    return {left, right, right + back * kLength_m, left + back * kLength_m};
  }
  World world() const {
    World made = made_world(std::ceil((distance_m + 600) / 500) * 500, 500,
                            [&](double x, double z) { return per_x * x + per_z * z; });
    add_prism(made, corners(), kHeight_m);
    made.buildings.corners = true;
    return made;
  }
};

/// One way of sampling, and how near it comes to the oracle.
struct CornerWay {
  const char* name;
  FrustumKind frustum;
  int sub_columns;
  double tolerance;
};

inline RadarSettings corner_settings(const House& house, const CornerWay& way, double half_swath_m = 150) {
  const double range_m = house.distance_m / std::cos(house.grazing_deg * kPi / 180);
  RadarSettings s = radar_settings(way.frustum, {range_m - half_swath_m, range_m + half_swath_m, 1},
                                   {8, static_cast<int>(half_swath_m / 5)}, {1024, 512});
  s.sub_columns = way.sub_columns;
  s.speckle = SpeckleKind::ground;
  return s;
}

inline std::vector<double> corner_powers(const World& world, const House& house, const RadarSettings& s,
                                         const std::vector<Material>& of) {
  const auto scene = make_scene(world, of);
  return render(scene, snapshot(s), pose_at(scene->world(), house.antenna_m(), 0), {0, s.azimuth_bins})
      .bins.power_w;
}

inline double total(const std::vector<double>& w) { return std::accumulate(w.begin(), w.end(), 0.0); }

}  // namespace obliq::test
