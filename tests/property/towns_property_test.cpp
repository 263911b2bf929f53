// The sweep over thousands of random towns: how far few planes are from many, what they miss, and the same
// bits from any threads, azimuths and pauses.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "server/accuracy/bin_errors.h"
#include "server/accuracy/sampling_case.h"
#include "server/accuracy/truth_bins.h"
#include "server/radar/narrow_bins.h"
#include "server/rendering/parked_work.h"
#include "terrain/base/parallel.h"
#include "tests/property/trial.h"
#include "tests/support/random_towns.h"
#include "tests/support/same_bits.h"
#include "tests/support/sane_frames.h"

namespace obliq::towns_property_test {
namespace {

constexpr int kTowns = 3000;

/// Constant gamma, or walls and roofs that shine in one direction.
test::Trial trial_of(std::uint64_t seed) {
  return test::Trial(test::random_town(seed),
                     seed % 2 == 0 ? test::constant_gamma_materials() : test::two_materials());
}

/// A way to sweep: planes in each half degree of an azimuth bin, and how it sees buildings; 0 sub-columns: by
/// exact strands.
struct Sweep {
  const char* name;
  int planes;
  int sub_columns;

  RadarSettings of(RadarSettings s) const {
    s.pixel_columns = std::min(kMostSide, planes * s.azimuth_bins * narrow_bins(s));
    s.sub_columns = sub_columns;
    return s;
  }
};
constexpr Sweep kReference{"reference", 8, 0};

struct Rendered {
  std::shared_ptr<const FramePlan> plan;  // knows which buildings were seen
  Frame frame;
};

Rendered render_all(const test::Trial& trial, const RadarSettings& s) {
  Rendered rendered{trial.plan(s), {}};
  if (!rendered.plan) return rendered;
  rendered.frame.bins = BinBlock(0, s.azimuth_bins, s.range_bins);
  FrameSum sum(s);
  RenderOptions options;
  options.threads = 1;
  options.on_wedge = [&](Wedge&& wedge) {
    copy_azimuths(wedge.bins, rendered.frame.bins);
    sum.add(wedge);
  };
  render_wedges(*rendered.plan, {0, s.azimuth_bins}, options);
  rendered.frame.stats = sum.total();
  return rendered;
}

/// How far a frame of a town is from that of many planes. Nothing where the town is not seen.
struct TownErrors {
  BinErrors bins;
  std::uint64_t seen = 0, missed = 0;  // buildings
};

TownErrors errors_of(const Rendered& rendered, const Rendered& reference, const test::Trial& trial) {
  TownErrors town;
  town.bins =
      bin_errors(rendered.frame.bins.power_w, reference.frame.bins.power_w, range_bins(trial.settings));
  for (std::uint32_t b = 0; b < trial.scene->world().buildings.list.size(); ++b) {
    if (!reference.plan->looks_at().seen().has(b)) continue;
    ++town.seen;
    if (!rendered.plan->looks_at().seen().has(b)) ++town.missed;
  }
  return town;
}

/// Those of all towns.
struct Errors {
  std::vector<double> power_error;  // E
  std::vector<double> energy;       // |of the total|
  double gaps = 0, lit = 0, false_light_w = 0, truth_w = 0, energy_w = 0;
  std::uint64_t seen = 0, missed = 0;

  void add(const TownErrors& town) {
    const BinErrors& e = town.bins;
    seen += town.seen;
    missed += town.missed;
    if (e.lit == 0) return;
    power_error.push_back(e.power_error);
    energy.push_back(std::abs(e.energy_error()));
    gaps += static_cast<double>(e.gaps);
    lit += static_cast<double>(e.lit);
    // Each town weighs alike.
    energy_w += e.energy_w / e.truth_energy_w;
    truth_w += 1;
    false_light_w += e.false_light_energy();
  }

  static double at(std::vector<double> values, double share) {
    std::sort(values.begin(), values.end());
    return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
  }
  void print(const char* name) const {
    std::printf(
        "    %s, %zu towns: E median %.4f, 90 %% %.3f, 99 %% %.3f; energy median %.1e, 90 %% %.1e, mean "
        "%+.1e; gaps "
        "%.3f %%, false light %.1e of the energy; %llu of %llu buildings missed\n",
        name, power_error.size(), at(power_error, 0.5), at(power_error, 0.9), at(power_error, 0.99),
        at(energy, 0.5), at(energy, 0.9), energy_w / truth_w - 1, 100 * gaps / lit, false_light_w / truth_w,
        static_cast<unsigned long long>(missed), static_cast<unsigned long long>(seen));
  }
};

/// What a sweep may be off by, over all towns.
struct Limits {
  Sweep sweep;
  double median, ninety, ninety_nine;  // of E
  double energy;                       // of the mean town
  double gaps, false_light, missed;
};

// A fourth above what was recorded, and no more than what was wanted of two planes: E of 0.005, 0.03, 0.15.
constexpr Limits kLimits[] = {
    {{"2 planes, exact", 2, 0}, 0.00125, 0.0125, 0.076, 5e-4, 0.0016, 1.8e-6, 0.0022},
    {{"1 plane, 64 sub-columns", 1, 64}, 0.0025, 0.02, 0.15, 0.0076, 0.002, 0.0105, 0.003},
    {{"2 planes, 64 sub-columns", 2, 64}, 0.0024, 0.02, 0.15, 0.0076, 0.0012, 0.0105, 0.003},
    {{"8 planes, 64 sub-columns", 8, 64}, 0.0017, 0.018, 0.15, 0.0078, 1.5e-4, 0.0105, 0.0015},
};

TEST(RandomTowns, AreMuchTheSameWithFewPlanesAndWithSubColumns) {
  std::vector<std::array<TownErrors, std::size(kLimits)>> towns(kTowns);
  for_each_row(kTowns, [&](int seed) {
    const test::Trial trial = trial_of(static_cast<std::uint64_t>(seed));
    SCOPED_TRACE(trial.text);
    const Rendered reference = render_all(trial, kReference.of(trial.settings));
    if (!reference.plan) return;
    for (std::size_t k = 0; k < std::size(kLimits); ++k) {
      const Rendered rendered = render_all(trial, kLimits[k].sweep.of(trial.settings));
      ASSERT_TRUE(rendered.plan);
      test::expect_sane(rendered.frame, trial.settings, trial.scene->materials());
      towns[static_cast<std::size_t>(seed)][k] = errors_of(rendered, reference, trial);
    }
  });
  if (HasFatalFailure()) return;
  for (std::size_t k = 0; k < std::size(kLimits); ++k) {
    Errors e;
    for (const auto& town : towns) e.add(town[k]);
    const Limits& limits = kLimits[k];
    SCOPED_TRACE(limits.sweep.name);
    e.print(limits.sweep.name);
    EXPECT_GE(e.power_error.size(), 2500u);
    EXPECT_LE(Errors::at(e.power_error, 0.5), limits.median);
    EXPECT_LE(Errors::at(e.power_error, 0.9), limits.ninety);
    EXPECT_LE(Errors::at(e.power_error, 0.99), limits.ninety_nine);
    EXPECT_LE(std::abs(e.energy_w / e.truth_w - 1), limits.energy);
    EXPECT_LE(e.gaps / e.lit, limits.gaps);
    EXPECT_LE(e.false_light_w / e.truth_w, limits.false_light);
    EXPECT_LE(static_cast<double>(e.missed), limits.missed * static_cast<double>(e.seen));
  }
}

/// A frame that gives way after so much work of a thread.
BinBlock paused_frame(const FramePlan& plan, std::int64_t look) {
  const RadarSettings& s = plan.settings();
  BinBlock bins(0, s.azimuth_bins, s.range_bins);
  RenderOptions options;
  options.threads = 2;
  options.on_wedge = [&](Wedge&& wedge) { copy_azimuths(wedge.bins, bins); };
  rendering::ParkedWork work([&] { render_wedges(plan, {0, s.azimuth_bins}, options); }, {}, look);
  while (!work.turn([](std::int64_t) { return true; })) {
  }
  return bins;
}

TEST(RandomTowns, HaveTheSameBitsFromAnyThreadsAzimuthsAndPauses) {
  int towns = 0, several_wedges = 0;
  for (std::uint64_t seed = 10000; seed < 11000 && !HasFailure(); ++seed) {
    const test::Trial trial = trial_of(seed);
    SCOPED_TRACE(trial.text);
    const RadarSettings& s = trial.settings;
    const auto plan = trial.plan(s);
    if (!plan) continue;
    ++towns;
    several_wedges += wedge_count(s.azimuth_bins) > 1 ? 1 : 0;
    const Frame one = trial.frame(s, 1);
    for (const int threads : {2, 8}) test::expect_same_bits(one.bins, trial.frame(s, threads).bins);
    test::expect_same_bits(one.bins, paused_frame(*plan, 3000));
    test::Dice dice(seed);
    const int first = dice.integer(0, s.azimuth_bins - 1);
    const int count = dice.integer(1, s.azimuth_bins - first);
    BinBlock expected(first, count, s.range_bins);
    copy_azimuths(one.bins, expected);
    test::expect_same_bits(expected, trial.frame(s, 2, {first, count}).bins);
  }
  std::printf("    %d towns, %d of several wedges\n", towns, several_wedges);
  EXPECT_GE(towns, 800);
  EXPECT_GE(several_wedges, 300);
}

}  // namespace
}  // namespace obliq::towns_property_test
