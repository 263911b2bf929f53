// Terrain profiles that are marched side by side, with roofs on them.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "server/radar/profile.h"
#include "tests/support/random_scenes.h"
#include "tests/support/scenes.h"

namespace obliq {
namespace {

TEST(Profiles, SideBySideAreThoseOfOneAtATimeInEveryInstructionSet) {
  std::size_t visible = 0, roofs = 0;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    test::RandomScene random = test::random_scene(seed);
    roofs += random.world.buildings.list.size();
    const auto scene = test::scene_of(random);
    const auto plan = plan_frame(scene, test::snapshot(random.settings), random.pose).plan;
    std::vector<double> positions;
    for (std::size_t k = 0; k < 1 + seed % kMostProfiles; ++k)
      positions.push_back(static_cast<double>(k) * plan->bins().n_azimuth / kMostProfiles);
    std::vector<FootprintSpan> spans;
    for (const LaneKernels& kernels : all_lane_kernels()) {
      std::vector<ProfileResult> found(positions.size());
      march_profiles(*plan, positions, found, spans, kernels);
      for (std::size_t k = 0; k < positions.size(); ++k) {
        ProfileResult one;
        march_profile(*plan, positions[k], spans, one);
        EXPECT_EQ(found[k].visible, one.visible) << kernels.name << ' ' << random.text;
        EXPECT_EQ(found[k].present, one.present) << kernels.name << ' ' << random.text;
        EXPECT_EQ(found[k].sector_area_m2, one.sector_area_m2);
        EXPECT_EQ(found[k].covered_area_m2, one.covered_area_m2) << kernels.name << ' ' << random.text;
        visible += static_cast<std::size_t>(std::count(one.visible.begin(), one.visible.end(), 1));
      }
    }
  }
  EXPECT_GT(visible, 1000u);
  EXPECT_GT(roofs, 500u);
}

}  // namespace
}  // namespace obliq
