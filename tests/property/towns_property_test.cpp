// The sweep over thousands of random towns: how far few planes are from many, what they miss, and the same
// bits from any threads, azimuths and pauses.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "server/accuracy/bin_errors.h"
#include "server/accuracy/truth_bins.h"
#include "tests/property/trial.h"
#include "tests/support/random_towns.h"
#include "tests/support/sane_frames.h"

namespace obliq {
namespace {

constexpr int kTowns = 3000;
constexpr int kReference = 8;  // planes in each azimuth bin

/// Constant gamma, or walls and roofs that shine in one direction.
test::Trial trial_of(std::uint64_t seed) {
  return test::Trial(test::random_town(seed),
                     seed % 2 == 0 ? test::constant_gamma_materials() : test::two_materials());
}

RadarSettings with_planes(RadarSettings s, int planes) {
  s.pixel_columns = planes * s.azimuth_bins;
  return s;
}

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

/// Errors of frames against those of many planes, town by town.
struct Errors {
  std::vector<double> power_error;  // E
  std::vector<double> energy;       // |of the total|
  double gaps = 0, lit = 0, false_light_w = 0, truth_w = 0, energy_w = 0;
  std::uint64_t seen = 0, missed = 0;

  void add(const Rendered& rendered, const Rendered& reference, const RadarSettings& s,
           std::size_t buildings) {
    const BinErrors e = bin_errors(rendered.frame.bins.power_w, reference.frame.bins.power_w, range_bins(s));
    for (std::uint32_t b = 0; b < buildings; ++b) {
      if (!reference.plan->seen().has(b)) continue;
      ++seen;
      if (!rendered.plan->seen().has(b)) ++missed;
    }
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

TEST(RandomTowns, FewPlanesAreNearMany) {
  Errors two;
  for (std::uint64_t seed = 0; seed < kTowns; ++seed) {
    const test::Trial trial = trial_of(seed);
    SCOPED_TRACE(trial.text);
    const Rendered reference = render_all(trial, with_planes(trial.settings, kReference));
    if (!reference.plan) continue;
    const Rendered coarse = render_all(trial, with_planes(trial.settings, 2));
    ASSERT_TRUE(coarse.plan);
    test::expect_sane(reference.frame, trial.settings, trial.scene->materials());
    test::expect_sane(coarse.frame, trial.settings, trial.scene->materials());
    two.add(coarse, reference, trial.settings, trial.scene->world().buildings.list.size());
  }
  two.print("2 planes");
  EXPECT_GE(two.power_error.size(), 2500u);
  // A fourth above what was recorded (0.0010, 0.010, 0.061, 4e-4, 0.125 %, 1.4e-6, 53 of 30,123).
  EXPECT_LE(Errors::at(two.power_error, 0.5), 0.00125);
  EXPECT_LE(Errors::at(two.power_error, 0.9), 0.0125);
  EXPECT_LE(Errors::at(two.power_error, 0.99), 0.076);
  EXPECT_LE(std::abs(two.energy_w / two.truth_w - 1), 5e-4);
  EXPECT_LE(two.gaps / two.lit, 0.0016);
  EXPECT_LE(two.false_light_w / two.truth_w, 1.8e-6);
  EXPECT_LE(static_cast<double>(two.missed), 0.0022 * static_cast<double>(two.seen));
}

template <class T>
bool same(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

void expect_same(const BinBlock& a, const BinBlock& b) {
  EXPECT_TRUE(same(a.iq, b.iq));
  EXPECT_TRUE(same(a.power_w, b.power_w));
  EXPECT_TRUE(same(a.count, b.count));
  EXPECT_TRUE(same(a.state, b.state));
}

/// A frame in parts of a few batches.
BinBlock paused_frame(const FramePlan& plan, int batches) {
  const RadarSettings& s = plan.settings();
  BinBlock bins(0, s.azimuth_bins, s.range_bins);
  RenderPause pause;
  pause.batches = batches;
  RenderOptions options;
  options.threads = 2;
  options.pause = &pause;
  options.on_wedge = [&](Wedge&& wedge) { copy_azimuths(wedge.bins, bins); };
  do {
    render_wedges(plan, {0, s.azimuth_bins}, options);
  } while (pause.begun);
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
    for (const int threads : {2, 8}) expect_same(one.bins, trial.frame(s, threads).bins);
    expect_same(one.bins, paused_frame(*plan, 3));
    test::Dice dice(seed);
    const int first = dice.integer(0, s.azimuth_bins - 1);
    const int count = dice.integer(1, s.azimuth_bins - first);
    BinBlock expected(first, count, s.range_bins);
    copy_azimuths(one.bins, expected);
    expect_same(expected, trial.frame(s, 2, {first, count}).bins);
  }
  std::printf("    %d towns, %d of several wedges\n", towns, several_wedges);
  EXPECT_GE(towns, 800);
  EXPECT_GE(several_wedges, 300);
}

}  // namespace
}  // namespace obliq
