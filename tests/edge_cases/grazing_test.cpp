// Rays along the ground, along the horizon and along a surface: finite, and energy bounded.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "server/scene/exact_hit.h"
#include "tests/support/made_worlds.h"
#include "tests/support/refine_hit.h"
#include "tests/support/samplings.h"
#include "tests/support/sane_frames.h"
#include "tests/support/scenes.h"

namespace obliq::grazing_test {
namespace {

using test::kPi;

RadarSettings settings(double r_min_m, double r_max_m) {
  return test::radar_settings(FrustumKind::oblique, {r_min_m, r_max_m, 20}, {16, 128}, {64, 1024});
}

/// Renders, or says which field refuses the pose. Only a perspective frustum may refuse.
std::optional<Frame> render_or_refuse(const std::shared_ptr<const Scene>& scene, const RadarSettings& s,
                                      const Pose& pose, const test::Sampling& sampling) {
  const PlanResult planned = plan_frame(scene, test::snapshot(s), pose);
  if (!planned.plan) {
    EXPECT_TRUE(sampling.rays()) << sampling.name << ": " << planned.errors.front().text();
    EXPECT_FALSE(planned.errors.front().allowed.empty());
    return std::nullopt;
  }
  return render(scene, test::snapshot(s), pose, {0, s.azimuth_bins});
}

/// Total power of a frame over flat ground against the closed form, relative.
double off_closed_form(const test::Totals& totals, const RadarSettings& s, double below_m) {
  return totals.power_w / test::flat_ground_power_w(s, 1, below_m) - 1;
}

TEST(HardGrazing, AThousandthOfADegreeOverFlatGroundIsFiniteAndKeepsTheEnergy) {
  // Half a metre above a plane: 0.0095 degrees of grazing at 3 km, 0.001 at 28,648 m. sigma written as sigma0
  // A with A = dOmega r^2 / cos(theta) would be up to 57,000 times too great.
  const auto scene = test::make_scene(test::made_world(30000, 250, [](double, double) { return 0.0; }));
  const double h = 0.5;
  ASSERT_NEAR(h / std::sin(0.001 * kDegree_rad), 28648, 1);
  for (const test::Sampling& sampling : test::kSamplings) {
    SCOPED_TRACE(sampling.name);
    const RadarSettings s = test::sampled(settings(3000, 29000), sampling);
    const Pose pose = test::pose_at(scene->world(), {0.25, h, -0.75}, 31);
    const auto frame = render_or_refuse(scene, s, pose, sampling);
    ASSERT_TRUE(frame);
    const test::Totals totals = test::expect_sane(*frame, s, scene->materials());
    std::printf("    %s: total %+.2e from the closed form, farthest sample %.0f m\n", sampling.name,
                off_closed_form(totals, s, h), totals.farthest_m);
    // Most energy lies near 3 km, where the oblique camera's pixels are 157 m wide in a sector of 1040 m:
    // that many pixels in a row are right to half a pixel, 8 %, and rows with more and with fewer alternate
    // as the sector widens. Midpoints of rows, 25 m (symmetric: 3 to 245 m), leave less.
    EXPECT_LT(std::abs(off_closed_form(totals, s, h)), 0.08);
    // Rays at 0.001 degree do hit: with float directions (6e-8) or an Embree without its double refinement
    // their ranges would scatter by 28,648 m x 6e-8 / 1.7e-5 = 98 m.
    EXPECT_GT(totals.farthest_m, 28648);
    EXPECT_EQ(totals.of_state[2], 0u) << "flat ground hides nothing";
  }
}

TEST(HardGrazing, RangesAtAThousandthOfADegreeAreThoseOfThePlane) {
  // range = h / sin(depression); the direction's rounding (1e-16) over the sine (1.7e-5) leaves 6e-12 of
  // 28.6 km, and h = 0.5 m is exact: 2e-7 m.
  const auto scene = test::make_scene(test::made_world(30000, 250, [](double, double) { return 0.0; }));
  const glm::dvec3 antenna(0.25, 0.5, -0.75);
  int hits = 0;
  double worst_m = 0, float_worst_m = 0;
  for (int k = 0; k < 360; ++k) {
    for (const double depression_deg : {0.001, 0.002, 0.01, 0.1}) {
      const double e = -depression_deg * kDegree_rad;
      const double b = (k + 0.123) * kDegree_rad;
      const glm::dvec3 d(std::cos(e) * std::sin(b), std::sin(e), std::cos(e) * std::cos(b));
      RoughHit rough;
      scene->tracer().trace(antenna, &d.x, &d.y, &d.z, 1, &rough);
      const auto hit = test::refine_hit(scene->world(), antenna, d, rough);
      if (!hit) continue;
      ++hits;
      const double exact_m = 0.5 / -std::sin(e);
      worst_m = std::max(worst_m, std::abs(hit->slant_range_m - exact_m));
      float_worst_m = std::max(float_worst_m, std::abs(static_cast<double>(rough.distance_m) - exact_m));
      EXPECT_NEAR(hit->cos_incidence, std::sin(-e), 1e-15);
    }
  }
  std::printf("    %d of 1440 rays hit: worst %.1e m; Embree's float %.1e m\n", hits, worst_m, float_worst_m);
  EXPECT_GE(hits, 1438);
  EXPECT_LT(worst_m, 1e-6);
  EXPECT_GT(float_worst_m, 1e-3);
}

TEST(HardGrazing, NothingIsSeenBeyondTheHorizonOfTheSea) {
  // The sea of the effective earth, k = 4/3, from 300 m: the tangent point lies sqrt(2 k R h) = 71.4 km away
  // (h^2 beside 2 k R h is 2e-5 of it). The mesh's chords of 500 m lie s^2 / 8 k R = 4 mm inside the sphere
  // and its float32 heights within 0.02 mm, which moves the tangent point by sqrt(2 k R 4 mm) = 260 m
  // at most; the ellipsoid's radius of curvature at 33 N lies between 6,354 and 6,384 km, 0.3 % of the
  // distance: 200 m. A flat earth (or a lift of the wrong sign) sees to r_max.
  WorldSpec spec = test::synthetic_spec(SyntheticKind::flat, 90000, 500);
  spec.radius_factor = 4.0 / 3;
  const auto scene = test::make_scene(load_world(spec));
  const double h = 300;
  const double horizon_m = std::sqrt(2 * 4.0 / 3 * kMeanEarthRadius_m * h);
  for (const test::Sampling& sampling : test::kSamplings) {
    SCOPED_TRACE(sampling.name);
    const RadarSettings s = test::sampled(settings(1000, 88000), sampling);
    const Pose pose = test::pose_over_origin(scene->world(), h, 77);
    const auto frame = render_or_refuse(scene, s, pose, sampling);
    ASSERT_TRUE(frame);
    const test::Totals totals = test::expect_sane(*frame, s, scene->materials());
    const double bin_m = (s.r_max_m - s.r_min_m) / s.range_bins;
    std::printf("    %s: horizon %.0f m, farthest sample's bin ends at %.0f m, %zu bins in shadow\n",
                sampling.name, horizon_m, totals.farthest_m, totals.of_state[2]);
    EXPECT_LE(totals.farthest_m, horizon_m + 460 + bin_m);
    const double beyond = (s.r_max_m - horizon_m - 460) / bin_m - 1;
    EXPECT_GE(totals.of_state[2], static_cast<std::size_t>(beyond * s.azimuth_bins)) << "shadow beyond it";
    // Up to a kilometre before the horizon the sea is seen, so no bin there says shadow.
    for (int a = 0; a < s.azimuth_bins; ++a)
      for (int r = 0; r < static_cast<int>((horizon_m - 1460 - s.r_min_m) / bin_m); ++r)
        EXPECT_LE(frame->bins.state[static_cast<std::size_t>(a * s.range_bins + r)], 1) << a << ", " << r;
  }
}

TEST(HardGrazing, RaysTangentToTheSphereAreFiniteWhateverTheyMeet) {
  WorldSpec spec = test::synthetic_spec(SyntheticKind::flat, 90000, 500);
  spec.radius_factor = 4.0 / 3;
  const auto scene = test::make_scene(load_world(spec));
  const glm::dvec3 antenna = test::pose_over_origin(scene->world(), 300).antenna.m;
  const double dip = std::acos(1 / (1 + 300 / (4.0 / 3 * kMeanEarthRadius_m)));
  int hits = 0, rays = 0;
  for (int k = 0; k < 2000; ++k) {
    const double b = k * 0.18 * kDegree_rad;
    // From 1e-3 above the horizon's dip to 1e-3 below it, on a scale that crowds the tangent.
    const double off = (k % 2 ? 1 : -1) * std::pow(10.0, -3 - (k % 13));
    const double e = -dip + off;
    const glm::dvec3 d(std::cos(e) * std::sin(b), std::sin(e), std::cos(e) * std::cos(b));
    RoughHit rough;
    scene->tracer().trace(antenna, &d.x, &d.y, &d.z, 1, &rough);
    ++rays;
    const auto hit = test::refine_hit(scene->world(), antenna, d, rough);
    if (off > 2e-5) {
      EXPECT_FALSE(hit) << "above the horizon by " << off;
    }
    if (!hit) continue;
    ++hits;
    EXPECT_TRUE(std::isfinite(hit->slant_range_m) && hit->slant_range_m > 0 && hit->slant_range_m < 90000);
    EXPECT_GE(hit->cos_incidence, 0);
    EXPECT_LT(hit->cos_incidence, 0.01);
    // On the surface, to the 1e-6 of the range along a ray that descends by less than 1e-2.
    EXPECT_NEAR(scene->world().grid.height_at_m(hit->position_m.x, hit->position_m.z), hit->position_m.y,
                1e-8);
  }
  std::printf("    %d of %d rays within 1e-3 rad of the tangent hit\n", hits, rays);
  EXPECT_GT(hits, 500);
}

TEST(HardGrazing, RaysNearlyAlongAnAxisOfTheMeshHitLikeAnyOther) {
  // A bearing of 90 degrees has a cosine of 6e-17, and its sums with others cancel to less. Embree 3.13 loses
  // two rays of three when one component lies between -1e-18 and 0 in a packet with other directions.
  const auto scene = test::make_scene(test::made_world(6000, 64, [](double, double) { return 0.0; }));
  for (const double tiny : {0.0, -0.0, -1e-300, -1e-40, -1e-19, -9e-19, -1.1e-18, -1e-17, -6.1e-17, -1e-15,
                            -1e-12, 1e-19, 1e-18, 6.1e-17}) {
    for (const bool along_x : {true, false}) {
      for (const double side : {1.0, -1.0}) {
        for (const bool mixed : {true, false}) {
          std::vector<double> x, y, z;
          for (int k = 0; k < 512; ++k) {
            const double down = 512 / (1024 + 5.7 * k);
            const double ahead = side * std::sqrt(1 - down * down);
            const double across = tiny + (mixed ? (k % 3 - 1) * 0.5 * ahead : 0.0);
            x.push_back(along_x ? ahead : across);
            y.push_back(-down);
            z.push_back(along_x ? across : ahead);
          }
          std::vector<RoughHit> hits(x.size());
          scene->tracer().trace({64, 512, 70.7}, x.data(), y.data(), z.data(), static_cast<int>(x.size()),
                                hits.data());
          int missed = 0;
          for (const RoughHit& hit : hits) missed += hit.kind == RoughHit::Kind::none ? 1 : 0;
          EXPECT_EQ(missed, 0) << tiny << (along_x ? " along x" : " along z") << (mixed ? ", mixed" : "");
        }
      }
    }
  }
}

/// Ground all around, unknown within 1.5 km, so that an antenna may stand in the plane itself.
World plane_around_the_antenna(double slope) {
  return test::made_world(12000, 100, [slope](double x, double z) {
    return std::hypot(x, z) < 1500 ? test::kUnknown : slope * z;
  });
}

TEST(HardGrazing, APlaneThatHoldsTheAntennaIsSeenExactlyEdgeOn) {
  // Every ray to it has a normal exactly perpendicular to it: no hit, or a hit of no energy.
  for (const double slope : {0.0, 0.125, -0.125}) {
    const auto scene = test::make_scene(plane_around_the_antenna(slope));
    for (const test::Sampling& sampling : test::kSamplings) {
      SCOPED_TRACE(sampling.name);
      const RadarSettings s = test::sampled(settings(1000, 11000), sampling);
      const Pose pose = test::pose_at(scene->world(), {0, 0, 0}, 0);
      const auto frame = render_or_refuse(scene, s, pose, sampling);
      if (!frame) continue;
      const test::Totals totals = test::expect_sane(*frame, s, scene->materials());
      // Seen from a micrometre above the closed form gives this much; edge-on is less.
      EXPECT_LT(totals.power_w, test::flat_ground_power_w(s, 1, 1e-6)) << slope;
    }
  }
  // The same through the exact intersection: a ray in the plane has no descent and no hit.
  const World world = plane_around_the_antenna(0.125);
  const glm::dvec3 along = glm::dvec3(0, 0.125, 1) / std::sqrt(1 + 0.125 * 0.125);
  EXPECT_FALSE(walk_ground(world, {0, 0, 0}, along, 0, 12000).has_value());
}

TEST(HardGrazing, IncidenceAlongTheNormalIsExactlyOneAndNeverAbove) {
  const auto scene =
      test::make_scene(test::made_world(3000, 50, [](double x, double z) { return (x + z) / 8; }));
  // Straight down the normal of (x + z) / 8, and near it, from anywhere.
  const glm::dvec3 normal = glm::dvec3(-0.125, 1, -0.125) / std::sqrt(1 + 2 * 0.125 * 0.125);
  for (int k = 0; k < 1000; ++k) {
    const glm::dvec3 foot(1.37 * k - 600, (1.37 * k - 600 + 0.91 * k - 500) / 8, 0.91 * k - 500);
    const glm::dvec3 antenna = foot + 500.0 * normal;
    const glm::dvec3 d = -normal;
    RoughHit rough;
    scene->tracer().trace(antenna, &d.x, &d.y, &d.z, 1, &rough);
    const auto hit = test::refine_hit(scene->world(), antenna, d, rough);
    ASSERT_TRUE(hit) << k;
    EXPECT_LE(hit->cos_incidence, 1);
    EXPECT_NEAR(hit->cos_incidence, 1, 4e-16);  // two roundings of a product and one of a root
    EXPECT_NEAR(hit->slant_range_m, 500, 1e-10);
  }
  // The nadir inside the swath: r_min 0 and a specular ground, whose lobe is greatest head on.
  Material mirror = test::two_materials()[1];
  mirror.rms_slope = 0.001;
  const auto flat =
      test::make_scene(test::made_world(3000, 50, [](double, double) { return 0.0; }), {mirror});
  for (const test::Sampling& sampling : test::kSamplings) {
    SCOPED_TRACE(sampling.name);
    RadarSettings s = test::sampled(settings(0, 2500), sampling);
    s.sector_deg = 90;
    // Over a node, over a grid line, over a diagonal, over nothing special.
    for (const auto& [x, z] : {std::pair{100.0, -50.0}, {25.0, 50.0}, {25.0, 25.0}, {13.7, 21.9}}) {
      if (sampling.rays()) s.r_min_m = 1000;
      const Pose pose = test::pose_at(flat->world(), {x, 1000, z}, 45);
      const auto frame = render_or_refuse(flat, s, pose, sampling);
      ASSERT_TRUE(frame);
      const test::Totals totals = test::expect_sane(*frame, s, flat->materials());
      EXPECT_GT(totals.power_w, 0);
      EXPECT_LE(totals.nearest_m, 1000 + 2500.0 / 128) << "nadir";
    }
  }
}

}  // namespace
}  // namespace obliq::grazing_test
