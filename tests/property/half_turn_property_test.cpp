// Turning scene and antenna together by half a turn changes nothing but rounding: no direction is special,
// and grid cells are split along a diagonal that a half turn maps on itself. Over random scenes, for every
// source.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "tests/property/trial.h"

namespace obliq {
namespace {

/// A scene turned by 180 degrees about the middle of its grid. All coordinates are multiples of 2^-10 m far
/// below 2^43 m, so every turned one is exact; vertices are multiples of 2^-6 m below 2^17 m and exact in
/// float32.
test::RandomScene turned(test::RandomScene scene) {
  World& world = scene.world;
  const double x_sum = world.grid.x0_m + world.grid.x1_m();
  const double z_sum = world.grid.z0_m + world.grid.z1_m();
  const auto turn_float = [](float value, double sum) {
    return static_cast<float>(sum - static_cast<double>(value));
  };
  std::reverse(world.grid.y_m.begin(), world.grid.y_m.end());
  for (auto* corners : {&world.buildings.ring_xz_m, &world.buildings.part_xz_m})
    for (glm::vec2& p : *corners) p = {turn_float(p.x, x_sum), turn_float(p.y, z_sum)};
  for (BuildingFace& face : world.buildings.faces) {
    face.centre_m.x = x_sum - face.centre_m.x;
    face.centre_m.z = z_sum - face.centre_m.z;
  }
  glm::dvec3& antenna = scene.pose.antenna.m;
  antenna.x = x_sum - antenna.x;
  antenna.z = z_sum - antenna.z;
  scene.pose.bearing_world_rad += std::numbers::pi;
  return scene;
}

class HalfTurnOfEverySource : public testing::TestWithParam<test::NamedSource> {};

/// What a half turn changed over many scenes.
struct Turned {
  int frames = 0, bins = 0, moved = 0, other_state = 0;
  double worst = 0;  ///< of the bins that did not move, relative
};

Turned turn_scenes(FrustumKind kind, PlateKind plates) {
  // Flat earth: the ellipsoid is not the same towards north and south.
  test::RandomSceneOptions options;
  options.curved = false;
  // What bounds the ground (SectorExtent) goes by tiles of 32 x 32 cells, counted from the south-west: only a
  // grid of whole tiles turns into itself.
  options.square = true;
  Turned all;
  for (std::uint64_t seed = 20000; seed < 21500; ++seed) {
    const test::Trial there(seed, options);
    const test::Trial back(turned(test::random_scene(seed, options)));
    SCOPED_TRACE(there.text);
    RadarSettings s = there.settings_of(kind);
    s.plates = plates;
    s.sub_columns = 0;  // floats round more
    EXPECT_EQ(there.plan(s) == nullptr, back.plan(s) == nullptr);
    if (!there.plan(s) || !back.plan(s)) continue;
    ++all.frames;
    const BinBlock one = there.frame(s).bins, two = back.frame(s).bins;
    for (std::size_t b = 0; b < one.power_w.size(); ++b) {
      ++all.bins;
      all.other_state += one.state[b] != two.state[b] ? 1 : 0;
      const double off =
          std::abs(one.power_w[b] - two.power_w[b]) / std::max({one.power_w[b], two.power_w[b], 1e-300});
      if (off > 1e-8) {
        ++all.moved;
      } else {
        all.worst = std::max(all.worst, off);
      }
    }
  }
  std::printf(
      "    %d frames, %d bins: power off by at most %.1e; %d bins with a sample moved, %d with another "
      "state\n",
      all.frames, all.bins, all.worst, all.moved, all.other_state);
  return all;
}

TEST_P(HalfTurnOfEverySource, ChangesPowerByRoundingOnly) {
  const Turned nearest = turn_scenes(GetParam().kind, PlateKind::nearest);
  EXPECT_GE(nearest.frames, 200);
  // bearing + pi rounds by 4e-16 rad, and ranges by as much of themselves, a few hundred times more at
  // grazing; the solid angle of a sliver at a silhouette is a difference of angles and keeps fewer digits. A
  // sample within rounding of a bin's edge or a silhouette would change over; in these scenes none does.
  // Ranges from Embree's float distances (the named wrong version) leave 1e-7.
  EXPECT_EQ(nearest.moved, 0);
  EXPECT_EQ(nearest.other_state, 0);
  // Spread plates end at bin edges: rounding says on which side of one a plate ends. One bin in 1000 has one
  // sample more or less.
  const Turned spread = turn_scenes(GetParam().kind, PlateKind::spread);
  EXPECT_LE(spread.moved, spread.bins / 500);
  EXPECT_EQ(spread.other_state, 0);
}

INSTANTIATE_TEST_SUITE_P(Sources, HalfTurnOfEverySource, testing::ValuesIn(test::kEverySource),
                         test::source_name<testing::TestParamInfo<test::NamedSource>>);

}  // namespace
}  // namespace obliq
