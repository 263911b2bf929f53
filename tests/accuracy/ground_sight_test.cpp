// Whether points are seen, and by what angle, against the reference renderer's own walk (server/truth), which
// shares no code with the query but the world.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/ground_query/ground_query.h"
#include "server/radar/profile/roofs.h"
#include "server/truth/plane_walk.h"
#include "terrain/base/units.h"
#include "tests/support/random_scenes.h"

namespace obliq {
namespace {

using wire::Sight;

/// The greatest tangent of elevation of what the reference sees before a distance.
long double reference_horizon(const std::vector<Strip>& lit, double d_m) {
  long double highest = -HUGE_VALL;
  const auto raise = [&](long double d, long double h) {
    if (d > 0) highest = std::max(highest, h / d);
  };
  for (const Strip& strip : lit) {
    if (strip.d0_m >= d_m) continue;
    const long double share =
        strip.d1_m > d_m ? (d_m - static_cast<long double>(strip.d0_m)) / (strip.d1_m - strip.d0_m) : 1;
    raise(strip.d0_m, strip.h0_m);
    raise(strip.d0_m + share * (strip.d1_m - strip.d0_m), strip.h0_m + share * (strip.h1_m - strip.h0_m));
  }
  return highest;
}

struct Tally {
  int seen = 0, hidden = 0, by_buildings = 0, inside = 0, wrong_if_raised = 0;
};

class Comparison {
 public:
  Comparison(const std::shared_ptr<const Scene>& scene, const Pose& pose, const std::string& text)
      : scene_(scene),
        world_(scene->world()),
        pose_(pose),
        text_(text),
        bounds_(*scene),
        query_(*scene, bounds_) {
    view_.antenna_m = pose.antenna.m;
    view_.sector_rad = 2 * std::numbers::pi;
    view_.azimuth_bins = 1;
    view_.r_max_m = 1e6;
    view_.range_bins = 1;
  }

  void compare(double bearing_rad, test::Dice& dice, int points, Tally& tally) const {
    const SightedBuildings sighted(world_.buildings, view_, 0, 1);
    PlaneWalk walk(world_, sighted, view_);
    PlaneStrips strips;
    walk.walk(bearing_rad, 0, strips);
    const double reach = 1.5 * world_.grid.cell_m * std::max(world_.grid.nx, world_.grid.nz);
    for (int k = 0; k < points; ++k) {
      const double d = dice.uniform(0.01, 1) * reach;
      const double x = pose_.antenna.m.x + d * std::sin(bearing_rad);
      const double z = pose_.antenna.m.z + d * std::cos(bearing_rad);
      const double ground = world_.grid.height_at_m(x, z);
      if (std::isnan(ground)) continue;
      const double over = dice.chance(0.5) ? 0 : dice.logarithmic(0.01, 100);
      look_at({x, ground + over, z}, d, reference_horizon(strips.lit, d), tally);
    }
  }

 private:
  void look_at(const glm::dvec3& point, double d, long double horizon, Tally& tally) const {
    const Geodetic at = world_.frame.geodetic_from_world({point});
    const wire::GroundRecord got =
        query_.answer(at.latitude_rad / kDegree_rad, at.longitude_rad / kDegree_rad,
                      {at.height_m, HeightReference::datum, 0}, &pose_);
    const auto roof = roof_above(world_.buildings, point);
    if (roof && *roof > point.y + 2 * kOnSurface_m) {
      EXPECT_EQ(got.sight, Sight::inside_building) << text_;
      ++tally.inside;
      return;
    }
    const double above = point.y - pose_.antenna.m.y;
    const auto hidden_m = static_cast<double>(horizon * d - above);
    const bool hidden = got.sight == Sight::behind_ground || got.sight == Sight::behind_building;
    if (std::abs(hidden_m - kOnSurface_m) < kOnSurface_m / 2 || (roof && *roof > point.y)) return;
    ASSERT_TRUE(hidden || got.sight == Sight::visible) << static_cast<int>(got.sight) << ' ' << text_;
    EXPECT_EQ(hidden, hidden_m > kOnSurface_m)
        << hidden_m << " m under the horizon at " << d << " m, " << text_;
    const double expected = std::atan2(above, d) - static_cast<double>(std::atan(horizon));
    // Floats of up to 180 degrees.
    EXPECT_NEAR(got.clearance_deg, std::max(expected, hidden ? -HUGE_VAL : 0.0) / kDegree_rad, 2e-5) << text_;
    (hidden ? tally.hidden : tally.seen) += 1;
    tally.by_buildings += got.sight == Sight::behind_building ? 1 : 0;
    // A metre more would be seen as often as not: the comparison can fail.
    tally.wrong_if_raised += hidden_m > kOnSurface_m && hidden_m - 1 <= kOnSurface_m ? 1 : 0;
  }

  std::shared_ptr<const Scene> scene_;
  const World& world_;
  Pose pose_;
  std::string text_;
  SurfaceBounds bounds_;
  GroundQuery query_;
  ReferenceView view_;
};

Tally compare_scenes(const test::RandomSceneOptions& options, int scenes, int planes, int points) {
  Tally tally;
  for (std::uint64_t seed = 0; seed < static_cast<std::uint64_t>(scenes); ++seed) {
    test::RandomScene random = test::random_scene(seed, options);
    const Pose pose = random.pose;
    const std::string text = random.text;
    const Comparison comparison(test::scene_of(random), pose, text);
    test::Dice dice(seed + 77);
    for (int k = 0; k < planes; ++k)
      comparison.compare(dice.uniform(0, 2 * std::numbers::pi), dice, points, tally);
  }
  std::printf("    %d seen, %d hidden, of those %d by buildings, %d inside one\n", tally.seen, tally.hidden,
              tally.by_buildings, tally.inside);
  return tally;
}

TEST(GroundSight, IsThatOfTheReferenceInRandomScenes) {
  const Tally tally = compare_scenes({.voids = false, .outside = false}, 150, 12, 20);
  EXPECT_GT(tally.seen, 3000);
  EXPECT_GT(tally.hidden, 1000);
  EXPECT_GT(tally.by_buildings, 50);
  EXPECT_GT(tally.inside, 50);
  EXPECT_GT(tally.wrong_if_raised, 100);
}

TEST(GroundSight, IsThatOfTheReferenceOverGridsOfManySquares) {
  // Bounds on several levels: 700 nodes a side are 88 of the smallest squares.
  const Tally tally =
      compare_scenes({.nodes = 700, .most_prisms = 300, .voids = false, .outside = false}, 6, 60, 20);
  EXPECT_GT(tally.seen, 500);
  EXPECT_GT(tally.hidden, 300);
}

}  // namespace
}  // namespace obliq
