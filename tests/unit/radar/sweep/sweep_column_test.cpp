// The parts of the sweep: how a piece of surface becomes samples, and how strands share a column's bearings.
// The sweep by sub-columns: the same bits whatever the instruction set, and what it asks within a column.
#include "server/radar/sweep/sweep_column.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "server/radar/echo/echo_cells.h"
#include "server/radar/simd/kernels.h"
#include "server/radar/sweep/sweep_echoes.h"
#include "server/radar/sweep/sweep_samples.h"
#include "server/radar/wedge_work.h"
#include "tests/support/heard_work.h"
#include "tests/support/made_worlds.h"
#include "tests/support/random_scenes.h"
#include "tests/support/random_towns.h"
#include "tests/support/same_bits.h"
#include "tests/support/scenes.h"

namespace obliq::sweep_column_test {
namespace {

RadarSettings sweep_settings() {
  RadarSettings s = test::radar_settings(FrustumKind::sweep, {500, 4500, 60}, {20, 40}, {40});
  s.sub_columns = 0;
  return s;
}

class Pieces : public testing::Test {
 protected:
  Pieces() {
    const auto scene = test::make_scene(test::made_world(5000, 100, [](double, double) { return 0; }));
    plan_ =
        plan_frame(scene, test::snapshot(sweep_settings()), test::pose_at(scene->world(), {0, 1000, 0}, 0))
            .plan;
  }

  /// Samples of one piece in a plane that stands for a width of 1 rad.
  std::unique_ptr<SampleBatch> samples(VisibleSegment piece) const {
    auto batch = std::make_unique<SampleBatch>();
    SegmentSampler sampler(plan_->looks_at());
    sampler.begin(*batch);
    sampler.set({0, 0, 1.0, {0, 1}});
    sampler.visible(piece);
    EXPECT_FALSE(sampler.anything_waiting());
    return batch;
  }

  static VisibleSegment ground(double start, double rise, double from, double to) {
    VisibleSegment piece{};
    piece.h_m = start;
    piece.rate_d = 1;
    piece.rate_h = rise;
    piece.t0 = from;
    piece.t1 = to;
    piece.plane_distance_m = -start / std::sqrt(1 + rise * rise);
    piece.face = kNoFace;
    return piece;
  }

  std::shared_ptr<const FramePlan> plan_;
};

TEST_F(Pieces, FillTheirSolidAngleAndTheirRangeBins) {
  // Level, rising and falling ground; the last two turn in range at the foot of the perpendicular.
  for (const auto& [start, rise] :
       {std::pair{-1000.0, 0.0}, {-1500.0, 0.3}, {-3000.0, 1.7}, {-900.0, -0.2}}) {
    const VisibleSegment piece = ground(start, rise, 100, 2500);
    const auto batch = samples(piece);
    const auto sine = [start = start, rise = rise](long double d) {  // clang 14 takes no binding as it is
      const long double h = start + rise * d;
      return h / std::sqrt(d * d + h * h);
    };
    long double sum = 0, whole = 0;
    for (std::size_t k = 0; k < static_cast<std::size_t>(batch->n); ++k) {
      sum += static_cast<long double>(batch->solid_angle_sr[k]);
      EXPECT_GE(plan_->bins().range_bin(batch->slant_range_m[k]), 0);
      EXPECT_NEAR(batch->cos_incidence[k] * batch->slant_range_m[k], piece.plane_distance_m, 1e-9);
    }
    // What lies in the swath, by 1e5 steps that are each in or out: good to the two steps at its ends.
    constexpr int kSteps = 100000;
    for (int step = 0; step < kSteps; ++step) {
      const long double d0 = 100 + 2400.0L * step / kSteps, d1 = 100 + 2400.0L * (step + 1) / kSteps;
      const long double d = (d0 + d1) / 2, h = start + rise * d;
      const long double r = std::sqrt(d * d + h * h);
      if (r >= 500 && r < 4500) whole += sine(d1) - sine(d0);
    }
    EXPECT_NEAR(static_cast<double>(sum / whole), 1, 1e-4) << start << " " << rise;
  }
}

TEST_F(Pieces, KeepTheirDigitsHoweverSmall) {
  // sin of two elevations 1e-12 rad apart, subtracted (the named wrong version), keeps four digits.
  const double d = 2000, step = 1e-6;
  const auto batch = samples(ground(-1000, 0, d, d + step));
  ASSERT_EQ(batch->n, 1);
  const long double r2 = d * d + 1e6L;
  const long double exact = 1000.0L * d * (static_cast<long double>(d + step) - d) /
                            (r2 * std::sqrt(r2));  // d(sin e) = h d / r^3 dd
  EXPECT_NEAR(batch->solid_angle_sr[0] / static_cast<double>(exact), 1, 1e-8);
}

TEST_F(Pieces, OfAWallAslantAreSharedAmongTheRangeBinsThatItRunsThrough) {
  // A wall at 45 degrees to the plane, 10 m high, seen across a width of 0.1 rad: it runs from 2000 / (1 +
  // tan 0.05) to 2000 / (1 - tan 0.05) m of ground distance, two range bins of 100 m. With the plane in the
  // middle standing for all of it (the named wrong version) one bin has everything.
  auto batch = std::make_unique<SampleBatch>();
  SegmentSampler sampler(plan_->looks_at());
  sampler.begin(*batch);
  sampler.set({0, 0, 0.1, {0, 1}});
  VisibleSegment wall{};
  wall.d_m = 2000;
  wall.rate_h = 1;
  wall.t0 = -1000;
  wall.t1 = -990;
  wall.wall = true;
  wall.normal_x = wall.normal_z = -std::sqrt(0.5);
  wall.plane_distance_m = 2000 * std::sqrt(0.5);
  wall.nearest_m = 1500;
  wall.farthest_m = 2600;
  wall.face = 1;
  wall.foot = VisibleSegment::Foot::ground;
  sampler.visible(wall);
  std::vector<double> share(40), expected(40);
  for (std::size_t k = 0; k < static_cast<std::size_t>(batch->n); ++k)
    share[static_cast<std::size_t>(plan_->bins().range_bin(batch->slant_range_m[k]))] +=
        batch->solid_angle_sr[k];
  constexpr int kSteps = 4000;
  for (int a = 0; a < kSteps; ++a) {
    const double off = 0.1 * ((a + 0.5) / kSteps - 0.5);
    const double d = 2000 / (std::cos(off) + std::sin(off));
    for (int h = -1000; h < -990; ++h) {
      const auto sine = [&](double y) { return y / std::hypot(d, y); };
      expected[static_cast<std::size_t>(plan_->bins().range_bin(std::hypot(d, h + 0.5)))] +=
          0.1 / kSteps * (sine(h + 1) - sine(h));
    }
  }
  int shared = 0;
  for (std::size_t r = 0; r < 40; ++r) {
    // The edge is taken as straight over a stretch of 0.005 rad: 0.005^2 / 8 of it, and the oracle's rows of
    // 1 m of height move the edge by half a metre of 100.
    EXPECT_NEAR(share[r], expected[r], 0.005 * (expected[11] + expected[16] + expected[17])) << r;
    shared += expected[r] > 0 ? 1 : 0;
  }
  EXPECT_GE(shared, 2);
}

TEST(BuildingBounds, HoldTheSilhouette) {
  for (std::uint64_t seed = 0; seed < 500; ++seed) {
    const test::RandomScene random = test::random_scene(seed);
    const Sector sector(random.settings, random.pose);
    for (std::uint32_t b = 0; b < random.world.buildings.list.size(); ++b) {
      const Silhouette exact = silhouette_of(random.world.buildings, sector, b);
      const BuildingBounds rough = bounds_of(random.world.buildings, sector, b);
      EXPECT_LE(rough.near_m, exact.near_m) << random.text;
      EXPECT_GE(rough.far_m, exact.far_m) << random.text;
      // Either may be a turn further on.
      const double turn =
          2 * std::numbers::pi * std::round((rough.from_rad - exact.from_rad) / (2 * std::numbers::pi));
      EXPECT_LE(rough.from_rad - turn, exact.from_rad) << random.text;
      EXPECT_GE(rough.to_rad - turn, exact.to_rad) << random.text;
      EXPECT_GE(exact.far_m, exact.near_m) << random.text;
    }
  }
}

TEST(SweepColumns, StrandsAndTheBasePlaneShareEveryColumnExactly) {
  // At any distance the strands' bearings are disjoint and inside the column, so that what they leave is the
  // base plane's, to the tick.
  int strands = 0;
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    test::RandomScene random = test::random_scene(seed);
    if (random.world.buildings.list.empty()) continue;
    RadarSettings s = random.settings;
    s.frustum = FrustumKind::sweep;
    s.sub_columns = 0;
    const auto scene = test::scene_of(random);
    const auto plan = plan_frame(scene, test::snapshot(s), random.pose).plan;
    const int per_bin = sweep_columns_per_bin(s);
    for (int bin = 0; bin < s.azimuth_bins; ++bin) {
      std::vector<Silhouette> silhouettes;
      for (const std::uint32_t b : plan->looks_at().buildings_in(bin))
        silhouettes.push_back(silhouette_of(scene->world().buildings, plan->sector(), b));
      SweepColumn column(plan->looks_at(), bin, plan->bins().azimuth_edge_rad(bin),
                         plan->bins().azimuth_width_rad / per_bin);
      SegmentSampler sampler(plan->looks_at());
      auto batch = std::make_unique<SampleBatch>();
      sampler.begin(*batch);
      column.start(silhouettes, sampler);
      const auto& records = column.strands();
      strands += static_cast<int>(records.size());
      for (std::size_t a = 0; a < records.size(); ++a) {
        ASSERT_GE(records[a].ticks.from, 0) << random.text;
        ASSERT_LE(records[a].ticks.to, SweepColumn::kTicks) << random.text;
        ASSERT_GT(records[a].ticks.size(), 0) << random.text;
        ASSERT_LT(records[a].from_m, records[a].to_m) << random.text;
        for (std::size_t b = 0; b < a; ++b) {
          const bool together = records[a].from_m < records[b].to_m && records[b].from_m < records[a].to_m;
          const bool overlap =
              records[a].ticks.from < records[b].ticks.to && records[b].ticks.from < records[a].ticks.to;
          ASSERT_FALSE(together && overlap) << random.text;
        }
      }
    }
  }
  EXPECT_GT(strands, 1000);
}

TEST(SweepColumns, AreWholeOnesInEveryBin) {
  RadarSettings s;
  s.azimuth_bins = 100;
  for (const auto& [columns, per_bin] : {std::pair{1, 1}, {100, 1}, {101, 2}, {200, 2}, {250, 3}}) {
    s.pixel_columns = columns;
    EXPECT_EQ(sweep_columns_per_bin(s), per_bin) << columns;
  }
}

std::shared_ptr<const FramePlan> plan_of(const test::RandomScene& town) {
  RadarSettings settings = town.settings;
  settings.frustum = FrustumKind::sweep;
  settings.sub_columns = 64;
  const auto scene = test::make_scene(town.world);
  return plan_frame(scene, test::snapshot(settings), town.pose).plan;
}

/// The first wedge.
BinBlock first_wedge(const ScenePlan& plan, const FrameTables& tables) {
  const AzimuthRange range{0, std::min(kWedgeAzimuthBins, plan.bins().n_azimuth)};
  EchoCells cells(plan, tables.scattering, tables.speckle, Surfaces::all, true);
  cells.restart(0);
  SweepEchoes sweep(plan, range, tables.near_buildings, tables.scattering, cells);
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
    const BinBlock widest = first_wedge(plan->looks_at(), tables);
    for (const Kernels& kernels : all_kernels()) {
      use_kernels(kernels);
      const BinBlock bins = first_wedge(plan->looks_at(), tables);
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
  RadarSettings settings = test::radar_settings(FrustumKind::sweep, {900, 7500, 0.4}, {1, 128}, {2});
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
}  // namespace obliq::sweep_column_test
