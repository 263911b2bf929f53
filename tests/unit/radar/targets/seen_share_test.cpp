// What hides targets, against closed forms and brute force; and hard cases, which must be finite.
#include "server/radar/targets/seen_share.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "tests/support/target_scenes.h"

namespace obliq::test::seen_share_test {
namespace {

// A wall of height H at distance d from an antenna h up hides the ground behind it out to h d / (h - H).
TEST(TargetSights, BehindAWallFollowTheStraightLine) {
  constexpr double kWall_m = 40, kNear_m = 3000, kThick_m = 10;
  World world = level_world();
  add_prism(world, rectangle(0, kNear_m + kThick_m / 2, 400, kThick_m), kWall_m);
  const TargetScene scene(std::move(world), 200);
  const glm::dvec3 antenna = scene.pose().antenna.m;
  // The far edge of the roof hides most.
  const double far_m = kNear_m + kThick_m;
  const double free_m = antenna.y * far_m / (antenna.y - kWall_m);
  const auto share = [&](double z, double top_m) {
    const auto place = place_target(scene.world(), scene.at(0, z, 0), 0);
    return seen_share(scene.scene(), antenna, place->foot_m, top_m).share;
  };
  EXPECT_EQ(share(free_m + 0.5, 0), 1);
  EXPECT_EQ(share(free_m - 0.5, 0), 0);
  EXPECT_EQ(share(kNear_m - 1, 3), 1);
  for (const double z : {3100.0, 3300.0, 3600.0}) {
    const double line_m = antenna.y - (antenna.y - kWall_m) / far_m * z;
    EXPECT_NEAR(share(z, 2 * line_m), 0.5, 1e-3) << z;
    EXPECT_EQ(share(z, line_m * 0.99), 0) << z;
    EXPECT_NEAR(share(z, line_m * 4), 0.75, 1e-3) << z;
  }
  EXPECT_EQ(share(kNear_m + 5, 10), 0);  // inside the house
}

// Brute force: the profile's height every half metre.
TEST(TargetSights, AmongHillsAreThoseOfAFineMarch) {
  const TargetScene scene(made_world(6000, 50,
                                     [](double x, double z) {
                                       return 120 * std::sin(x / 400) * std::cos(z / 330) +
                                              60 * std::sin(z / 170);
                                     }),
                          80);
  const HeightGrid& grid = scene.world().grid;
  const glm::dvec3 antenna = scene.pose().antenna.m;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> anywhere(-5500, 5500);
  int partly = 0, hidden = 0;
  for (int n = 0; n < 400; ++n) {
    const double x = anywhere(random), z = anywhere(random), top_m = 40;
    const auto place = place_target(scene.world(), scene.at(x, z, 0), 0);
    ASSERT_TRUE(place);
    const glm::dvec3 way = place->foot_m - antenna;
    const double d = std::hypot(way.x, way.z);
    double slope = -HUGE_VAL;
    for (double at = 0.5; at < d - 0.25; at += 0.5)
      slope = std::max(
          slope, (grid.height_at_m(antenna.x + way.x / d * at, antenna.z + way.z / d * at) - antenna.y) / at);
    const double seen = std::clamp((way.y + top_m - slope * d) / top_m, 0.0, 1.0);
    EXPECT_NEAR(seen_share(scene.scene(), antenna, place->foot_m, top_m).share, seen, 0.02) << x << " " << z;
    partly += seen > 0 && seen < 1 ? 1 : 0;
    hidden += seen == 0 ? 1 : 0;
  }
  EXPECT_GT(partly, 20);
  EXPECT_GT(hidden, 20);
}

/// Every number finite, no power below 0.
void expect_finite(const Frame& frame, const char* what) {
  bool good = true;
  for (const double power : frame.bins.power_w) good = good && std::isfinite(power) && power >= 0;
  for (const auto& iq : frame.bins.iq) good = good && std::isfinite(iq.real()) && std::isfinite(iq.imag());
  EXPECT_TRUE(good) << what;
}

TEST(TargetEchoes, OfHardCasesAreFinite) {
  constexpr auto kLongest = std::int64_t{4'000'000'000'000'000'000};
  World world = level_world();
  add_prism(world, rectangle(0, 3000, 100, 100), 30);
  TargetScene scene(std::move(world));
  for (const double sector_deg : {90.0, 360.0})
    for (const bool beam : {false, true}) {
      RadarSettings s = beam ? beam_settings() : sharp_settings_of_test();
      s.sector_deg = sector_deg;
      s.r_min_m = 300;
      if (beam) s.azimuth_bins = sector_deg > 180 ? 1024 : 256;
      std::vector<Target> targets;
      const auto add = [&](Target target) {
        target.id = targets.size() + 1;
        target.size.swerling = static_cast<int>(targets.size() % 5);
        targets.push_back(target);
      };
      add(scene.at(0, 0, kAntenna_m));   // at the antenna's place
      add(scene.at(0, 0, 0));            // straight below
      add(scene.at(0, 0, 9000));         // straight above
      add(scene.at(0, -5000, 0));        // on the seam of the circle
      add(scene.at_range(0, 10999, 0));  // at r_max within a pulse
      add(scene.at(0, 100, 700));        // near r_min
      add(scene.at(0, 3000, 0));         // inside a house
      add(scene.at(0, 12990, 0));        // at the grid's edge
      add(scene.at(50000, 50000, 0));    // over unknown ground
      Target fast = scene.at(0, 4000, 0);
      fast.velocity_m_s = {20e3, 20e3, -20e3};
      add(fast);
      for (const std::int64_t time : {-kLongest, kLongest}) {
        fast.sim_time_ns = time;
        add(fast);
      }
      Target pole = scene.at(0, 4000, 0);
      pole.latitude_deg = 90;
      add(pole);
      pole.latitude_deg = -90;
      add(pole);
      Target beyond = scene.at(0, 4000, 0);
      beyond.longitude_deg += 360;
      add(beyond);
      Target long_one = scene.at(0, 6000, 0);
      long_one.size.length_m = 400;
      long_one.size.width_m = 60;
      add(long_one);
      const Frame frame = scene.render(s, targets);
      expect_finite(frame, "a scene of all");
      expect_finite(scene.render(s, targets, 0, kLongest), "long after");
      expect_finite(scene.render(s, targets, 0, -kLongest), "long before");
      // On the seam of a whole circle the echo is there.
      if (sector_deg == 360) {
        const Difference with = scene.difference(s, {targets[3]});
        double power = 0;
        for (std::size_t k = 0; k < with.with.bins.power_w.size(); ++k)
          power = std::max(power, with.with.bins.power_w[k] - with.without.bins.power_w[k]);
        EXPECT_GT(power, 0);
      }
    }
}

TEST(TargetEchoes, OfTenThousandInOneBinAddUp) {
  const TargetScene scene(level_world());
  const RadarSettings s = sharp_settings_of_test();
  const Bin at = bin_near(s, 0, 5000);
  const Target one = scene.at_range(at.azimuth_rad, at.range_m, 0);
  std::vector<Target> targets(10000, one);
  for (std::size_t k = 0; k < targets.size(); ++k) targets[k].id = k + 1;
  EXPECT_NEAR(scene.difference(s, targets).power_w(at) / scene.echo_power(s, one, 0), 10000, 1e-3);
}

}  // namespace
}  // namespace obliq::test::seen_share_test
