// Circles of buildings, as many at a time as the compiler finds room for: plain loops without branches.
#include "server/radar/simd/buildings/circles.h"

#include <cmath>
#include <numbers>

namespace obliq::OBLIQ_ISA {
namespace {

constexpr auto kPi = std::numbers::pi_v<float>;

/// From the antenna to a circle's centre.
struct Offset {
  float right, ahead;
};

inline Offset offset(const CircleAxes& axes, float x_m, float z_m) {
  const float dx = x_m - axes.x_m;
  const float dz = z_m - axes.z_m;
  return {dx * axes.cos_bearing - dz * axes.sin_bearing, dx * axes.sin_bearing + dz * axes.cos_bearing};
}

/// atan2(right, ahead) by the polynomial for the arc tangent of M. Abramowitz, I. Stegun, "Handbook of
/// Mathematical Functions", 4.4.49, off by 2e-8 at most.
inline float bearing_of(const Offset& to) {
  const float to_right = std::abs(to.right);
  const float along = std::abs(to.ahead);
  const bool steep = to_right > along;
  const float large = steep ? to_right : along;
  const float small = steep ? along : to_right;
  const float t = small / (large > 0 ? large : 1.0f);
  const float z = t * t;
  const float series = -0.0161657367f + z * 0.0028662257f;
  const float arc =
      t *
      (1 + z * (-0.3333314528f +
                z * (0.1999355085f +
                     z * (-0.1420889944f +
                          z * (0.1065626393f + z * (-0.0752896400f + z * (0.0429096138f + z * series)))))));
  const float quarter = (steep ? kPi / 2 : 0.0f) + (steep ? -arc : arc);
  const float half = (to.ahead < 0 ? kPi : 0.0f) + (to.ahead < 0 ? -quarter : quarter);
  return std::copysign(half, to.right);
}

inline float clamped(float value, float most) {
  const float positive = value > 0 ? value : 0.0f;
  return positive < most ? positive : most;
}

}  // namespace

// Arguments are copied, and results told apart from them, so that the compiler sees that no store changes
// them.

void circle_bins(const CircleSector& given, const CircleRun& circles, std::int32_t* __restrict first,
                 std::int32_t* __restrict last) {
  const CircleSector sector = given;
  const CircleRun run = circles;
  const auto n = static_cast<float>(sector.n_bins);
  const bool narrow = sector.bins_a_rad == 0;
  for (int k = 0; k < run.n; ++k) {
    const Offset to = offset(sector.axes, run.x_m[k], run.z_m[k]);
    const float radius = run.radius_m[k] + sector.axes.error_m;
    const float radius2 = radius * radius;
    const float distance2 = to.right * to.right + to.ahead * to.ahead;
    const float bearing = bearing_of(to);
    // The tangent of half the angle that the circle fills, which is larger than the angle.
    const float beyond2 = distance2 - radius2;
    const float half =
        radius / std::sqrt(beyond2 > 0 ? beyond2 : 1.0f) * 1.00001f + static_cast<float>(kBearingMargin_rad);
    const float low = bearing - half;
    const float high = bearing + half;
    const float from = clamped((low - sector.start_rad) * sector.bins_a_rad, n);
    const float end = clamped((high - sector.start_rad) * sector.bins_a_rad + 1, n);
    const auto first_bin = static_cast<std::int32_t>(from);
    const std::int32_t last_bin = static_cast<std::int32_t>(end) - 1;
    const float far = sector.reach_m + radius;
    const bool in_reach = distance2 <= far * far * 1.00001f;
    const bool within = in_reach & (high >= sector.start_rad) & (low <= sector.end_rad);
    // Where bearings turn over, and where a circle fills more than a quarter turn.
    const bool turns_over = (high >= sector.start_rad + 2 * kPi) | (low <= sector.end_rad - 2 * kPi);
    const bool closer = (beyond2 < 0.5f * radius2) | (in_reach & turns_over) | (within & narrow);
    const std::int32_t last_or_none = (within & (first_bin <= last_bin)) ? last_bin : kNoBin;
    first[k] = first_bin;
    last[k] = closer ? kLookCloser : last_or_none;
  }
}

void idle_circles(const CircleExtent& given, const CircleRun& circles, std::uint8_t* __restrict idle) {
  const CircleExtent extent = given;
  const CircleRun run = circles;
  const float far_m = extent.r_max_m + extent.margin_m;
  const float either = extent.wide ? -1.0f : 1.0f;
  const float narrow = extent.wide ? 0.0f : 1.0f;
  const float wide_m = extent.wide ? 1e30f : 0.0f;
  // Squares of ranges are off by less than 1e-5 of themselves.
  const float nearest2 = extent.r_min_m * extent.r_min_m * 1.00001f;
  const float farthest2 = extent.r_max_m * extent.r_max_m * 0.99999f;
  for (int k = 0; k < run.n; ++k) {
    const Offset to = offset(extent.axes, run.x_m[k], run.z_m[k]);
    const float up = run.roof_y_m[k] - extent.axes.y_m;
    const float radius = run.radius_m[k] + extent.axes.error_m;
    const float ground = std::sqrt(to.right * to.right + to.ahead * to.ahead);
    const float near = ground - radius;
    const float far = ground + radius;
    // Distances beyond the right and the left edge of the sector.
    const float past_right = to.right * extent.cos_half - to.ahead * extent.sin_half;
    const float past_left = -to.right * extent.cos_half - to.ahead * extent.sin_half;
    // Beyond either edge of a narrow sector, beyond both of a wide one.
    const float a = either * past_right;
    const float b = either * past_left;
    const float past = either * (a > b ? a : b);
    const float behind = narrow * -to.ahead - wide_m;
    const float up2 = up * up;
    const bool outside =
        (near > far_m) | (past > radius + extent.margin_m) | (behind > radius + extent.margin_m);
    const bool inside = (past < -radius) & (behind < -radius) & (near > 0) & (near * near + up2 > nearest2) &
                        (far * far + up2 < farthest2);
    const float slope_at = up > 0 ? near : far;
    const bool lower = (up + 2 * extent.axes.error_m < extent.tangent * slope_at) &
                       (run.roof_y_m[k] + extent.axes.error_m < extent.top_m);
    idle[k] = outside | (inside & lower) ? 1 : 0;
  }
}

}  // namespace obliq::OBLIQ_ISA
