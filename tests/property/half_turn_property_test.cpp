// Turning scene and antenna together by half a turn changes nothing but rounding: no direction is special,
// and grid cells are split along a diagonal that a half turn maps on itself. Over random scenes, for every
// source.
// With the sweep and equal spacing a longer range never changes nearer bins, bit for bit: what lies nearer is
// found before what lies farther, and nothing of it is laid out by where the swath ends. With one exception:
// where ground rises so steeply that range falls along it, a plane may come back from beyond the swath's end.
// What it sees there is an echo of its own if it has been in another bin meanwhile, and else joins the one
// before, so that a float is rounded once more or less. Over random scenes.
// The same bits from 1, 2 and 5 threads and from any part of the azimuths. Over random scenes, for every
// source.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <numbers>

#include "tests/property/trial.h"
#include "tests/support/same_bits.h"

namespace obliq::half_turn_property_test {
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
  for (Building& building : world.buildings.list)
    building.centre_m = glm::dvec2(x_sum, z_sum) - building.centre_m;
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

/// The settings with a spacing that is a power of two and edges that are multiples of it, so that the spacing
/// is the same to the last bit however many bins there are.
RadarSettings whole_spacing(RadarSettings s) {
  const double spacing_m = std::exp2(std::floor(std::log2((s.r_max_m - s.r_min_m) / s.range_bins)));
  s.r_min_m = std::floor(s.r_min_m / spacing_m) * spacing_m;
  s.r_max_m = s.r_min_m + s.range_bins * spacing_m;
  return s;
}

/// How many bins of `part` differ in any plane from the same bins of `whole`.
struct Differences {
  int bins = 0, power = 0, iq = 0, count = 0, state = 0;
  double worst = 0;  ///< of powers, relative

  void add(const BinBlock& part, const BinBlock& whole) {
    for (int a = 0; a < part.n_azimuth; ++a) {
      for (int r = 0; r < part.n_range; ++r) {
        const auto p = static_cast<std::size_t>(a * part.n_range + r);
        const auto w = static_cast<std::size_t>(a * whole.n_range + r);
        ++bins;
        power += std::memcmp(&part.power_w[p], &whole.power_w[w], sizeof(double)) != 0 ? 1 : 0;
        worst = std::max(worst, std::abs(part.power_w[p] - whole.power_w[w]) /
                                    std::max(part.power_w[p] + whole.power_w[w], 1e-300));
        iq += std::memcmp(&part.iq[p], &whole.iq[w], sizeof part.iq[p]) != 0 ? 1 : 0;
        count += part.count[p] != whole.count[w] ? 1 : 0;
        state += part.state[p] != whole.state[w] ? 1 : 0;
      }
    }
  }
};

TEST(LongerRange, NeverChangesNearerBinsOfTheSweep) {
  int with_prisms = 0;
  Differences all;
  for (std::uint64_t seed = 50000; seed < 52000; ++seed) {
    const test::Trial trial(seed);
    SCOPED_TRACE(trial.text);
    test::Dice dice(seed);
    RadarSettings near = whole_spacing(trial.settings_of(FrustumKind::sweep));
    near.sub_columns = 0;  // floats round by where the swath ends
    RadarSettings far = near;
    far.range_bins += dice.integer(1, 60);
    far.r_max_m = far.r_min_m + far.range_bins * ((near.r_max_m - near.r_min_m) / near.range_bins);
    with_prisms += trial.scene->world().buildings.list.empty() ? 0 : 1;
    Differences here;
    here.add(trial.frame(near).bins, trial.frame(far).bins);
    EXPECT_LT(here.worst, 1e-7);
    EXPECT_EQ(here.state, 0);
    EXPECT_LE(here.iq, here.power);
    EXPECT_LE(here.count, here.power);
    all.bins += here.bins;
    all.power += here.power;
    all.state += here.state;
  }
  std::printf("    2000 scenes (%d with prisms), %d bins: %d with other power, %d with another state\n",
              with_prisms, all.bins, all.power, all.state);
  EXPECT_LE(all.power, 2);
  EXPECT_GE(with_prisms, 500);
}

class BitsOfEverySource : public testing::TestWithParam<test::NamedSource> {};

TEST_P(BitsOfEverySource, ComeFromAnyThreadsAndAnyAzimuths) {
  int frames = 0, several_wedges = 0;
  for (std::uint64_t seed = 10000; seed < 11000; ++seed) {
    const test::Trial trial(seed);
    SCOPED_TRACE(trial.text);
    RadarSettings s = trial.settings_of(GetParam().kind);
    const bool rays = GetParam().kind != FrustumKind::sweep;
    s.speckle = rays && seed % 3 == 0 ? SpeckleKind::geometric : SpeckleKind::ground;
    if (!trial.plan(s)) continue;
    ++frames;
    several_wedges += wedge_count(s.azimuth_bins) > 1 ? 1 : 0;
    const Frame one = trial.frame(s, 1);
    for (const int threads : {2, 5}) {
      const Frame many = trial.frame(s, threads);
      test::expect_same_bits(one.bins, many.bins);
      EXPECT_EQ(one.stats.samples, many.stats.samples);
      EXPECT_EQ(std::memcmp(&one.stats.covered_area_m2, &many.stats.covered_area_m2, sizeof(double)), 0);
    }
    test::Dice dice(seed);
    const int first = dice.integer(0, s.azimuth_bins - 1);
    const int count = dice.integer(1, s.azimuth_bins - first);
    BinBlock expected(first, count, s.range_bins);
    copy_azimuths(one.bins, expected);
    test::expect_same_bits(expected, trial.frame(s, 2, {first, count}).bins);
    if (HasFailure()) break;
  }
  std::printf("    %d frames, %d of them of several wedges\n", frames, several_wedges);
  EXPECT_GE(frames, 150);
  EXPECT_GE(several_wedges, 50);
}

INSTANTIATE_TEST_SUITE_P(Sources, BitsOfEverySource, testing::ValuesIn(test::kEverySource),
                         test::source_name<testing::TestParamInfo<test::NamedSource>>);

}  // namespace
}  // namespace obliq::half_turn_property_test
