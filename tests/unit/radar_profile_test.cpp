// Terrain profiles that are marched side by side, whole and in part, with roofs on them, and the states of
// bins that they decide.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "server/radar/profile.h"
#include "server/radar/wedge_profile.h"
#include "tests/support/random_scenes.h"
#include "tests/support/scenes.h"

namespace obliq {
namespace {

RangeWindow all_bins(const FramePlan& plan) { return {0, plan.bins().n_range - 1}; }

/// Planes all over the sector.
std::vector<ProfileWish> wishes_of(const FramePlan& plan, std::uint64_t seed) {
  std::vector<ProfileWish> wishes;
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
    const std::vector<ProfileWish> wishes = wishes_of(*plan, seed);
    std::vector<FootprintSpan> spans;
    for (const LaneKernels& kernels : all_lane_kernels()) {
      std::vector<ProfileResult> found(wishes.size());
      march_profiles(*plan, wishes, found, spans, kernels);
      for (std::size_t k = 0; k < wishes.size(); ++k) {
        ProfileResult one;
        march_profile(*plan, wishes[k].position, spans, one);
        EXPECT_EQ(found[k].visible, one.visible) << kernels.name << ' ' << random.text;
        EXPECT_EQ(found[k].present, one.present) << kernels.name << ' ' << random.text;
        EXPECT_EQ(found[k].area.sector_m2, one.area.sector_m2);
        EXPECT_EQ(found[k].area.covered_m2, one.area.covered_m2) << kernels.name << ' ' << random.text;
        if (scene->tiles().whole()) {
          const ProfileArea known = area_of_known_ground(*plan, wishes[k].position);
          EXPECT_EQ(known.sector_m2, one.area.sector_m2);
          EXPECT_EQ(known.covered_m2, one.area.covered_m2) << random.text;
        }
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
    std::vector<ProfileWish> wishes = wishes_of(*plan, seed);
    test::Dice dice(seed);
    for (ProfileWish& wish : wishes) {
      wish.bins.first = dice.integer(0, plan->bins().n_range - 1);
      wish.bins.last = dice.integer(wish.bins.first, plan->bins().n_range - 1);
    }
    std::vector<FootprintSpan> spans;
    for (const LaneKernels& kernels : all_lane_kernels()) {
      std::vector<ProfileResult> found(wishes.size());
      march_profiles(*plan, wishes, found, spans, kernels);
      for (std::size_t k = 0; k < wishes.size(); ++k) {
        ProfileResult whole;
        march_profile(*plan, wishes[k].position, spans, whole);
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

TEST(States, AreThoseThatAllStrandsOfAWholeProfileDecide) {
  test::RandomSceneOptions large;
  large.nodes = 150;
  int decided[4] = {};
  for (std::uint64_t seed = 1000; seed < 1060; ++seed) {
    test::RandomScene random = test::random_scene(seed, large);
    random.settings.frustum = seed % 2 == 0 ? FrustumKind::polar : FrustumKind::sweep;
    random.settings.plates = PlateKind::nearest;
    const auto scene = test::scene_of(random);
    const auto snapshot = test::snapshot(random.settings);
    const auto plan = plan_frame(scene, snapshot, random.pose).plan;
    const AzimuthRange all{0, random.settings.azimuth_bins};
    const Frame frame = render(scene, snapshot, random.pose, all);
    WedgeProfile profile(*plan, all);
    double sector_m2 = 0;
    for (int a = 0; a < all.count; ++a) {
      const BinMarks& marks = profile.whole_marks(a);
      sector_m2 += profile.centre(a).area.sector_m2;
      for (int r = 0; r < frame.bins.n_range; ++r) {
        const auto k = static_cast<std::size_t>(r);
        const std::uint8_t state =
            frame.bins.state[static_cast<std::size_t>(a) * static_cast<std::size_t>(frame.bins.n_range) + k];
        ++decided[state];
        if (state == static_cast<std::uint8_t>(BinState::sampled)) continue;
        const BinState expected = marks.visible[k]   ? BinState::not_sampled
                                  : marks.present[k] ? BinState::shadow
                                                     : BinState::no_surface;
        ASSERT_EQ(state, static_cast<std::uint8_t>(expected)) << a << ' ' << r << ' ' << random.text;
      }
    }
    EXPECT_NEAR(frame.stats.sector_area_m2, sector_m2, 1e-9 * sector_m2);
  }
  for (const int count : decided) EXPECT_GT(count, 100);
}

}  // namespace
}  // namespace obliq
