// The sweep by sub-columns: the same bits whatever the instruction set, and what it asks within a column.
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "server/radar/echo/echo_cells.h"
#include "server/radar/sweep/sweep_echoes.h"
#include "server/radar/wedge_work.h"
#include "tests/support/heard_work.h"
#include "tests/support/made_worlds.h"
#include "tests/support/random_towns.h"
#include "tests/support/same_bits.h"
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
BinBlock wedge_with(const ScenePlan& plan, const FrameTables& tables, const Kernels& kernels) {
  const AzimuthRange range{0, std::min(kWedgeAzimuthBins, plan.bins().n_azimuth)};
  EchoCells cells(plan, tables.scattering, tables.speckle, Surfaces::all, true, kernels);
  cells.restart(0);
  SweepEchoes sweep(plan, range, tables.near_buildings, tables.scattering, cells,
                    std::numeric_limits<double>::infinity(), kernels);
  FrameStats stats;
  sweep.run(stats);
  BinBlock bins(range.first, range.count, plan.bins().n_range);
  cells.write(bins);
  return bins;
}

TEST(SubColumns, HaveTheSameBitsWithEveryInstructionSet) {
  std::uint64_t echoes = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const test::RandomScene town = test::random_town(seed);
    SCOPED_TRACE(town.text);
    const auto plan = plan_of(town);
    if (!plan) continue;
    const FrameTables tables(plan->looks_at());
    const BinBlock widest = wedge_with(plan->looks_at(), tables, widest_kernels());
    for (const Kernels& kernels : all_kernels()) {
      const BinBlock bins = wedge_with(plan->looks_at(), tables, kernels);
      SCOPED_TRACE(kernels.name);
      test::expect_same_bits(bins, widest);
    }
    for (const std::uint32_t n : widest.count) echoes += n;
  }
  EXPECT_GT(echoes, 10000u);
}

/// A street of small houses, one behind the other, none of them near, all in the one wedge.
World street(int houses) {
  World world = test::made_world(9000, 50, [](double, double) { return 0; });
  for (int k = 0; k < houses; ++k)
    test::add_prism(world, test::rectangle(-12 + k % 8 * 3, 1600 + 1.4 * k, 2, 1), 1 + k * 0.002);
  return world;
}

TEST(SubColumns, LookUpAfterAThousandBuildingsAtMostWithinOneAzimuthBin) {
  constexpr int kHouses = 4000;
  constexpr std::uint32_t kMostAtOnce = 1024;
  const auto scene = std::make_shared<const Scene>(std::make_shared<const World>(street(kHouses)),
                                                   test::two_materials(), 0, RayMethod::march);
  RadarSettings settings;
  settings.frustum = FrustumKind::sweep;
  settings.sector_deg = 0.4;
  settings.r_min_m = 900;
  settings.r_max_m = 7500;
  settings.azimuth_bins = 1;
  settings.range_bins = 128;
  settings.pixel_columns = 2;
  const auto plan =
      plan_frame(scene, test::snapshot(settings), test::pose_at(scene->world(), {0, 400, 0}, 0)).plan;
  ASSERT_TRUE(plan);
  ASSERT_GT(plan->looks_at().buildings_in(0).size(), 2 * kMostAtOnce);
  const FrameTables tables(plan->looks_at());
  ASSERT_TRUE(has_sub_columns(plan->looks_at()));

  // Between two asks, neither more buildings are seen nor, before that, more collected.
  EchoCells cells(plan->looks_at(), tables.scattering, tables.speckle, Surfaces::all, true);
  cells.restart(0);
  SweepEchoes sweep(plan->looks_at(), {0, 1}, tables.near_buildings, tables.scattering, cells);
  FrameStats stats;
  std::uint32_t seen = 0, most = 0;
  test::HeardWork heard;
  heard.on_ask = [&] {
    const std::uint32_t now = plan->looks_at().seen().count();
    most = std::max(most, now - seen);
    seen = now;
  };
  EXPECT_TRUE(test::hear(heard, [&] { sweep.run(stats); }));
  EXPECT_GT(plan->looks_at().seen().count(), 3u * kMostAtOnce) << "they rise one above the other";
  EXPECT_LE(most, kMostAtOnce);
  EXPECT_GE(heard.asks(),
            static_cast<std::int64_t>(2 * plan->looks_at().buildings_in(0).size() / kMostAtOnce));

  // A frame that is told to stop when it asks for the third time does.
  test::HeardWork stopped;
  stopped.most_asks = 3;
  RenderOptions options;
  options.threads = 1;
  EXPECT_TRUE(test::hear(stopped, [&] { EXPECT_FALSE(render_wedges(*plan, {0, 1}, options)); }));
  EXPECT_EQ(stopped.asks(), 3);
}

}  // namespace
}  // namespace obliq
