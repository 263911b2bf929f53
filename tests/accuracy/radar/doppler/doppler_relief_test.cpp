// The Doppler that each sharp bin has over a ramp and of walls, against the geometry of where they stand. A
// canceller of one delay without a beam tells it: it leaves (2 sin(pi f / PRF))^2 / 2 of a bin's power.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "tests/support/target_scenes.h"

namespace obliq::test::doppler_relief_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kPrf_hz = 60e3;  // above all Doppler here, so that the sine can be undone
constexpr double kTrain_s = 0.064;

RadarSettings radar() {
  RadarSettings s = radar_settings(FrustumKind::sweep, {3000, 7000, 60}, {120, 200}, {120, 1});
  s.frequency_ghz = 9.4;
  s.pulse.prf_hz = kPrf_hz;
  s.doppler.canceller = 1;
  return s;
}

class DopplerOf {
 public:
  explicit DopplerOf(World world) : scene_(std::move(world)) {
    PoseSettings& at = scene_.pose().settings;
    at.velocity_north_m_s = kNorth_m_s;
    at.velocity_east_m_s = kEast_m_s;
    at.velocity_up_m_s = kUp_m_s;
    RadarSettings s = radar();
    map_ = scene_.bare(s);
    s.mode = RadarMode::mti;
    cancelled_ = scene_.bare(s);
  }
  double power_w(const Bin& bin) const { return map_.bins.power_w[index(bin)]; }
  double hz(const Bin& bin) const {
    return std::asin(std::sqrt(cancelled_.bins.power_w[index(bin)] / power_w(bin) / 2)) * kPrf_hz / kPi;
  }
  /// Of what is at an azimuth, a distance on the level and a height below the antenna.
  static double wanted_hz(double azimuth_rad, double distance_m, double below_m) {
    const double r = std::hypot(distance_m, below_m);
    const double level_m_s = kNorth_m_s * std::cos(azimuth_rad) + kEast_m_s * std::sin(azimuth_rad);
    return 2 / (299792458.0 / 9.4e9) * (level_m_s * distance_m / r - kUp_m_s * below_m / r);
  }

 private:
  static constexpr double kNorth_m_s = 120, kEast_m_s = 60, kUp_m_s = -8;
  std::size_t index(const Bin& bin) const {
    return static_cast<std::size_t>(bin.azimuth) * static_cast<std::size_t>(map_.bins.n_range) +
           static_cast<std::size_t>(bin.range);
  }
  TargetScene scene_;
  Frame map_, cancelled_;
};

TEST(DopplerOverRelief, OfARampIsThatOfItsOwnElevation) {
  constexpr double kRise = 0.1;  // to the north
  const DopplerOf ramp(made_world(9000, 50, [](double, double z) { return kRise * z; }));
  double worst_hz = 0, from_level_hz = 0;
  for (const double azimuth_rad : {-0.4, -0.1, 0.0, 0.25, 0.45})
    for (const double range_m : {3200.0, 4500.0, 5600.0, 6800.0}) {
      const Bin bin = bin_near(radar(), azimuth_rad, range_m);
      // Where the line of the bin's azimuth meets the ramp at its range.
      const double rise = kRise * std::cos(bin.azimuth_rad);
      const double a = 1 + rise * rise, b = -2 * kAntenna_m * rise;
      const double c = kAntenna_m * kAntenna_m - bin.range_m * bin.range_m;
      const double distance_m = (-b + std::sqrt(b * b - 4 * a * c)) / (2 * a);
      const double below_m = kAntenna_m - rise * distance_m;
      const double wanted = DopplerOf::wanted_hz(bin.azimuth_rad, distance_m, below_m);
      EXPECT_NEAR(ramp.hz(bin), wanted, 0.5 / kTrain_s) << azimuth_rad << " " << range_m;
      worst_hz = std::max(worst_hz, std::abs(ramp.hz(bin) - wanted));
      const double level_m = std::sqrt(bin.range_m * bin.range_m - kAntenna_m * kAntenna_m);
      from_level_hz = std::max(from_level_hz,
                               std::abs(wanted - DopplerOf::wanted_hz(bin.azimuth_rad, level_m, kAntenna_m)));
    }
  EXPECT_GT(from_level_hz, 100) << "level ground would have another";
  std::printf("    off by %.2f Hz at most; level ground is %.0f Hz beside it\n", worst_hz, from_level_hz);
}

// A low wall, and one 300 m high, at one range in two azimuths over level ground.
TEST(DopplerOverRelief, OfWallsAtOneRangeIsTheirOwn) {
  World world = made_world(9000, 100, [](double, double) { return 0.0; });
  const double heights_m[] = {40, 300};
  const double azimuths_rad[] = {-0.1, 0.1};
  for (int k = 0; k < 2; ++k)
    add_prism(world, rectangle(5000 * std::sin(azimuths_rad[k]), 5000 * std::cos(azimuths_rad[k]), 200, 60),
              heights_m[k]);
  const DopplerOf walls(std::move(world));
  for (int k = 0; k < 2; ++k) {
    const double front_m = 5000 * std::cos(azimuths_rad[k]) - 30;
    const auto range_at = [&](double height_m) {
      return std::hypot(front_m / std::cos(azimuths_rad[k]), kAntenna_m - height_m);
    };
    const Bin wall = bin_near(radar(), azimuths_rad[k], range_at(heights_m[k] / 2));
    Bin beside = wall;
    beside.azimuth += 15;
    ASSERT_GT(walls.power_w(wall), 3 * walls.power_w(beside));
    // Height of the wall in the middle of the bin.
    const double distance_m = front_m / std::cos(wall.azimuth_rad);
    const double below_m = std::sqrt(wall.range_m * wall.range_m - distance_m * distance_m);
    const double wall_hz = DopplerOf::wanted_hz(wall.azimuth_rad, distance_m, below_m);
    const double level_m = std::sqrt(wall.range_m * wall.range_m - kAntenna_m * kAntenna_m);
    const double ground_hz = DopplerOf::wanted_hz(wall.azimuth_rad, level_m, kAntenna_m);
    // Wall and roof in one bin are one line at their mean (client/guide/model.md).
    EXPECT_NEAR(walls.hz(wall), wall_hz, std::max(0.5 / kTrain_s, 0.5 * std::abs(wall_hz - ground_hz)));
    std::printf("    wall of %.0f m: %.1f Hz, by hand %.1f; ground %.1f\n", heights_m[k], walls.hz(wall),
                wall_hz, ground_hz);
  }
}

}  // namespace
}  // namespace obliq::test::doppler_relief_test
