// With the sweep and equal spacing a longer range never changes nearer bins, bit for bit: what lies nearer is
// found before what lies farther, and nothing of it is laid out by where the swath ends. With one exception:
// where ground rises so steeply that range falls along it, a plane may come back from beyond the swath's end.
// What it sees there is an echo of its own if it has been in another bin meanwhile, and else joins the one
// before, so that a float is rounded once more or less. Over random scenes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "tests/property/trial.h"

namespace obliq {
namespace {

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

}  // namespace
}  // namespace obliq
