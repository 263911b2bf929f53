// The sweep by sub-columns: the same bits whatever the instruction set, and pauses within a column.
#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <vector>

#include "server/radar/echo/echo_cells.h"
#include "server/radar/sweep/sweep_echoes.h"
#include "server/radar/wedge_work.h"
#include "tests/support/made_worlds.h"
#include "tests/support/random_towns.h"
#include "tests/support/scenes.h"

namespace obliq {
namespace {

std::shared_ptr<const FramePlan> plan_of(const test::RandomScene& town) {
  RadarSettings settings = town.settings;
  settings.frustum = FrustumKind::sweep;
  settings.sub_columns = 64;
  const auto scene = test::make_scene(town.world);
  return plan_frame(scene, test::snapshot(settings), town.pose).plan;
}

/// The first wedge.
BinBlock wedge_with(const FramePlan& plan, const FrameTables& tables, const Kernels& kernels) {
  const AzimuthRange range{0, std::min(kWedgeAzimuthBins, plan.bins().n_azimuth)};
  EchoCells cells(plan, tables.scattering, tables.speckle, Surfaces::all, true, kernels);
  cells.restart();
  SweepEchoes sweep(plan, range, cells, kernels);
  FrameStats stats;
  while (sweep.step(stats)) {
  }
  BinBlock bins(range.first, range.count, plan.bins().n_range);
  cells.write(bins);
  return bins;
}

template <class T>
bool same(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

TEST(SubColumns, HaveTheSameBitsWithEveryInstructionSet) {
  std::uint64_t echoes = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const test::RandomScene town = test::random_town(seed);
    SCOPED_TRACE(town.text);
    const auto plan = plan_of(town);
    if (!plan) continue;
    const FrameTables tables(*plan);
    const BinBlock widest = wedge_with(*plan, tables, widest_kernels());
    for (const Kernels& kernels : all_kernels()) {
      const BinBlock bins = wedge_with(*plan, tables, kernels);
      EXPECT_TRUE(same(bins.power_w, widest.power_w)) << kernels.name;
      EXPECT_TRUE(same(bins.iq, widest.iq)) << kernels.name;
      EXPECT_TRUE(same(bins.count, widest.count)) << kernels.name;
      EXPECT_TRUE(same(bins.state, widest.state)) << kernels.name;
    }
    for (const std::uint32_t n : widest.count) echoes += n;
  }
  EXPECT_GT(echoes, 10000u);
}

}  // namespace
}  // namespace obliq
