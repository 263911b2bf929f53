// Terrain profiles that are marched side by side, whole and in part, with roofs on them, and the states of
// bins that they decide.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "server/radar/profile/ground_walk.h"
#include "server/radar/simd/kernels.h"
#include "server/radar/visibility/coverage.h"
#include "server/radar/visibility/range_march.h"
#include "server/radar/visibility/wedge_visibility.h"
#include "tests/support/random_scenes.h"
#include "tests/support/scenes.h"

namespace obliq::profiles_test {
namespace {

RangeWindow all_bins(const ScenePlan& plan) { return {0, plan.bins().n_range - 1}; }

/// Marches the profile at a position in bins from the nadir, with roofs from the start: one at a time.
void march_profile(const ScenePlan& plan, double position, BinMarks& marks) {
  const World& world = plan.scene().world();
  const glm::dvec3& antenna = plan.sector().antenna_m;
  const double bearing_rad = plan.bearing_rad(position);
  Profile plane;
  plane.bearing = {std::sin(bearing_rad), std::cos(bearing_rad)};
  std::vector<RoofSpan> spans;
  for (const std::uint32_t b :
       plan.buildings_in(std::min(static_cast<int>(position), plan.bins().n_azimuth - 1)))
    add_roof_spans(world.buildings, b, antenna.x, antenna.z, plane.bearing.sin, plane.bearing.cos, spans);
  plane.roofs = disjoint_roofs(spans);
  marks = BinMarks(plan.bins().n_range);
  GroundWalk walk(world.grid, antenna, plane.bearing.sin, plane.bearing.cos, 0, plan.bins().r_max_m);
  if (walk.done()) return;
  RangeMarch marcher(plan.bins(), antenna.y, plane.state, marks);
  ProfileSurface surface(plane, marcher, walk.at_m(), true);
  walk.advance(walk.end_m(), surface);
  marcher.gap();
}

/// Planes all over the sector.
std::vector<VisibilityRequest> wishes_of(const ScenePlan& plan, std::uint64_t seed) {
  std::vector<VisibilityRequest> wishes;
  for (std::size_t k = 0; k < 1 + seed % kMostProfiles; ++k)
    wishes.push_back({static_cast<double>(k) * plan.bins().n_azimuth / kMostProfiles, all_bins(plan)});
  return wishes;
}

TEST(Profiles, SideBySideAreThoseOfOneAtATimeInEveryInstructionSet) {
  std::size_t visible = 0, roofs = 0;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    test::RandomScene random = test::random_scene(seed);
    roofs += random.world.buildings.list.size();
    const auto scene = test::scene_of(random);
    const auto plan = plan_frame(scene, test::snapshot(random.settings), random.pose).plan;
    const std::vector<VisibilityRequest> wishes = wishes_of(plan->looks_at(), seed);
    std::vector<RoofSpan> spans;
    for (const Kernels& kernels : all_kernels()) {
      std::vector<BinMarks> found(wishes.size());
      use_kernels(kernels);
      mark_profiles(plan->looks_at(), wishes, found, spans);
      for (std::size_t k = 0; k < wishes.size(); ++k) {
        BinMarks one;
        march_profile(plan->looks_at(), wishes[k].position, one);
        EXPECT_EQ(found[k].visible, one.visible) << kernels.name << ' ' << random.text;
        EXPECT_EQ(found[k].present, one.present) << kernels.name << ' ' << random.text;
        visible += static_cast<std::size_t>(std::count(one.visible.begin(), one.visible.end(), 1));
      }
    }
  }
  EXPECT_GT(visible, 1000u);
  EXPECT_GT(roofs, 500u);
}

TEST(Profiles, OfSomeBinsAreRightInThemWhereverTheyBegin) {
  test::RandomSceneOptions large;
  large.nodes = 300;  // far enough for a march to begin on the way
  int late = 0, late_with_roofs = 0, hidden = 0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    test::RandomScene random = test::random_scene(seed, large);
    const bool roofs = !random.world.buildings.list.empty();
    const auto scene = test::scene_of(random);
    const auto plan = plan_frame(scene, test::snapshot(random.settings), random.pose).plan;
    std::vector<VisibilityRequest> wishes = wishes_of(plan->looks_at(), seed);
    test::Dice dice(seed);
    for (VisibilityRequest& wish : wishes) {
      wish.bins.first = dice.integer(0, plan->bins().n_range - 1);
      wish.bins.last = dice.integer(wish.bins.first, plan->bins().n_range - 1);
    }
    std::vector<RoofSpan> spans;
    for (const Kernels& kernels : all_kernels()) {
      std::vector<BinMarks> found(wishes.size());
      use_kernels(kernels);
      mark_profiles(plan->looks_at(), wishes, found, spans);
      for (std::size_t k = 0; k < wishes.size(); ++k) {
        BinMarks whole;
        march_profile(plan->looks_at(), wishes[k].position, whole);
        const RangeWindow bins = wishes[k].bins;
        for (auto r = static_cast<std::size_t>(bins.first); r <= static_cast<std::size_t>(bins.last); ++r) {
          ASSERT_EQ(found[k].visible[r], whole.visible[r]) << r << ' ' << kernels.name << ' ' << random.text;
          ASSERT_EQ(found[k].present[r], whole.present[r]) << r << ' ' << kernels.name << ' ' << random.text;
          hidden += whole.present[r] != 0 && whole.visible[r] == 0 ? 1 : 0;
        }
        if (found[k].present != whole.present) {
          const auto before = static_cast<std::ptrdiff_t>(bins.first);
          const bool began_late =
              !std::equal(whole.present.begin(), whole.present.begin() + before, found[k].present.begin());
          late += began_late ? 1 : 0;
          late_with_roofs += began_late && roofs ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GT(late, 300);
  EXPECT_GT(late_with_roofs, 100);
  EXPECT_GT(hidden, 1000);
}

TEST(GroundArea, IsWhatAWalkOverEveryCellFinds) {
  struct Known {
    std::vector<std::pair<double, double>> stretches_m;
    void ground(const GroundSegment& segment) { stretches_m.emplace_back(segment.d0_m, segment.d1_m); }
    static void gap(double, double) {}
    static bool enough() { return false; }
  };
  test::RandomSceneOptions large;
  large.nodes = 100;
  int parts = 0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    test::RandomScene random = test::random_scene(seed, large);
    const auto scene = test::scene_of(random);
    const auto plan = plan_frame(scene, test::snapshot(random.settings), random.pose).plan;
    const BinGrid& bins = plan->bins();
    const glm::dvec3& antenna = plan->sector().antenna_m;
    for (int a = 0; a < bins.n_azimuth; a += 5) {
      const GroundArea area = ground_area(*plan, a);
      if (!plan->looks_at().extent().any) continue;
      const double bearing = plan->sector().bearing_rad + bins.azimuth_edge_rad(a + 0.5);
      Known known;
      GroundWalk(scene->world().grid, antenna, std::sin(bearing), std::cos(bearing), 0, bins.r_max_m)
          .advance(bins.r_max_m, known);
      const double above_m = antenna.y - plan->looks_at().extent().median_height_m -
                             scene->world().frame.datum_y_m(antenna.x, antenna.z);
      const auto swath = [&](double range_m) {
        return std::sqrt(std::max(0.0, range_m * range_m - above_m * above_m));
      };
      const double near_m = swath(bins.r_min_m), far_m = swath(bins.r_max_m);
      const auto sector = [&](double d0, double d1) {
        const double x0 = std::clamp(d0, near_m, far_m), x1 = std::clamp(d1, near_m, far_m);
        return bins.azimuth_width_rad / 2 * (x1 * x1 - x0 * x0);
      };
      double covered_m2 = 0;
      for (const auto& [d0, d1] : known.stretches_m) covered_m2 += sector(d0, d1);
      const double all_m2 = sector(near_m, far_m);
      EXPECT_NEAR(area.sector_m2, all_m2, 1e-9 * all_m2) << random.text;
      EXPECT_NEAR(area.covered_m2, covered_m2, 1e-7 * all_m2) << random.text;
      parts += covered_m2 > 0.05 * all_m2 && covered_m2 < 0.95 * all_m2 ? 1 : 0;
    }
  }
  EXPECT_GT(parts, 300);
}

TEST(States, AreThoseThatAllStrandsOfAWholeProfileDecide) {
  test::RandomSceneOptions large;
  large.nodes = 150;
  int decided[5] = {};
  for (std::uint64_t seed = 1000; seed < 1060; ++seed) {
    test::RandomScene random = test::random_scene(seed, large);
    random.settings.frustum = FrustumKind::sweep;
    random.settings.sub_columns = 0;  // whose bins are those that are looked at
    const auto scene = test::scene_of(random);
    const auto snapshot = test::snapshot(random.settings);
    const auto plan = plan_frame(scene, snapshot, random.pose).plan;
    const AzimuthRange all{0, random.settings.azimuth_bins};
    const Frame frame = render(scene, snapshot, random.pose, all);
    WedgeVisibility profile(plan->looks_at(), all);
    for (int a = 0; a < all.count; ++a) {
      const BinMarks& marks = profile.whole_marks(a);
      bool before_surface = random.pose.antenna.m.y - random.pose.ground_y_m >= plan->bins().r_min_m;
      for (int r = 0; r < frame.bins.n_range; ++r) {
        const auto k = static_cast<std::size_t>(r);
        const std::size_t bin =
            static_cast<std::size_t>(a) * static_cast<std::size_t>(frame.bins.n_range) + k;
        const std::uint8_t state = frame.bins.state[bin];
        ++decided[state];
        before_surface &= !marks.present[k] && frame.bins.count[bin] == 0;
        if (state == static_cast<std::uint8_t>(BinState::sampled)) continue;
        const BinState expected = marks.visible[k]   ? BinState::not_sampled
                                  : marks.present[k] ? BinState::shadow
                                  : before_surface   ? BinState::nearer_than_ground
                                                     : BinState::no_surface;
        ASSERT_EQ(state, static_cast<std::uint8_t>(expected)) << a << ' ' << r << ' ' << random.text;
      }
    }
  }
  for (const int count : decided) EXPECT_GT(count, 100);
}

}  // namespace
}  // namespace obliq::profiles_test
